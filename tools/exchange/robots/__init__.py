"""Elastic drives in robot models: MJCF and URDF, MuJoCo plugins, natural frequencies and tip error."""
