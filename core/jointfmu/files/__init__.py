"""Files: columns of numbers, and the date in what is written."""
