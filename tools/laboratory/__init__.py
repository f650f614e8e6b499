"""A page that runs the C of the native FMUs in the browser."""
