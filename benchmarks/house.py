"""The size and the order of the house: lines, rooms, exemptions, files of a joint, names.

`python benchmarks/house.py` prints a table; paths are those of the checkout that it lies in.
"""

import re
import tomllib
from collections import Counter
from pathlib import Path

from validity_tables import heading, row

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("core", "fmu_src", "tools")
CODE = {".py", ".c", ".h", ".js"}
JOINTS = sorted(
    path.name for path in (ROOT / "core/jointfmu/joints").iterdir() if (path / "__init__.py").exists()
)


def files(*folders, suffixes=frozenset(CODE)):
    """Code below folders, without what is built."""
    found = (path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix in suffixes)
    return [path for path in found if not any(part.endswith("egg-info") for part in path.parts)]


def lines(paths):
    """Lines of files together."""
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths)


def rooms():
    """Folders and modules at the top of the kernel."""
    top = (path for path in (ROOT / "core/jointfmu").iterdir() if not path.name.startswith("__init__"))
    return sum(path.suffix == ".py" or (path / "__init__.py").exists() for path in top)


def exemptions():
    """Imports that a contract lets pass."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    return sum(len(contract.get("ignore_imports", ())) for contract in contracts)


def flat(*folders):
    """Folder with the most modules in it, and how many."""
    counts = Counter(path.parent for path in files(*folders))
    folder, count = counts.most_common(1)[0]
    return f"{count} ({folder.relative_to(ROOT)})"


def repeated():
    """Names of classes that are defined more than once."""
    names = Counter(
        name
        for path in files(*PACKAGES, suffixes={".py"})
        for name in re.findall(r"^class (\w+)", path.read_text(encoding="utf-8"), re.M)
    )
    return sorted(name for name, count in names.items() if count > 1)


def main():
    """Print the table."""
    kernel = lines(files("core", "fmu_src"))
    heading("The house", "what", "now")
    row("product lines", lines(files(*PACKAGES)))
    row("of them kernel and builders", kernel)
    for package in PACKAGES:
        row(f"of them `{package}`", lines(files(package)))
    row("C written by hand", lines(files(*PACKAGES, suffixes={".c", ".h"})))
    row("rooms at the top of the kernel", rooms())
    row("exemptions of the import contracts", exemptions())
    texts = (path.read_text(encoding="utf-8") for path in files(*PACKAGES, suffixes={".py"}))
    row(
        "lines with `Any`, imports apart",
        sum(map(len, (re.findall(r"^(?!from ).*\bAny\b", t, re.M) for t in texts))),
    )
    for joint in JOINTS:
        folders = (
            *(f"{p}/joints/{joint}" for p in ("core/jointfmu", "fmu_src", "tools")),
            f"tests/joints/{joint}",
        )
        row(f"files of `{joint}`, tests included", len(files(*folders)))
    row(
        "entries of `tests/`",
        sum(not path.name.startswith((".", "__")) for path in (ROOT / "tests").iterdir()),
    )
    row("largest folder of modules, product", flat(*PACKAGES))
    row("the same, tests", flat("tests"))
    names = repeated()
    row("class names defined more than once", f"{len(names)} ({', '.join(names)})")


if __name__ == "__main__":
    main()
