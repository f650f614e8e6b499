"""Memory of a running FMU: no allocation after initialization, functions with less than a page of stack."""

import ctypes
from pathlib import Path

import fmpy
import numpy as np
import pytest
from clients import needs
from joint_cases import CASES
from jointfmu_fmu_src.native.compiled import compiler
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import build_system_fmus
from jointfmu_tools.systems.system import load_system

from jointfmu.joints import MODELS

pytestmark = [
    pytest.mark.slow,
    needs("Linux"),
]
COUNTED = """
#include <stdlib.h>
__attribute__((visibility("default"))) long allocations;
void *counted_malloc(size_t n) { allocations++; return malloc(n); }
void *counted_calloc(size_t n, size_t size) { allocations++; return calloc(n, size); }
void *counted_realloc(void *p, size_t n) { allocations++; return realloc(p, n); }
"""
OPTIONS = (
    *(f"-D{name}=counted_{name}" for name in ("malloc", "calloc", "realloc")),
    "-Wframe-larger-than=4096",
    "-Wvla",
    "-Walloca",
    "-Werror",
)
"""Compiler options that also refuse a function with more than a page of stack, and stack of variable size."""


def counted(fmu, folder):
    """Unpacked FMU with its own sources compiled so that allocations are counted."""
    unzipped = Path(fmpy.extract(str(fmu), str(folder)))
    files = {
        path.name: path.read_text(encoding="utf-8")
        for path in (unzipped / "sources").iterdir()
        if path.suffix in (".c", ".h")
    }
    for name, text in files.items():
        if "alloc(" in text and name.endswith(".c"):
            declared = "void *counted_malloc(size_t); void *counted_calloc(size_t, size_t);\n"
            files[name] = f"#include <stddef.h>\n{declared}void *counted_realloc(void *, size_t);\n{text}"
    files["counted.c"] = "#undef malloc\n#undef calloc\n#undef realloc\n" + COUNTED
    units = [name for name in files if name.endswith(".c") and name not in ("windows.c", "fmi3.c")]
    (built,) = compiler.compile_libraries(
        fmu.stem, files, units, [fmpy.platform_tuple], linker_options=OPTIONS
    ).values()
    (library,) = (unzipped / "binaries" / fmpy.platform).glob("*.so")
    library.write_bytes(built)
    return unzipped


def grown(unzipped, spans, step, steps):
    """Number of allocations after initialization, over steps with random inputs from {input: (low, high)}."""
    description = fmpy.read_model_description(str(unzipped))
    refs = {v.name: v.valueReference for v in description.modelVariables}
    fmu = fmpy.instantiate_fmu(str(unzipped), description, "CoSimulation")
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    count = ctypes.c_long.in_dll(fmu.dll, "allocations")
    before, draw = count.value, np.random.default_rng(1)
    outputs = [v.valueReference for v in description.modelVariables if v.causality == "output"]
    seen = []
    for k in range(steps):
        fmu.setReal([refs[name] for name in spans], draw.uniform(*zip(*spans.values(), strict=True)).tolist())
        fmu.doStep(k * step, step)
        seen.append(fmu.getReal(outputs))
    after = count.value
    fmu.terminate()
    fmu.freeInstance()
    assert before > 0
    assert np.isfinite(seen).all()
    assert len({tuple(row) for row in seen}) > 1
    return after - before


@pytest.mark.parametrize("name", MODELS)
def test_a_joint_allocates_nothing_after_initialization(name, native, tmp_path):
    assert (
        grown(counted(native / "fmi2" / f"{name}.fmu", tmp_path), dict(CASES[name].numbers.span), 1.0, 300)
        == 0
    )


def test_a_system_allocates_nothing_after_initialization(tmp_path):
    (fmu,) = build_system_fmus(
        assemble_system(load_system("robot_joint")), tmp_path, ("2",), (fmpy.platform_tuple,)
    )
    assert grown(counted(fmu, tmp_path / "unpacked"), {"load.tau_in": (-0.03, 0.03)}, 1e-2, 150) == 0
