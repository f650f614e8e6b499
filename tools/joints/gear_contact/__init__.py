"""What the tools know of the gear contact."""
