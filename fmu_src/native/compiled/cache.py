"""The folder of what is compiled: parts of FMUs, and the compiler's own files.

What lies there gets into FMUs, so nobody but its user and root may write to it.
"""

import os
import shutil
import stat
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


def check_access(path: Path) -> None:
    """Check who may write to a file or folder of the cache, and to the folders above it in the cache.

    What is missing or lies elsewhere passes; on Windows everything does.

    Raises ValueError, one line, if it belongs to another user than this one and root, or every user may
    write to it.
    """
    if sys.platform == "win32":
        return
    roots = {cache_folder(), compiler_cache()}
    places = [path, *path.parents]
    last = max((i for i, place in enumerate(places) if place in roots), default=-1)
    for place in places[: last + 1]:
        try:
            found = place.stat()
        except FileNotFoundError:
            continue
        advice = f"expected a cache of your own (remove it, or set {CACHE} to another folder)"
        if found.st_uid not in (os.geteuid(), 0):
            raise ValueError(f"{place}: belongs to another user; {advice}")
        if found.st_mode & stat.S_IWOTH:
            raise ValueError(f"{place}: every user may write to it; {advice}")


def make_folder(folder: Path) -> None:
    """Make a folder of the cache; what is new belongs to this user alone. Raises OSError."""
    for place in reversed([one for one in (folder, *folder.parents) if not one.exists()]):
        place.mkdir(mode=0o700, exist_ok=True)


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
