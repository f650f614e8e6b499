"""Contents of FMUs and Modelica components are the same on every processor.

OpenBLAS and numpy choose their code by the processor; their variables choose that of others, as far as this
one runs it. The shipped parameter files, a plate, and a row of bolts; what `new` writes of a plate. `.ci/run`
runs the fast tests so, too.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from subprocess import PIPE

import numbers_of_all
import numpy as np
import pytest
from clients import needs
from conftest import REFINEMENT
from jointfmu_tools import cli
from numbers_of_all import components, texts

pytestmark = pytest.mark.slow

AVX = "X86_V3,AVX2,FMA3,X86_V4,AVX512_ICL,AVX512F,AVX512CD,AVX512_SKX"
"""Names of the instruction sets for numpy 2.4 and for earlier versions; numpy ignores unknown names."""
OLD = {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": AVX}
"""Environment variables that select code for a processor without AVX2. Processors of the last ten years have
AVX2, so this is other code."""
AGREE, PROOF = 1e-9, 1e-7
"""Relative tolerance of numbers in C and Modelica, and of proof results over the largest value of their
column. Near the limits of the law, terms cancel, and the numbers differ by 1e-8."""
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.\d*|\.\d+|\d+)(?:[eE][-+]?\d+)?(?![\w.])")
TOKEN = re.compile(r"\{[0-9a-f-]{36}\}")
COARSE = """import sys
from jointfmu_tools.cli import main
from jointfmu_tools.fem.whole_joint import JointFiniteElements

mesh = JointFiniteElements.from_assembly
JointFiniteElements.from_assembly = lambda assembly, attachment, **_: mesh(assembly, attachment, {bodies})
sys.exit(main(sys.argv[1:]))"""
COMMITTED = Path(__file__).resolve().parents[2] / "models" / "modelica"
SURFACE = ["--material", "steel", "--Ra", "0.8"]
PLATES = {
    "plate": ["--plate", "80x50", "--bolts", "4xM8", "--at", "50x25"],
    "row": ["--plate", "120x25", "--bolts", "3xM8", "--at", "60x0"],
}


def drawing(name: str, folder: Path) -> list[str]:
    """Arguments of the command that writes the parameter file of a plate into a folder."""
    out = ["--out", str(folder / f"{name}.toml")]
    return ["new", "bolted-joint", *PLATES[name], "--grip", "40", *SURFACE, *out]


def elsewhere(folder: Path, paths: list[Path]) -> dict[str, str]:
    """Texts {case: text} computed with the instruction set of an old processor."""
    script = [sys.executable, numbers_of_all.__file__, str(folder)]
    run = subprocess.run([*script, *map(str, paths)], env=os.environ | OLD, stdout=PIPE)
    assert run.returncode == 0
    return json.loads(run.stdout)


@pytest.fixture(scope="module")
def paths(tmp_path_factory) -> list[Path]:
    """Parameter files: plate with four bolts and its bodies, plate with a row of three bolts."""
    folder = tmp_path_factory.mktemp("files")
    first, *others = PLATES
    assert cli.main(drawing(first, folder)) == 0
    for name in others:
        assert cli.main([*drawing(name, folder), "--sides", "rigid"]) == 0
    return sorted(folder.iterdir())


@pytest.fixture(scope="module")
def here(paths) -> dict[str, str]:
    """Texts computed in this process; the library is the committed one, which tests/modelica compares with
    the generator."""
    return texts(paths) | components(COMMITTED)


newer = needs("AVX2", "gmsh")


@newer
def test_the_file_of_a_whole_joint_is_the_same(tmp_path, paths):
    """The parameter file of a whole joint, computed as on an old processor with coarse elements, has the same
    text."""
    script = [sys.executable, "-c", COARSE.format(**REFINEMENT), *drawing("plate", tmp_path)]
    subprocess.run(script, env=os.environ | OLD, check=True, stdout=PIPE)
    here = next(path for path in paths if path.stem == "plate")
    assert (tmp_path / "plate.toml").read_text() == here.read_text()


@newer
def test_numbers_are_those_of_an_old_processor(tmp_path, here, paths):
    there = elsewhere(tmp_path, paths)
    assert there.keys() == here.keys()
    for what, text in here.items():
        if what.endswith(".csv"):
            one, other = (np.genfromtxt(t.splitlines()[1:], delimiter=",") for t in (text, there[what]))
            assert np.all(np.abs(other - one) <= PROOF * np.max(np.abs(one), axis=0)), what
            continue
        one, other = (TOKEN.sub("", t) for t in (text, there[what]))
        assert NUMBER.sub("#", one) == NUMBER.sub("#", other), what
        values = (np.array([float(n) for n in NUMBER.findall(t)]) for t in (one, other))
        np.testing.assert_allclose(*values, rtol=AGREE, atol=0.0, err_msg=what)
