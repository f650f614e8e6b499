"""Installation without extras: commands that need none run, others say in one line what is missing."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from jointfmu_fmu_src.native.build import build_native_fmu as native_build
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from surroundings import Enter, environment

from jointfmu.joints import KINDS
from jointfmu.parameters import format_parameter_file, load_default

pytestmark = pytest.mark.slow  # each command is a process of its own

EXTRAS = (
    "casadi",
    "distributed",
    "gmsh",
    "mapdl_archive",
    "matplotlib",
    "meshio",
    "pythonfmu",
    "skfem",
    "tqdm",
    "ziglang",
)
PROGRAM = f"import sys; sys.modules.update(dict.fromkeys({EXTRAS}));"
FEW = (
    "from jointfmu_tools.pages.report import load_history; load_history._RAMP_POINT_COUNT = 11;"
    "load_history._LOAD_CYCLE = load_history.CyclicInputPath(points_per_cycle=8);"
)
"""Options for few points of ramp and loops on a page, to save time."""
MAIN = "from jointfmu_tools.cli import main; sys.exit(main(sys.argv[1:]))"


def bare(folder: Path, *words: str, first: str = "") -> subprocess.CompletedProcess[str]:
    """Result of a command in an environment without the packages of the extras."""
    start = [sys.executable, "-W", "ignore", "-c", PROGRAM + first + MAIN, *words]
    return subprocess.run(
        start, cwd=folder, env=dict(os.environ), capture_output=True, text=True, timeout=100
    )


def test_the_modelica_library_needs_no_extra(tmp_path: Path) -> None:
    done = bare(tmp_path, "modelica", "--out", "out")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "out/JointStiffness/package.mo").exists()


def test_a_system_rings_without_an_extra(tmp_path: Path, native: Path) -> None:
    fmus = tmp_path / "fmi2"
    native_build("RotationalInertia", partner_parameters("RotationalInertia"), fmus, "2")
    for name in ("HarmonicDriveSpring", "HarmonicDriveCompliance"):
        (fmus / f"{name}.fmu").symlink_to(native / f"fmi2/{name}.fmu")
    done = bare(tmp_path, "ring", "robot_joint", "--fmus", "fmi2", "--load", "0", "--csv", "ring.csv")
    assert done.returncode == 0
    assert all(line.startswith("note: ") for line in done.stderr.splitlines())
    assert (tmp_path / "ring.csv").exists()


def test_an_fmu_proves_itself_without_an_extra(tmp_path: Path, native: Path) -> None:
    done = bare(tmp_path, "prove", str(native / "fmi2" / "GearContact.fmu"))
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith(" passed, 0 missed\n")


@pytest.mark.parametrize("kind", KINDS)
def test_a_joint_has_its_page_without_an_extra(kind: str, tmp_path: Path) -> None:
    (tmp_path / "joint.toml").write_text(format_parameter_file(load_default(kind)))
    done = bare(tmp_path, "report", "joint.toml", first=FEW)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "joint.html").exists()


@pytest.mark.parametrize(
    ("words", "package"),
    [
        (("ring", "robot_joint", "--plot", "ring.png"), "matplotlib"),
        (("build", "GearContact"), "casadi"),
        (("modes", "absent.toml"), "skfem"),
        (("footprint", "compute", "absent.toml", "--preload", "9e3"), "skfem"),
    ],
)
def test_what_is_missing_is_named_in_one_line(
    words: tuple[str, ...], package: str, tmp_path: Path, enter: Enter
) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    (tmp_path / "joint.toml").write_text(format_parameter_file(load_default(next(iter(KINDS)))))
    done = bare(tmp_path, *words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert package in done.stderr
    assert "pip install" in done.stderr
    assert not [*tmp_path.glob("*.png"), *tmp_path.glob("*.html")]
