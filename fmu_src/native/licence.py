"""The licence that every FMU carries: the one of the package."""

from importlib.metadata import PackageNotFoundError, files


def licence() -> str:
    """The licence text, from what is installed.

    Raises ValueError if it is missing.
    """
    try:
        texts = [f for f in files("jointfmu") or () if f.name == "LICENSE"]
        return texts[0].read_text(encoding="utf-8")
    except (PackageNotFoundError, IndexError, OSError):
        raise ValueError("LICENSE: missing in the installed package jointfmu; install it again") from None


def copyright_line() -> str:
    """The line that names the copyright holder."""
    return next(line for line in licence().splitlines() if line.startswith("Copyright"))
