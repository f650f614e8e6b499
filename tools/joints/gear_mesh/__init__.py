"""What the tools know of the gear mesh."""
