"""Proof of an FMU: experiments with reference results inside the FMU, by the standard FMI-LS-REF.

Any importer can repeat the experiments and compare its outputs.
"""
