"""Fits of joint parameters to measured curves and catalogue values, by least squares in logarithms."""
