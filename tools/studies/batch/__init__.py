"""Laws and parameter sets for many samples at once: rows of samples, columns of loads."""
