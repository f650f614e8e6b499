"""FMUs that carry their own proof: the experiments of FMI-LS-REF inside an FMU, read and executed."""
