"""Shared libraries for five platforms: compiler, cache of compiled models, insertion of an FMU's data."""
