"""The date that goes into what is written."""

from datetime import UTC, datetime
from os import environ


def build_time() -> datetime:
    """Now, or SOURCE_DATE_EPOCH where it is set, for files that repeat."""
    return fixed_time() or datetime.now(UTC)


def fixed_time() -> datetime | None:
    """SOURCE_DATE_EPOCH (seconds since 1970) where it is set.

    Raises ValueError if the variable is no such number.
    """
    epoch = environ.get("SOURCE_DATE_EPOCH")
    if not epoch:
        return None
    try:
        return datetime.fromtimestamp(int(epoch), UTC)
    except (ValueError, OverflowError, OSError):
        raise ValueError(
            f"SOURCE_DATE_EPOCH = {epoch!r} is no date; expected whole seconds since 1970"
        ) from None
