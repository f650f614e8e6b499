"""The native flavours: C from the laws, compiled for five platforms, FMI 2.0 and 3.0."""
