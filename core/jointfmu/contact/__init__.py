"""Contact of rough surfaces: the interface laws and what they stand on."""
