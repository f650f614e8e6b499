"""Which modules a module imports, read from its text: what has to come along into an FMU."""

import ast
from collections.abc import Collection, Iterator, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path


def imported(start: Sequence[str], roots: Collection[str]) -> dict[str, Path]:
    """{name: file} of modules and all that they import at their top, of the packages `roots`.

    Packages on the way to a module come along. Imports inside functions do not: what they need may be
    missing where the module runs.
    """
    files: dict[str, Path] = {}
    waiting = list(start)
    while waiting:
        name = waiting.pop()
        if name.partition(".")[0] not in roots or name in files:
            continue
        try:
            spec = find_spec(name)
        except ModuleNotFoundError:  # a name inside a module
            continue
        if spec is None or spec.origin is None:
            continue
        files[name] = Path(spec.origin)
        parts = name.split(".")
        waiting += [".".join(parts[:k]) for k in range(1, len(parts))]
        package = name if spec.submodule_search_locations else name.rpartition(".")[0]
        waiting += _imports(files[name].read_text(encoding="utf-8"), package)
    return files


def _imports(text: str, package: str) -> Iterator[str]:
    """Names that the top of a module imports; of `from A import B` both A and A.B, as B may be a module."""
    for node in _parsed(text).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


@cache
def _parsed(text: str) -> ast.Module:
    """Kept for the next FMU, into which most of it comes as well."""
    return ast.parse(text)
