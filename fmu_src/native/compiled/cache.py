"""The folder of what is compiled: parts of FMUs, and the compiler's own files."""

import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path

CACHE = "JOINTFMU_CACHE"
"""Environment variable with the folder."""
COMPILER = "ZIG_GLOBAL_CACHE_DIR"
"""The compiler's own, which lies in the folder unless it is set."""


def cache_folder() -> Path:
    """JOINTFMU_CACHE, or `jointfmu` in the user's cache."""
    if own := os.environ.get(CACHE):
        return Path(own).absolute()
    home = {
        "win32": os.environ.get("LOCALAPPDATA") or "~/AppData/Local",
        "darwin": "~/Library/Caches",
    }.get(sys.platform, os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return Path(home).expanduser() / "jointfmu"


def parts() -> Path:
    """Where compiled parts lie."""
    return cache_folder() / "parts"


def compiler_cache() -> Path:
    """ZIG_GLOBAL_CACHE_DIR, or `zig` in the folder."""
    own = os.environ.get(COMPILER)
    return Path(own).absolute() if own else cache_folder() / "zig"


def content() -> tuple[int, int]:
    """Files in the folder, and their bytes; what another build removes at the same time does not count."""
    sizes = []
    for folder, _, names in (step for own in _own() for step in os.walk(own)):
        for name in names:
            with suppress(FileNotFoundError):
                sizes.append(os.stat(os.path.join(folder, name)).st_size)
    return len(sizes), sum(sizes)


def clear() -> None:
    """Remove what is in the folder; nothing is lost but time.

    Raises ValueError if it cannot be removed.
    """
    for folder in _own():
        try:
            shutil.rmtree(folder)
        except FileNotFoundError:
            continue
        except OSError as error:
            raise ValueError(f"{folder}: cannot be removed ({error.strerror})") from None


def _own() -> tuple[Path, Path]:
    return parts(), cache_folder() / "zig"
