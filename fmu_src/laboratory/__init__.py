"""A page that runs the C of the native FMUs in the browser."""

from .assemble import page, write_laboratory

__all__ = ["page", "write_laboratory"]
