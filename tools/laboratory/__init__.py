"""A page that runs the C of the native FMUs in the browser."""

from .assemble import page, web_file, write_laboratory

__all__ = ["page", "web_file", "write_laboratory"]
