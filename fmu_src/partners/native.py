"""The partners in C: equations, without tables."""

from ..native.part import EQUATIONS as PART

__all__ = ["PART"]
