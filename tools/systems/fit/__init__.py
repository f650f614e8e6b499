"""Fit parameters of a system to measured time series."""
