"""Native FMUs compiled again from their own sources, as by a recipient of the sources."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.run.ramps import ramp

from jointfmu.joints import MODELS

pytestmark = pytest.mark.slow

COMPILER_TOLERANCE = 1e-9
"""Largest relative difference [1] by a compiler that may contract a*b + c."""


@needs("cc and make")
@pytest.mark.parametrize(("name", "version"), [("BoltedJoint", "fmi2"), ("HarmonicDriveSpring", "fmi3")])
def test_fmpy_compiles_the_sources_to_the_same_fmu(
    native: Path, tmp_path: Path, name: str, version: str
) -> None:
    """Two FMUs with most C code of their own, one of each version; test_native_c.py checks the warnings of
    all."""
    built, again = native / version / f"{name}.fmu", tmp_path / f"{name}.fmu"
    with zipfile.ZipFile(built) as old, zipfile.ZipFile(again, "w") as new:
        for member in old.namelist():
            if not member.startswith("binaries/"):
                new.writestr(member, old.read(member))
    tools = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(
        [sys.executable, "-m", "fmpy", "compile", "--all-warnings", str(again)],
        env=os.environ | {"PATH": tools},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stdout + done.stderr
    model = MODELS[name]
    step = model.ramp.end_value / 20
    first, second = (
        ramp.run_ramp(fmu, model.ramp.input_name, model.ramp.end_value, step) for fmu in (built, again)
    )
    for column, values in first.variable_columns.items():
        scale = np.abs(values).max()
        np.testing.assert_allclose(
            second.variable_columns[column], values, rtol=0.0, atol=COMPILER_TOLERANCE * scale
        )
