"""From measured curves and catalogue rows to parameters, by least squares in logarithms."""
