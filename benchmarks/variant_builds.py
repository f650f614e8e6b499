"""Time of building FMUs: the first of a structure, which is compiled, and variants of it, which are not.

Each build is a command of its own, `jointfmu build NAME --params FILE --flavour fmi3`, from start to end. The
first starts with nothing kept and the compiler's cache empty; of the variants the shortest time counts.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from jointfmu.joints import MODELS
from jointfmu.parameters import format_parameter_file, load_default

VARIANTS = 5
CHANGE = 1e-3
"""Relative change of a parameter from variant to variant [1]."""


def variant(name: str, k: int) -> str:
    """A parameter file that no other build has had."""
    file = load_default(MODELS[name].joint)
    number = next(n for n in MODELS[name].parameter_fields() if file.values_by_name[n])
    value = file.values_by_name[number] * (1.0 - CHANGE * k)
    return format_parameter_file(file.with_values({number: value}, "user", "benchmark"))


def built(name: str, k: int, work: Path) -> float:
    """Time of one build [s]."""
    parameters = work / f"{k}.toml"
    parameters.write_text(variant(name, k), encoding="utf-8")
    caches = {"JOINTFMU_CACHE": str(work / "parts"), "ZIG_GLOBAL_CACHE_DIR": str(work / "zig")}
    command = ("-m", "jointfmu", "build", name, "--params", str(parameters), "--flavour", "fmi3")
    begin = perf_counter()
    subprocess.run(
        [sys.executable, *command, "--out", str(work / "dist")],
        check=True,
        capture_output=True,
        env=os.environ | caches,
    )
    return perf_counter() - begin


def main() -> None:
    """Print the table."""
    print(f"{'FMU':24} {'first [s]':>10} {'variant [s]':>12}")
    for name in MODELS:
        with tempfile.TemporaryDirectory() as folder:
            first, *others = (built(name, k, Path(folder)) for k in range(VARIANTS + 1))
        print(f"{name:24} {first:10.1f} {min(others):12.2f}")


if __name__ == "__main__":
    main()
