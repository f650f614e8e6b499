"""Running FMUs: importer, ramps and loops, proofs."""
