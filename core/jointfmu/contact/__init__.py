"""Contact of rough surfaces: interface laws, surface and material parameters, size distribution."""
