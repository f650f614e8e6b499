"""New joints from what stands on a drawing: sizes, bolts, materials and finishes."""
