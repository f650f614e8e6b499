"""The C of an FMU: hand-written, and generated from the list of variables and the laws."""
