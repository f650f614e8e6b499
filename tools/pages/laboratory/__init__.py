"""The laboratory: an HTML page that runs the C code of the native FMUs in the browser."""
