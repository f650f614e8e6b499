"""Input and output files: checks, atomic writing, archives, build date."""
