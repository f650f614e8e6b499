"""Constants of the package in the C of native FMUs: a change reaches the C, or the build refuses."""

import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
from jointfmu_fmu_src import joints
from jointfmu_fmu_src.joint_parts.native import (
    INTEGER_CONSTANT_NAMES,
    REAL_CONSTANT_NAMES,
    CConstants,
    ModuleConstants,
)
from jointfmu_fmu_src.joints.harmonic_drive import native as drive_native
from jointfmu_fmu_src.native.code import generate

import jointfmu
from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint import equilibrium
from jointfmu.joints.harmonic_drive import hysteresis
from jointfmu.mechanics import curve
from jointfmu.parameters import load_default

pytestmark = pytest.mark.slow

DRIVE, BOLTED, GEAR = "HarmonicDriveSpring", "BoltedJoint", "GearContact"


def pairs(*given: ModuleConstants) -> list[tuple[ModuleType, str]]:
    """(module, name) of each number that C repeats."""
    return [(module, name) for one in given for module, names in one.items() for name in names]


TABLES = pairs(REAL_CONSTANT_NAMES, INTEGER_CONSTANT_NAMES)
EVERY = {
    DRIVE: (*TABLES, *pairs(drive_native.REAL_CONSTANT_NAMES), (hysteresis, "MAX_FRICTION_LIMIT_ITERATIONS")),
    GEAR: (*TABLES, (curve, "CLOSING_END_OVER_PLASTIC_SPOT_AREA")),
    BOLTED: tuple(
        (equilibrium, name) for name in ("MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE", "MIN_SHORTENING_FACTOR")
    ),
}


@contextmanager
def numbers(given: Mapping[tuple[ModuleType, str], float]) -> Iterator[None]:
    """Other values of constants {(module, name): value}."""
    kept = dict(generate._cached_law_sources)
    generate._cached_law_sources.clear()  # they are of the actual numbers
    with pytest.MonkeyPatch.context() as patch:
        for (module, name), value in given.items():
            patch.setattr(module, name, value)
        yield
    generate._cached_law_sources.clear()
    generate._cached_law_sources.update(kept)


def c_of(name: str, given: Mapping[tuple[ModuleType, str], float]) -> dict[str, str]:
    with numbers(given):
        return generate.generate_sources(name, load_default(MODELS[name].joint))


@cache
def usual(name: str) -> dict[str, str]:
    """C text with the actual numbers."""
    return c_of(name, {})


def compiles(folder: Path, files: dict[str, str], text: str) -> bool:
    """Whether the compiler accepts C text that includes the headers of the joint."""
    for name, content in (files | {"probe.c": text}).items():
        (folder / name).write_text(content, encoding="utf-8")
    command = (sys.executable, "-m", "ziglang", "cc", "-std=c11", "-c", "probe.c", "-o", "probe.o")
    return subprocess.run(command, cwd=folder, capture_output=True).returncode == 0


def test_one_name_of_a_constant_has_one_value() -> None:
    first = CConstants({"MAX_ITERATIONS": 200}, {"TOLERANCE": 1e-9})
    assert (first | CConstants({"MAX_ITERATIONS": 200})).integer_constants == {"MAX_ITERATIONS": 200}
    for other in (CConstants({"MAX_ITERATIONS": 16}), CConstants({}, {"MAX_ITERATIONS": 16.0})):
        with pytest.raises(ValueError, match="C constant MAX_ITERATIONS has two values"):
            _ = first | other


@pytest.mark.parametrize("name", EVERY)
def test_c_follows_the_numbers(name: str) -> None:
    before, expected = set(usual(name)["law.h"].splitlines()), set()
    doubled = {(module, constant): 2 * getattr(module, constant) for module, constant in EVERY[name]}
    for (_, constant), value in doubled.items():
        whole = isinstance(value, int)
        expected.add(f"    {constant} = {value}," if whole else f"#define {constant} {value!r}")
    assert set(c_of(name, doubled)["law.h"].splitlines()) - before == expected


def test_runtime_types_none_of_them_again() -> None:
    names = {constant for pairs in EVERY.values() for _, constant in pairs} | {"CURVE_NODES"}
    folders = [generate.RUNTIME_FOLDER, *(parts.joint_folder for parts in joints.FMU_BUILD_DATA.values())]
    for path in (path for folder in folders for path in folder.rglob("*.[ch]")):
        typed = re.findall(r"\b(\w+) = [-0-9]|#define (\w+)", path.read_text(encoding="utf-8"))
        assert names.isdisjoint(name for pair in typed for name in pair), path.name


@pytest.mark.parametrize(
    ("name", "module", "constant", "size"),
    [(DRIVE, curve, "MAX_TABLE_NODES", "CURVE_NODES"), (BOLTED, curve, "MAX_TABLE_NODES", "CURVE_NODES")],
)
def test_arrays_follow_a_count(
    tmp_path: Path,
    name: str,
    module: ModuleType,
    constant: str,
    size: str,
) -> None:
    count = 2 * getattr(module, constant)
    files = c_of(name, {(module, constant): count})
    text = f'#include "tabulated_joint.h"\n_Static_assert({size} >= {count} && {size} < {count + 100}, "");\n'
    assert compiles(tmp_path, files, text)
    assert not compiles(tmp_path, files, text.replace(">=", "<"))


@pytest.mark.parametrize(
    ("name", "source", "module", "constant", "value"),
    [
        (GEAR, "curve.c", curve, "MAX_TABLE_NODES", 70_000),  # buckets hold a segment's number in 16 bits
        (
            GEAR,
            "approach.c",
            curve,
            "CONTACT_CLOSING_STEPS",
            49,
        ),  # the error is measured on pairs of segments
    ],
)
def test_build_refuses_what_does_not_fit(
    tmp_path: Path,
    name: str,
    source: str,
    module: ModuleType,
    constant: str,
    value: int,
) -> None:
    files = usual(name)
    assert compiles(tmp_path, files, files[source])
    files = c_of(name, {(module, constant): value})
    assert not compiles(tmp_path, files, files[source])


def test_build_refuses_a_table_without_room(tmp_path: Path) -> None:
    usual_folder = tmp_path / "usual"
    jointfmu.load(DRIVE).build(usual_folder)  # compiled before the change, so that only the table is too long
    few = numbers({(curve, "MAX_TABLE_NODES"): 100})  # fewer than its first steps
    with few, pytest.raises(RuntimeError, match="the table of the law needs more than 100 nodes"):
        jointfmu.load(DRIVE).build(tmp_path / "small")
    assert list(tmp_path.iterdir()) == [usual_folder]
