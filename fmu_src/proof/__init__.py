"""Verification files inside an FMU: experiments, inputs and reference results by the standard FMI-LS-REF."""
