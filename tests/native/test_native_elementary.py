"""Elementary functions of the native FMUs against decimal arithmetic of 50 digits: round-off in ulps."""

import ctypes
import math
from collections.abc import Callable
from decimal import Decimal, localcontext

import fmpy
import numpy as np
import pytest
from jointfmu_fmu_src.native.code.elementary import make_tables_header
from jointfmu_fmu_src.native.code.generate import RUNTIME_FOLDER
from jointfmu_fmu_src.native.compiled.compiler import compile_libraries, make_library_file_name

pytestmark = pytest.mark.slow

ARGUMENTS = {"pow": 2}
NAMES = ("exp", "log", "pow", "expm1", "log1p", "sinh", "cosh", "tanh", "asinh", "erf", "sin", "cos")
DIGITS = 50
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803")


@pytest.fixture(scope="module")
def functions(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Callable[..., float]]:
    """{name: function of the C library under test}."""
    folder, here = tmp_path_factory.mktemp("elementary"), fmpy.platform_tuple
    lines = ['#include "elementary.h"']
    for name in NAMES:
        given = ", ".join(f"double x{i}" for i in range(ARGUMENTS.get(name, 1)))
        call = f"portable_{name}({given.replace('double ', '')})"
        visible = '__attribute__((visibility("default")))'
        lines.append(
            f"{visible} double shown_{name}({given});\ndouble shown_{name}({given}) {{ return {call}; }}"
        )
    files = {path.name: path.read_text() for path in RUNTIME_FOLDER.rglob("elementary.*")}
    files |= {"elementary_tables.h": make_tables_header(), "shown.c": "\n".join(lines) + "\n"}
    path = folder / make_library_file_name("Elementary", here)
    path.write_bytes(compile_libraries("Elementary", files, ["elementary.c", "shown.c"], [here])[here])
    library, found = ctypes.CDLL(str(path)), {}
    for name in NAMES:
        found[name] = getattr(library, f"shown_{name}")
        found[name].restype = ctypes.c_double
        found[name].argtypes = [ctypes.c_double] * ARGUMENTS.get(name, 1)
    return found


def series(term: Decimal, ratio: Callable[[int], Decimal]) -> Decimal:
    """Sum of a series; ratio(n) is term n + 1 over term n."""
    total, n = term, 0
    while abs(term) > Decimal(10) ** -DIGITS:
        term *= ratio(n)
        total, n = total + term, n + 1
    return total


def wave(x: Decimal, quarters: int) -> Decimal:
    """sin(x + quarters pi/2)."""
    turns = (2 * x / PI).to_integral_value()
    r, quarter = x - turns * PI / 2, (int(turns) + quarters) % 4
    odd = quarter % 2
    value = series(
        Decimal(1) if odd else r,
        lambda n: -r * r / ((2 * n + 1) * (2 * n + 2) if odd else (2 * n + 2) * (2 * n + 3)),
    )
    return -value if quarter >= 2 else value


def erf(x: Decimal) -> Decimal:
    return 2 / PI.sqrt() * (-x * x).exp() * series(x, lambda n: 2 * x * x / (2 * n + 3))


EXACT: dict[str, Callable[..., Decimal]] = {
    "exp": Decimal.exp,
    "log": Decimal.ln,
    "pow": lambda x, y: (x.ln() * y).exp(),
    "expm1": lambda x: x.exp() - 1,
    "log1p": lambda x: (1 + x).ln(),
    "sinh": lambda x: (x.exp() - (-x).exp()) / 2,
    "cosh": lambda x: (x.exp() + (-x).exp()) / 2,
    "tanh": lambda x: 1 - 2 / ((2 * x).exp() + 1),
    "asinh": lambda x: (abs(x) + (x * x + 1).sqrt()).ln().copy_sign(x),
    "erf": erf,
    "sin": lambda x: wave(x, 0),
    "cos": lambda x: wave(x, 1),
}
ULPS = {"exp": 0.52, "pow": 0.6, "log": 1.0, "log1p": 0.6, "sin": 0.8, "cos": 0.8, "expm1": 1.1}
"""Largest error [ulp]: half an ulp by rounding the result, more for functions with two or three further
roundings."""
USUAL_ULPS = 2.0


def arguments(name: str, rng: np.random.Generator, n: int = 400) -> list[tuple[float, ...]]:
    """Random arguments: usual ones, small ones, and up to the ends of the range."""
    usual, small = rng.normal(0.0, 1.5, n), rng.normal(0.0, 1.0, n) * 10.0 ** rng.uniform(-9, -1, n)
    far = {"sin": 1e6, "cos": 1e6, "asinh": 1e12, "erf": 5.9, "tanh": 30.0}.get(name, 700.0)
    wide = rng.uniform(-far, far, n)
    if name == "pow":
        near = [*zip(1.0 + 0.1 * small, rng.uniform(-1e3, 1e3, n), strict=True)]
        return [*zip(np.exp(usual), rng.uniform(-100.0, 100.0, n), strict=True), *near]
    if name in ("log", "log1p"):
        usual, small, wide = np.exp(usual), (small if name == "log1p" else 1.0 + small), np.exp(abs(wide))
    if name in ("sin", "cos"):
        wide = np.concatenate([wide, 0.5 * np.pi * rng.integers(1, 10**6, n)])  # nearly zeros
    return [(x,) for x in np.concatenate([usual, small, wide]).tolist()]


@pytest.mark.parametrize("name", NAMES)
def test_round_off(functions: dict[str, Callable[..., float]], name: str) -> None:
    with localcontext() as context:
        context.prec = DIGITS + 10
        for x in arguments(name, np.random.default_rng(8)):
            exact = EXACT[name](*(Decimal(float(v)) for v in x))
            off = abs(Decimal(functions[name](*x)) - exact) / Decimal(math.ulp(float(exact)))
            assert off <= ULPS.get(name, USUAL_ULPS), (x, float(off))


def test_ends_of_the_range(functions: dict[str, Callable[..., float]]) -> None:
    inf, nan = math.inf, math.nan
    expected = {
        "exp": [(inf, inf), (-inf, 0.0), (710.0, inf), (-745.0, 5e-324), (-746.0, 0.0), (0.0, 1.0)],
        "log": [(0.0, -inf), (inf, inf), (-1.0, nan), (1.0, 0.0), (5e-324, math.log(5e-324))],
        "expm1": [(inf, inf), (-inf, -1.0), (1e-310, 1e-310)],
        "log1p": [(inf, inf), (-1.0, -inf), (-2.0, nan), (1e-310, 1e-310)],
        "sinh": [(inf, inf), (-inf, -inf), (-800.0, -inf)],
        "cosh": [(inf, inf), (-inf, inf), (0.0, 1.0)],
        "tanh": [(inf, 1.0), (-inf, -1.0)],
        "asinh": [(inf, inf), (-inf, -inf)],
        "erf": [(inf, 1.0), (-inf, -1.0), (7.0, 1.0)],
        "sin": [(inf, nan), (0.0, 0.0)],
        "cos": [(inf, nan), (0.0, 1.0)],
    }
    for name, rows in expected.items():
        for x, value in [*rows, (nan, nan)]:
            assert functions[name](x) == pytest.approx(value, rel=0.0, abs=0.0, nan_ok=True), (name, x)
    power = functions["pow"]
    for x in (0.0, 0.5, 1.0, 3.0, inf, -2.0, nan):
        for y in (0.0, 0.5, 2.0, 3.0, -1.0, inf, -inf, 2000.0, nan):
            with np.errstate(all="ignore"):
                assert power(x, y) == pytest.approx(float(np.power(x, y)), rel=1e-15, nan_ok=True), (x, y)
