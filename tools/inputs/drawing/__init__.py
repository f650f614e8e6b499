"""New joints from the data of a drawing: sizes, bolts, materials and finishes."""
