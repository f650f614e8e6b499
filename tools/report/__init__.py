"""The report that opens in a browser."""

from .page import write_report

__all__ = ["write_report"]
