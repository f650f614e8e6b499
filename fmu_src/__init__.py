"""Builders of FMUs: model descriptions, C code, compiled libraries, documentation, reference results."""
