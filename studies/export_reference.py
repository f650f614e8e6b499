"""Table of docs/export_reference.md: exported joints in CalculiX (`ccx`) compared with the package.

python studies/export_reference.py
"""

import contextlib
import io
import tempfile
from pathlib import Path

from common import run_study
from oracles.calculix import cases, find_calculix


def print_cases() -> None:
    """Print displacements by CalculiX and by the package, with the relative difference."""
    if not find_calculix():
        raise SystemExit("ccx is not installed; on Debian: apt-get install calculix-ccx")
    with tempfile.TemporaryDirectory() as name, contextlib.redirect_stdout(io.StringIO()):
        found = cases(Path(name))
    print(f"{'':48}{'CalculiX':>14}{'jointfmu':>14}{'difference':>12}")
    for meaning, theirs, ours in found:
        print(f"{meaning:48}{theirs:14.6e}{ours:14.6e}{theirs / ours - 1.0:12.1e}")


if __name__ == "__main__":
    run_study(__doc__, {"calculix": print_cases})
