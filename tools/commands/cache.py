"""`jointfmu cache`: where compiled parts of FMUs are kept."""

import argparse
import json

from ..command_line.common import Commands, command, without_package


def add(commands: Commands) -> None:
    """Declare the command."""
    cache = command(commands, "cache", _cache, "say where compiled parts of FMUs are kept, or remove them")
    cache.add_argument("--clear", action="store_true", help="remove them; the next build compiles again")


def _cache(args: argparse.Namespace) -> int:
    try:
        from jointfmu_fmu_src.native import cache
    except ImportError as error:
        raise without_package(error, "build") from None
    if args.clear:
        cache.clear()
    files, size = cache.content()
    if args.json:
        print(json.dumps({"folder": str(cache.cache_folder()), "files": files, "bytes": size}))
    else:
        print(f"{cache.cache_folder()}: {files} files, {size / 1e6:.1f} MB (another folder: {cache.CACHE})")
    return 0
