"""The python flavour: pythonfmu slaves, FMI 2.0 co-simulation."""
