"""Running FMUs: importer, load ramps and load cycles, proofs (checks of an FMU against its references)."""
