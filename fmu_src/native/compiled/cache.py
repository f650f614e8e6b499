"""Cache folder: compiled models of FMUs, stored results of long computations, cache of the compiler.

Its files become part of FMUs, so only the user and root may have write access.
"""

import os
import stat
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

_REMOVED_FOLDER_PREFIX = "removed-"
"""Start of the names of folders that are being deleted."""
_MAX_DELETION_WAIT = 1.0
"""Time [s] that `clear_cache` waits for the deletion of the files."""
CACHE_ENVIRONMENT_VARIABLE = "JOINTFMU_CACHE"
"""Environment variable with the path of the cache folder."""
COMPILER_CACHE_ENVIRONMENT_VARIABLE = "ZIG_GLOBAL_CACHE_DIR"
"""Environment variable with the compiler's cache; not set: a subfolder of the cache folder."""


def cache_folder() -> Path:
    """Path of the cache folder: JOINTFMU_CACHE, or `jointfmu` in the user's cache folder."""
    if path := os.environ.get(CACHE_ENVIRONMENT_VARIABLE):
        return Path(path).absolute()
    home = {
        "win32": os.environ.get("LOCALAPPDATA") or "~/AppData/Local",
        "darwin": "~/Library/Caches",
    }.get(sys.platform, os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return Path(home).expanduser() / "jointfmu"


def compiled_model_folder() -> Path:
    """Cache folder of the compiled models: C sources and libraries of FMUs."""
    return cache_folder() / "parts"


def stored_result_folder() -> Path:
    """Cache folder of the stored results of long computations of the package `jointfmu`.

    The results are reduced contact points and friction patches of bolted joints.
    """
    return cache_folder() / "results"


def compiler_cache_folder() -> Path:
    """Cache folder of the compiler: ZIG_GLOBAL_CACHE_DIR, or `zig` in the cache folder."""
    path = os.environ.get(COMPILER_CACHE_ENVIRONMENT_VARIABLE)
    return Path(path).absolute() if path else cache_folder() / "zig"


def check_cache_access(cached_path: Path) -> None:
    """Check that no other user can write to a path in the cache, or to its parents up to the cache folder.

    A missing path, a path outside the cache, and any path on Windows pass.

    Raises ValueError, one line, if a path belongs to another user than this one and root, or is writable
    for every user: another user may then have changed its content.
    """
    if sys.platform == "win32":
        return
    roots = {cache_folder(), compiler_cache_folder()}
    ancestors = [cached_path, *cached_path.parents]
    last = max((i for i, ancestor in enumerate(ancestors) if ancestor in roots), default=-1)
    for ancestor in ancestors[: last + 1]:
        try:
            status = ancestor.stat()
        except FileNotFoundError:
            continue
        advice = (
            f"expected a cache of your own (remove it, or set {CACHE_ENVIRONMENT_VARIABLE} to another folder)"
        )
        if status.st_uid not in (os.geteuid(), 0):
            raise ValueError(f"{ancestor}: belongs to another user; {advice}")
        if status.st_mode & stat.S_IWOTH:
            raise ValueError(f"{ancestor}: every user may write to it; {advice}")


def make_cache_folder(cache_folder: Path) -> None:
    """Make a folder of the cache and its missing parents, accessible for this user only. Raises OSError."""
    for missing in reversed([path for path in (cache_folder, *cache_folder.parents) if not path.exists()]):
        missing.mkdir(mode=0o700, exist_ok=True)


def count_cached_files() -> tuple[int, int]:
    """Number of files in the cache and their total size [bytes], without files that vanish meanwhile."""
    sizes = []
    for folder, _, names in (entry for root in _list_cache_subfolders() for entry in os.walk(root)):
        for name in names:
            with suppress(FileNotFoundError):
                sizes.append(os.stat(os.path.join(folder, name)).st_size)
    return len(sizes), sum(sizes)


def clear_cache() -> None:
    """Remove all files from the cache; later builds compile again.

    The folders are renamed. Another process deletes them: 100 000 files of the compiler take a minute.

    Raises ValueError if a folder cannot be renamed.
    """
    for folder in _list_cache_subfolders():
        if not folder.exists():
            continue
        try:
            folder.rename(
                tempfile.mkdtemp(prefix=_REMOVED_FOLDER_PREFIX, dir=folder.parent) + f"/{folder.name}"
            )
        except OSError as error:
            raise ValueError(f"{folder}: cannot be removed ({error.strerror}); remove it by hand") from None
    removed = [str(path) for path in cache_folder().glob(f"{_REMOVED_FOLDER_PREFIX}*")]
    if not removed:
        return
    program = "import shutil, sys; [shutil.rmtree(path, ignore_errors=True) for path in sys.argv[1:]]"
    deleting = subprocess.Popen(
        [sys.executable, "-c", program, *removed],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    with suppress(subprocess.TimeoutExpired):
        deleting.wait(_MAX_DELETION_WAIT)
    deleting.returncode = 0  # it goes on by itself


def _list_cache_subfolders() -> tuple[Path, ...]:
    """Cache folders of compiled models, of stored results and of the compiler (default folder)."""
    return compiled_model_folder(), stored_result_folder(), cache_folder() / "zig"
