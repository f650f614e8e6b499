"""Find the modules that a module imports, from its source text; an FMU must contain all of them."""

import ast
from collections.abc import Collection, Iterator, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path


def find_imported_modules(entry_modules: Sequence[str], root_packages: Collection[str]) -> dict[str, Path]:
    """Find {name: file} of `entry_modules` and of the modules that they import at top level.

    The search follows the imports of each module found, within `root_packages`.
    Parent packages of a module are included. Imports inside functions are not: they are optional at run time.
    """
    files: dict[str, Path] = {}
    pending = list(entry_modules)
    while pending:
        name = pending.pop()
        if name.partition(".")[0] not in root_packages or name in files:
            continue
        try:
            spec = find_spec(name)
        except ModuleNotFoundError:  # an object of a module
            continue
        if spec is None or spec.origin is None:
            continue
        files[name] = Path(spec.origin)
        parts = name.split(".")
        pending += [".".join(parts[:k]) for k in range(1, len(parts))]
        package = name if spec.submodule_search_locations else name.rpartition(".")[0]
        pending += _list_imports(files[name].read_text(encoding="utf-8"), package)
    return files


def _list_imports(module_text: str, package: str) -> Iterator[str]:
    """Yield the module names imported at top level; for `from A import B` A and A.B, as B may be a module."""
    for node in _parse_module(module_text).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parents = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join([*parents, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


@cache
def _parse_module(module_text: str) -> ast.Module:
    """Syntax tree of the text of a module; cached, because FMUs contain mostly the same modules."""
    return ast.parse(module_text)
