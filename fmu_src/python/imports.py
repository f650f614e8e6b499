"""Find the modules that a module imports, from its source text; an FMU must contain all of them."""

import ast
from collections.abc import Collection, Iterator, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path


def find_imported_modules(
    entry_module_names: Sequence[str], root_package_names: Collection[str]
) -> dict[str, Path]:
    """Find given modules and all modules that they import, directly or through others: {name: file}.

    Only modules of the packages `root_package_names` are included, with their parent packages. Imports inside
    functions are not followed: they are optional at run time.
    """
    files: dict[str, Path] = {}
    pending = list(entry_module_names)
    while pending:
        name = pending.pop()
        if name.partition(".")[0] not in root_package_names or name in files:
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


def _list_imports(module_text: str, package_name: str) -> Iterator[str]:
    """Yield the names of the modules that a module imports at top level.

    `from A import B` gives A and A.B, because B may be a module.
    """
    for node in _parse_module(module_text).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parents = (
                package_name.split(".")[: len(package_name.split(".")) - node.level + 1] if node.level else []
            )
            module = ".".join([*parents, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


@cache
def _parse_module(module_text: str) -> ast.Module:
    """Syntax tree of the text of a module; cached, because FMUs contain mostly the same modules."""
    return ast.parse(module_text)
