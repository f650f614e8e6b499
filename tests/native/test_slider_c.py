"""Friction sliders in C against Python: generated return mapping and the loops around it, without an FMU."""

from collections.abc import Iterator
from ctypes import CDLL, POINTER, Structure, byref, c_double, c_int
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from jointfmu_fmu_src.joint_parts.graph import CFunctionSet
from jointfmu_fmu_src.joint_parts.sliders import add_slider_functions
from jointfmu_fmu_src.native.code import elementary
from jointfmu_fmu_src.native.code.emit import C_HELPER_FUNCTIONS, format_function
from jointfmu_fmu_src.native.code.generate import RUNTIME_FOLDER
from jointfmu_fmu_src.native.compiled import compiler

from jointfmu.mechanics.jenkins import (
    Sliders,
    elastic_predictor,
    return_map,
    slip_limit_function,
    yield_function,
)
from jointfmu.mechanics.sliders import sum_slider_forces, torsion_directions

pytestmark = pytest.mark.slow

MOVES, SLIDERS = 40_000, 40
ROUND_OFF = 1e-13
"""Round-off of a sum of some products over the largest compared value: C adds in another order."""
POINTER_TO = POINTER(c_double)
AVX = " avx " in Path("/proc/cpuinfo").read_text(encoding="utf-8")
"""Whether this processor has AVX."""


LINE = ("K", "compliance", "limit_start", "limit_end", "force")
PLANE = (
    *("force_x", "force_y", "torsion_x", "torsion_y", "retention", "secant_stiffness"),
    *("K", "compliance", "limit_start", "limit_end"),
)


class Sliders1D(Structure):
    """Struct `Sliders1D` of jenkins.h."""

    _fields_ = [(name, POINTER_TO) for name in LINE]


class Sliders2D(Structure):
    """Struct `Sliders2D` of jenkins.h."""

    _fields_ = [
        *((name, POINTER_TO) for name in PLANE),
        ("growth_start", c_double),
        ("growth_end", c_double),
        ("displacement", c_double * 3),
    ]


class SliderRates(Structure):
    """Struct `SliderRates` of jenkins.h."""

    _fields_ = [
        (name, POINTER_TO)
        for name in ("torsion_x", "torsion_y", "limit_rate", "displacement_rate_x", "displacement_rate_y")
    ]


class SliderResultant(Structure):
    """Struct `SliderResultant` of jenkins.h."""

    _fields_ = [("force", c_double * 3), ("tangent", c_double * 6), ("loss", c_double)]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> CDLL:
    """Library of the slider C code with all functions exported."""
    g = CFunctionSet({}, None, [])
    before = ca.GlobalOptions.getNumpyMode()
    ca.GlobalOptions.setNumpyMode(1)
    try:
        add_slider_functions(g)
    finally:
        ca.GlobalOptions.setNumpyMode(before)
    none = ca.SX.sym("none", 0)
    texts = [
        format_function(
            f.function_name,
            f.signature_comment,
            ca.vertcat(*f.argument_symbols),
            none,
            f.result_expressions,
            f.function_name.endswith("_seed"),
        )
        for f in g.c_functions
    ]
    law = "\n".join(text.replace("\nvoid ", "\nstatic inline void ", 1) for text in texts)
    names = ("jenkins.c", "jenkins.h", "simd.h", "elementary.c", "elementary.h")
    files = {name: (RUNTIME_FOLDER / "law" / name).read_text(encoding="utf-8") for name in names}
    files |= {"law.h": f'#include <math.h>\n#include "elementary.h"\n{C_HELPER_FUNCTIONS}\n{law}'}
    files |= {"elementary_tables.h": elementary.make_tables_header()}
    visible = "#pragma GCC visibility push(default)\n"
    files["jenkins.c"] = visible + files["jenkins.c"]
    made = compiler.compile_libraries("sliders", files, ["jenkins.c", "elementary.c"], ["x86_64-linux"])
    path = tmp_path_factory.mktemp("sliders") / "sliders.so"
    path.write_bytes(made["x86_64-linux"])
    found = CDLL(str(path))
    found.sliders_force_1d.restype = found.sliders_loss_derivative_1d.restype = c_double
    return found


def pointer(values: np.ndarray) -> "POINTER_TO":
    return values.ctypes.data_as(POINTER_TO)


def moves(plane: bool) -> Iterator[tuple[np.ndarray, ...]]:
    """Random increments: stiffness, limits before and after, forces (2, n) within the earlier limit,
    displacement along x, y and around (3); with sliders at the limit, without limit or stiffness, small and
    zero increments."""
    rng = np.random.default_rng(1)
    for _ in range(MOVES // SLIDERS):
        K = rng.uniform(0.1, 2.0, SLIDERS) * (rng.random(SLIDERS) > 0.1)
        before, rise = rng.random((2, SLIDERS)) * (rng.random((2, SLIDERS)) > 0.1)
        after = before if rng.random() < 0.5 else rise
        angle = rng.uniform(0.0, 2.0 * np.pi, SLIDERS) if plane else np.pi * rng.integers(0, 2, SLIDERS)
        size = before * np.where(rng.random(SLIDERS) < 0.3, 1.0, rng.random(SLIDERS))
        shift = rng.normal(size=3) * rng.choice([0.0, 1e-9, 1e-3, 0.3, 3.0])
        yield K, before, after, size * np.array([np.cos(angle), np.sin(angle) * plane]), shift


def rows_of(K: np.ndarray, before: np.ndarray, after: np.ndarray, force: np.ndarray) -> dict[str, np.ndarray]:
    """Arguments of the C functions for sliders of constant stiffness."""
    x, y = force
    per_K = np.divide(1.0, K, out=np.zeros_like(K), where=K > 0.0)
    e_x, e_y = np.ascontiguousarray(torsion_directions(SLIDERS))
    rows = {
        "K": K,
        "compliance": per_K,
        "limit_start": before,
        "limit_end": after,
        "force": x,
        "force_x": x,
        "force_y": y,
    }
    return rows | {"torsion_x": e_x, "torsion_y": e_y, "retention": np.ones_like(K), "secant_stiffness": K}


def in_c(rows: dict[str, np.ndarray]) -> Sliders1D:
    """C struct of the rows; the rows must stay referenced as long as the struct."""
    return Sliders1D(*(pointer(rows[name]) for name in LINE))


def assert_close(found: object, expected: object, size: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=ROUND_OFF * size)


def test_along_one_direction(library: CDLL) -> None:
    """Along one direction, C and Python agree in forces, sums, tangent and rates of a changing limit, and in
    the derivative of the heat at a constant limit."""
    moved, slipped = np.empty(SLIDERS), 0
    for K, before, after, force, (u, *_) in moves(plane=False):
        rows = rows_of(K, before, after, force)
        s = in_c(rows)
        total, rate = SliderResultant(), SliderResultant()
        library.sliders_advance_1d(AVX, SLIDERS, byref(s), c_double(u), pointer(moved), byref(total))
        expected = Sliders(K).advance_1d(force[0], u, before, after)
        size = 1.0 + abs(u) * float(np.sum(K))
        assert_close(moved, expected.force, size)
        assert_close(
            [total.force[0], total.loss], [expected.traction, expected.dissipated_energy], SLIDERS * size**2
        )
        assert total.tangent[0] == pytest.approx(float(expected.tangent), abs=ROUND_OFF * SLIDERS)
        tried = force[0] + K * u
        slips = np.abs(tried) > after
        slipped += int(np.sum(slips))
        if after is before:
            heat = library.sliders_loss_derivative_1d(SLIDERS, byref(s), c_double(u))
            assert heat == pytest.approx(float(np.sign(tried) @ np.where(slips, after, 0.0)), abs=ROUND_OFF)
        elif np.all(after[slips] > 0.0):
            ones = pointer(np.ones(SLIDERS))
            library.sliders_advance_1d_rate(SLIDERS, byref(s), c_double(u), c_double(1.0), ones, byref(rate))
            rises = float(np.sum(np.sign(tried[slips])))
            assert rate.force[0] == pytest.approx(float(expected.tangent) + rises, abs=ROUND_OFF * SLIDERS)
    assert 0.2 * MOVES < slipped < 0.8 * MOVES


def of_each(shift: np.ndarray) -> np.ndarray:
    """Displacements (2, n) of the sliders."""
    return np.asarray(shift[:2, None] + shift[2] * torsion_directions(SLIDERS))


def in_plane(library: CDLL, rows: dict[str, np.ndarray], shift: np.ndarray) -> np.ndarray:
    """Force, tangent, loss and slip (7, n) in C: sliders before the first one at its limit stick, the others
    may slip. Asserts that variants of the function agree, with AVX to the bit."""
    s = Sliders2D(*(pointer(rows[name]) for name in PLANE), 0.0, 0.0, (c_double * 3)(*shift))
    tried, sticks = np.empty((2, SLIDERS)), (c_double * 3)()
    out = (POINTER_TO * 2)(*map(pointer, tried))
    first = library.sliders_predict(AVX, SLIDERS, byref(s), out, sticks)
    at_limit = np.append(slip_limit_function(list(tried), rows["limit_end"]) > 0.0, True)
    assert first == np.argmax(at_limit) // 2 * 2
    sums = sum_slider_forces(np.where(np.arange(SLIDERS) < first, tried, 0.0))
    assert_close(list(sticks), sums, SLIDERS * (1.0 + np.max(np.abs(tried))))
    found, fours, alone = np.empty((3, 7, SLIDERS))
    for slid, by_four, forces in ((found, False, False), (fours, AVX, False), (alone, AVX, True)):
        into = (POINTER_TO * 7)(*map(pointer, slid))
        library.sliders_return_map(by_four, 0, SLIDERS, byref(s), into, forces)
        total = SliderResultant()
        library.sliders_resultant(by_four, 0, SLIDERS, byref(s), into, byref(total))
        assert_close(list(total.force), sum_slider_forces(slid[:2]), SLIDERS * (1.0 + np.max(np.abs(tried))))
    np.testing.assert_array_equal(fours, found)
    assert_close(alone[:2], found[:2], 1.0 + np.max(np.abs(tried)))
    np.testing.assert_array_equal(found[:2, :first], tried[:, :first])
    return found


def test_in_a_plane(library: CDLL) -> None:
    """In a plane, C and Python agree in forces, tangents and heat."""
    slipped = 0
    for K, before, after, force, shift in moves(plane=True):
        rows = rows_of(K, before, after, force)
        moved, tangent, loss = np.split(in_plane(library, rows, shift)[:6], [2, 5])
        tried = elastic_predictor(list(force), 1.0, K, list(of_each(shift)))
        slid = return_map(list(force), 1.0, K, list(of_each(shift)), before, after, K, rows["compliance"])
        size = 1.0 + float(np.linalg.norm(shift) * np.sum(K))
        assert_close(moved, slid.force, size)
        assert_close(loss[0], slid.dissipated_energy, size**2)
        assert_close(tangent, slid.tangent, SLIDERS)
        slips = yield_function(tried, after) > 0.0
        slipped += int(np.sum(slips))
        assert np.all(np.isfinite(moved)), (K, before, after)
        assert np.all(np.hypot(*moved) <= after * (1.0 + ROUND_OFF) + ROUND_OFF)
    assert 0.2 * MOVES < slipped < 0.8 * MOVES


def slopes(library: CDLL, rows: dict[str, np.ndarray], shift: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Derivatives (4, 3) of the resultant along the displacement, and along `rates` of the limits."""
    s = Sliders2D(*(pointer(rows[name]) for name in PLANE), 0.0, 0.0, (c_double * 3)(*shift))
    given = SliderRates(*map(pointer, (rows["torsion_x"], rows["torsion_y"], *rates)))
    found, fours = np.empty((2, 4, 3))
    for slope, by_four in ((found, False), (fours, AVX)):
        library.sliders_force_derivatives(by_four, SLIDERS, byref(s), byref(given), pointer(slope))
    np.testing.assert_array_equal(fours, found)
    return found


def forces_together(
    rows: dict[str, np.ndarray], shift: np.ndarray, rates: np.ndarray, motion: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Resultant (3) after a displacement and a further motion (4), and mask of the slipping sliders."""
    force, K = [rows["force_x"], rows["force_y"]], rows["K"]
    after = rows["limit_end"] + motion[3] * rates[0]
    each = list(of_each(shift + motion[:3]) + motion[3] * rates[1:])
    slid = return_map(force, 1.0, K, each, rows["limit_start"], after, K, rows["compliance"])
    return sum_slider_forces(np.array(slid.force)), yield_function(
        elastic_predictor(force, 1.0, K, each), after
    ) > 0.0


def test_slopes(library: CDLL) -> None:
    """Slopes are finite for any sliders. Away from the start and end of slip they agree with differences,
    within the step over the smallest limit."""
    rng, step, compared = np.random.default_rng(2), 1e-6, 0
    for K, before, after, force, shift in moves(plane=True):
        rates = rng.normal(size=(3, SLIDERS))
        assert np.all(np.isfinite(slopes(library, rows_of(K, before, after, force), shift, rates)))
        if compared > MOVES // SLIDERS:
            continue
        rows = rows_of(K, 0.1 + before, 0.1 + after + 0.01 * rng.random(SLIDERS), force)
        found = slopes(library, rows, shift, rates)
        for slope, motion in zip(found, step * np.eye(4), strict=True):
            (more, slips), (less, others) = (
                forces_together(rows, shift, rates, x) for x in (motion, -motion)
            )
            if np.array_equal(slips, others):
                compared += 1
                difference = (more - less) / (2.0 * step)
                np.testing.assert_allclose(difference, slope, rtol=0.0, atol=1e-4 * SLIDERS)
    assert compared > MOVES // SLIDERS


def test_a_path_that_moves_nothing_changes_nothing(library: CDLL) -> None:
    """Sliders that return to their limit stick: no heat and no change of force, for any direction."""
    for K, limit, _, force, shift in moves(plane=True):
        there = in_plane(library, rows_of(K, limit, limit, force), shift)[:2]
        found = in_plane(library, rows_of(K, limit, limit, there), np.zeros(3))
        np.testing.assert_array_equal(found[:2], there)
        assert np.all(found[5] == 0.0)


def test_limits_grow_by_the_stiffness(library: CDLL) -> None:
    """Limits grow from the stored value, and are never negative."""
    for K, before, after, force, shift in moves(plane=True):
        rows, found = rows_of(K, before, after, force), np.empty((2, 7, SLIDERS))
        grown = [
            rows | {"limit_start": before - K, "limit_end": after - 2.0 * K},
            rows_of(K, before, after, force),
        ]
        grown[1] |= {"limit_start": np.maximum(grown[0]["limit_start"] + 0.5 * K, 0.0)}
        grown[1] |= {"limit_end": np.maximum(grown[0]["limit_end"] + 1.5 * K, 0.0)}
        for given, ways, slid in zip(grown, ((0.5, 1.5), (0.0, 0.0)), found, strict=True):
            s = Sliders2D(*(pointer(given[name]) for name in PLANE), *ways, (c_double * 3)(*shift))
            library.sliders_return_map(
                AVX, 0, SLIDERS, byref(s), (POINTER_TO * 7)(*map(pointer, slid)), False
            )
        np.testing.assert_array_equal(*found)


def test_force_alone(library: CDLL) -> None:
    """The force without tangent equals the force with tangent."""
    for K, limit, _, force, (u, *_) in moves(plane=False):
        rows = rows_of(K, limit, limit, force)
        s = in_c(rows)
        tangent = c_double()
        found = library.sliders_force_1d(c_int(SLIDERS), byref(s), c_double(u), byref(tangent))
        expected = Sliders(K).advance_1d(force[0], u, limit, limit)
        size = 1.0 + abs(u) * float(np.sum(K))
        assert_close([found, tangent.value], [expected.traction, expected.tangent], SLIDERS * size)
