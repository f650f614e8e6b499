"""C sources of an FMU: hand-written files, and files generated from the variables and the joint laws."""
