"""Systems of joints, bodies and loads: their files, archives, simulation and free vibration."""
