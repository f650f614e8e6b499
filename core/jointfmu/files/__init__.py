"""Files: written whole or not at all, and the date in what is written."""
