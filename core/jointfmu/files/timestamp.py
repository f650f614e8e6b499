"""Date and time that are written into output files; reproducible if SOURCE_DATE_EPOCH is set."""

from datetime import UTC, datetime
from os import environ


def get_build_time() -> datetime:
    """Date and time to be written into files: that of SOURCE_DATE_EPOCH, if set, else the present time.

    The environment variable makes the files reproducible.
    """
    return read_source_date() or datetime.now(UTC)


def read_source_date() -> datetime | None:
    """Date and time in the environment variable SOURCE_DATE_EPOCH (seconds since 1970); None if not set.

    The variable makes written files reproducible.

    Raises ValueError if the variable is no such number.
    """
    epoch = environ.get("SOURCE_DATE_EPOCH")
    if not epoch:
        return None
    try:
        return datetime.fromtimestamp(int(epoch), UTC)
    except (ValueError, OverflowError, OSError):
        raise ValueError(
            f"SOURCE_DATE_EPOCH = {epoch!r} is not a date; expected whole seconds since 1970"
        ) from None
