"""Studies of models: published numbers, checks of FMUs, uncertainty."""
