"""From files to parameters: drawings, catalogue, surface scans, pressure fields, measurements."""
