"""Flavour python: FMUs for FMI 2.0 co-simulation that run the package through pythonfmu."""
