"""The proof of an FMU, executed: its experiments run by importers, and what becomes of them."""
