"""Proof of an FMU: execute the experiments that the FMU contains, and compare with its reference results."""
