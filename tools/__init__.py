"""Tools for joints: drawings, surfaces, fits, fields, finite elements, exports, systems, pages."""

from .joints import PARTS

__all__ = ["PARTS"]
