"""The laboratory: a page that runs the C code of the native FMUs in the browser."""
