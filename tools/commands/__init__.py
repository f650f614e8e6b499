"""The commands of the command line, most of them modules of their names."""
