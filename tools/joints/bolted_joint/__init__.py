"""What the tools know of the bolted joint."""
