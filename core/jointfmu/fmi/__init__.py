"""Running FMUs: host, ramp and loops."""
