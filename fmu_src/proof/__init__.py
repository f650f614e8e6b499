"""The proof inside an FMU: manifest, experiments, inputs and reference results after FMI-LS-REF."""
