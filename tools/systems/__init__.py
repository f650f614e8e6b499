"""Systems of joints: their files, archives, simulation and free vibration."""
