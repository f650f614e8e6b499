"""Time of the first build of an FMU, which compiles, over the time of variants, which use the compiled model.

    python benchmarks/build.py [--quick]

Each build is a command, `jointfmu build NAME --params FILE --flavour fmi3`, from start to end. The first
build starts with an empty cache of the package and of the compiler. The time of a variant is the shortest of
some variants.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from harness import read_options, time_fastest_call

from jointfmu.joints import MODELS
from jointfmu.parameters import format_parameter_file, load_default

VARIANTS = 5
CHANGE = 1e-3
"""Relative change of a parameter from variant to variant [1]."""


def make_variant(name: str, k: int) -> str:
    """Parameter file with a number that no other build has used."""
    file = load_default(MODELS[name].joint)
    number = next(n for n in MODELS[name].parameter_fields() if file.values_by_name[n])
    value = file.values_by_name[number] * (1.0 - CHANGE * k)
    return format_parameter_file(file.with_values({number: value}, "user", "benchmark"))


def build(name: str, k: int, folder: Path) -> float:
    """Time of one build [s]."""
    parameters = folder / f"{k}.toml"
    parameters.write_text(make_variant(name, k), encoding="utf-8")
    caches = {"JOINTFMU_CACHE": str(folder / "parts"), "ZIG_GLOBAL_CACHE_DIR": str(folder / "zig")}
    command = ["-m", "jointfmu", "build", name, "--params", str(parameters), "--flavour", "fmi3"]
    command += ["--out", str(folder / "dist")]
    environment = os.environ | caches
    _, seconds = time_fastest_call(
        lambda: subprocess.run([sys.executable, *command], check=True, capture_output=True, env=environment),
        repeats=1,
    )
    return seconds


def main() -> None:
    """Print the table of build times."""
    quick = read_options(__doc__).quick
    print(f"{'FMU':24} {'first [s]':>10} {'variant [s]':>12} {'ratio':>7}")
    for name in [*MODELS][: 1 if quick else None]:
        with tempfile.TemporaryDirectory() as folder:
            first, *others = (build(name, k, Path(folder)) for k in range(2 if quick else VARIANTS + 1))
        print(f"{name:24} {first:10.1f} {min(others):12.2f} {first / min(others):7.1f}")


if __name__ == "__main__":
    main()
