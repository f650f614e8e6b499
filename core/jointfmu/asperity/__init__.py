"""Single-spot laws of the three papers, each a table of regimes over the one integral."""
