"""What the tools know of each joint, a folder each."""
