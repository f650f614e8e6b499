"""Generated C functions that compute their leading results alone: same bits, and the others are left out."""

import ctypes

import casadi as ca
import fmpy
import numpy as np
import pytest
from jointfmu_fmu_src.native.code.elementary import make_tables_header
from jointfmu_fmu_src.native.code.emit import C_HELPER_FUNCTIONS, format_function
from jointfmu_fmu_src.native.code.generate import RUNTIME_FOLDER
from jointfmu_fmu_src.native.compiled.compiler import compile_libraries, make_library_file_name

pytestmark = pytest.mark.slow

LEADING, RESULTS, WORKSPACE = 2, 5, 20


@pytest.mark.parametrize("has_workspace", [False, True])
def test_leading_results_are_the_same_without_the_others(tmp_path, has_workspace):
    """Sine and cosine of one angle, and divisions by one number, are on both sides of the return."""
    x, c = ca.SX.sym("x", 3), ca.SX.sym("c", 1)
    sine, quotient = ca.sin(x[0]), x[1] / (1.0 + x[2] * x[2])
    results = [
        sine * quotient,
        c[0] * ca.exp(x[1]) + quotient,
        ca.cos(x[0]) / (1.0 + x[2] * x[2]),
        ca.if_else(x[0] > 0.0, ca.log(1.0 + x[2] * x[2]), sine),
        quotient * quotient,
    ]
    text = format_function(
        "f", "x -> y", x, c, results, has_workspace=has_workspace, leading_result_count=LEADING
    )
    files = {path.name: path.read_text() for path in RUNTIME_FOLDER.rglob("elementary.*")}
    head = '#include <math.h>\n#include <stddef.h>\n#include "elementary.h"\n'
    visible = '__attribute__((visibility("default")))'
    declaration = f"{visible} void f(const double *x, const double *c, size_t n, double *y);\n"
    files |= {
        "elementary_tables.h": make_tables_header(),
        "f.c": head + C_HELPER_FUNCTIONS + declaration + text,
    }
    here = fmpy.platform_tuple
    path = tmp_path / make_library_file_name("Function", here)
    path.write_bytes(compile_libraries("Function", files, ["elementary.c", "f.c"], [here])[here])
    function = ctypes.CDLL(str(path)).f
    function.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    rng, constant = np.random.default_rng(4), np.array([0.7])
    graph = ca.Function("graph", [x, c], [ca.vertcat(*results)])
    for _ in range(100):
        arguments, every, leading = rng.normal(size=3), np.full(WORKSPACE, np.nan), np.full(WORKSPACE, np.nan)
        for count, y in ((RESULTS, every), (LEADING, leading)):
            function(arguments.ctypes.data, constant.ctypes.data, count, y.ctypes.data)
        expected = graph(arguments, constant).full().ravel()
        assert every[:RESULTS] == pytest.approx(expected, rel=1e-14, abs=1e-14)  # round-off of a few products
        assert leading[:LEADING].tolist() == every[:LEADING].tolist()
        assert np.isnan(leading[LEADING:RESULTS]).all()
