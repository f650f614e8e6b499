"""One FMU for a whole system: joints, bodies and loads, with an implicit step of its own."""
