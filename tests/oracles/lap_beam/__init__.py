"""A bolted beam of two lapped halves: meshes, reduction to the contact patches, loads over amplitude."""
