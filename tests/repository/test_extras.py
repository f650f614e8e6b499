"""Extras: each alone is sufficient for the first command of its page; other packages cannot be imported."""

import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

import coarse
import numpy as np
import pytest
from clients import needs
from jointfmu_tools.inputs.fields.nodal_result import ContactPressureField, format_field_csv
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from jointfmu.joints.bolted_joint.law import get_bolted_frame
from jointfmu.parameters import load_default

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
JOINTFMU = [sys.executable, "-m", "jointfmu"]
FIRST_COMMANDS = {
    "build": [*JOINTFMU, "build", "GearContact", "--flavour", "fmi2"],
    "surface": [*JOINTFMU, "surface", "scan.csv", "--plot", "flange.png"],
    "uncertainty": [
        *(*JOINTFMU, "uncertainty", "harmonic_drive", "--set", "surface.D=2.45..2.6", "eccentricity=0..1e-5"),
        *("--samples", "8", "--plot", "bands.png"),
    ],
    "field": [*JOINTFMU, "footprint", "import", "field.csv", "--preload", "9000", "--plot", "field.png"],
    "fem": [
        *(*JOINTFMU, "footprint", "compute", str(ROOT / "models/assemblies/box_specimen.toml")),
        *("--preload", "9000", "--refinement", "0.5", "--plot", "pressure.png"),
    ],
    "mujoco": [
        *(*JOINTFMU, "robot", str(ROOT / "models/robots/six_axis.xml"), "--drive", "joint3=CSG-25-100"),
        *("--out", "arm"),
    ],
}
"""{extra: first command of its page, with the smallest input}."""
NO_COMMAND = {"cluster", "sweep", "docs", "test", "check", "release"}
"""Extras without a command to test here: dask needs a cluster, test_docs.py builds the site with `docs`, the
others are for developers."""
BLOCKER = """
import os, sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in os.environ["BLOCKED_MODULES"].split():
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocked())
"""


def installed_with(extra: str) -> set[str]:
    """Names of the installed packages that `pip install 'jointfmu[extra]'` installs."""
    found: set[str] = set()
    waiting = [Requirement(text) for text in PROJECT["dependencies"]]
    waiting += [Requirement(text) for text in PROJECT["optional-dependencies"][extra]]
    seen = set()
    while waiting:
        wanted = waiting.pop()
        if wanted.marker and not any(wanted.marker.evaluate({"extra": e}) for e in ("", *wanted.extras)):
            continue
        if str(wanted) in seen:
            continue
        seen.add(str(wanted))
        name = canonicalize_name(wanted.name)
        if name == "jointfmu":
            texts = [t for e in wanted.extras for t in PROJECT["optional-dependencies"][e]]
        else:
            found.add(name)
            try:
                texts = requires(wanted.name) or []
            except PackageNotFoundError:
                continue
        for text in texts:
            needed = Requirement(text)
            if not needed.marker or any(needed.marker.evaluate({"extra": e}) for e in ("", *wanted.extras)):
                needed.marker = None
                waiting.append(needed)
    return found


def modules_without(packages: set[str]) -> set[str]:
    """Modules of installed packages outside `packages` and outside those that every environment has."""
    everywhere = {"jointfmu", "pip", "setuptools"}
    return {
        module
        for module, owners in packages_distributions().items()
        if re.fullmatch(r"[A-Za-z]\w*", module)
        and not {canonicalize_name(owner) for owner in owners} & (packages | everywhere)
    }


def environment_with(extra: str, blocker: Path) -> dict[str, str]:
    """Environment in which only what an extra installs can be imported; `blocker` is an empty folder."""
    (blocker / "sitecustomize.py").write_text(BLOCKER, encoding="utf-8")
    blocked = " ".join(sorted(modules_without(installed_with(extra))))
    return dict(os.environ) | {"PYTHONPATH": str(blocker), "BLOCKED_MODULES": blocked}


def write_inputs(folder: Path) -> None:
    """A scan of 64 x 64 heights, and the field of the default bolted joint at a preload of 9 kN."""
    heights = np.random.default_rng(1).standard_normal((64, 64)).cumsum(axis=0).cumsum(axis=1)
    rows = [",".join(f"{0.01 * z:.4f}" for z in line) for line in heights]
    (folder / "scan.csv").write_text(
        "\n".join(["# grid: dx = 1 um, dy = 1 um, z [um]", *rows]) + "\n", encoding="utf-8"
    )
    joint = load_default("bolted_joint").values
    with coarse.contact_cells(4):
        shape = get_bolted_frame(joint).pressure_distribution()
    p = shape.preload_pressure_ratio * 9e3 * joint.n_bolts / joint.A_0
    nodes = ContactPressureField(shape.area_share * joint.A_0, shape.position, p)
    (folder / "field.csv").write_text(format_field_csv(nodes), encoding="utf-8")


def test_all_extras_are_looked_at():
    assert set(FIRST_COMMANDS) | NO_COMMAND == set(PROJECT["optional-dependencies"])


@pytest.mark.parametrize(
    "extra",
    [pytest.param(extra, marks=needs("gmsh") if extra == "fem" else ()) for extra in FIRST_COMMANDS],
)
def test_the_first_command_of_a_page_needs_its_extra_alone(extra, tmp_path):
    (blocker := tmp_path / "blocker").mkdir()
    write_inputs(tmp_path)
    done = subprocess.run(
        FIRST_COMMANDS[extra],
        cwd=tmp_path,
        env=environment_with(extra, blocker) | {"JOINTFMU_CACHE": str(tmp_path / "cache")},
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert done.returncode == 0, done.stderr
