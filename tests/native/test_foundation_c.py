"""Slider properties of a foundation in C against `Foundation.slider_properties`, compiled without an FMU."""

from ctypes import CDLL, POINTER, c_double, c_int
from dataclasses import dataclass

import fmpy
import numpy as np
import pytest
from jointfmu_fmu_src.native.code.generate import generate_sources
from jointfmu_fmu_src.native.compiled import compiler

from jointfmu.mechanics.curve import Curve, tabulate_approach
from jointfmu.mechanics.sliders import Foundation, heights_after_liftoff, slider_heights
from jointfmu.parameters import load_default

pytestmark = pytest.mark.slow

FOUNDATIONS, APPROACHES = 60, 40
ROUND_OFF = 1e-12
"""Error of a property over the size of the terms that cancel in it [1]."""
SLOPE_ROUND_OFF = 1e-10
"""Error of the stiffness slope, a second derivative of polynomials, over its largest value [1]."""
CALLER = """
#include "foundation.c"
__attribute__((visibility("default"))) int read_properties(int n, const double (*nodes)[5], const double *law,
                                                           int moves, const double *approach, double *heights,
                                                           double (*found)[FOUNDATION_SLIDER_COUNT][3])
{
    static Curve curve;
    static Foundation f;
    Text reason;
    if (!curve_begin(&curve, n, 0, 0.0, &reason))
        return -1;
    for (int k = 0; k + 1 < n; k++) {
        const double *a = nodes[k], *b = nodes[k + 1];
        curve_begin_piece(&curve, (Node){a[0], a[1], a[2], a[4]});
        if (!curve_add_node(&curve, (Node){b[0], b[1], b[2], b[3]}))
            return -1;
    }
    curve_finish(&curve);
    f = (Foundation){.curve = &curve, .mu = law[0], .ratio = law[1], .offset = law[2]};
    foundation_set_heights(&f, law[3]);
    heights_after_liftoff(&f, law[4]);
    memcpy(heights, f.height, sizeof f.height);
    for (int m = 0, near = 0; m < moves; m++) {
        const double at = isnan(approach[m]) ? f.height[m % N_HEIGHTS] : approach[m];
        const PatchState state = patch_state(&f, at, near);
        near = state.full_ranges;
        for (int k = 0; k < FOUNDATION_SLIDER_COUNT; k++) {
            const SliderProperties pair = slider_properties(&f, k / 2, &state);
            const double all[] = {pair.K, pair.limit[k % 2], pair.slope};
            memcpy(found[m][k], all, sizeof all);
        }
    }
    return N_HEIGHTS;
}
"""


@dataclass(frozen=True)
class RandomFoundation:
    """Foundation of a scaled curve in Python; its heights and its properties on a path in C.

    approach : (q) [m] at which the properties are compared: up and down at random, and at each height
    found    : (q, n, 3) stiffness, friction limit and stiffness slope in C
    """

    foundation: Foundation
    approach: np.ndarray
    expected_heights: np.ndarray
    found: np.ndarray


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> CDLL:
    """Library of the bolted joint's C with a function that calls the static functions of foundation.c."""
    files = {**generate_sources("BoltedJoint", load_default("bolted_joint")), "caller.c": CALLER}
    units = [
        name for name in compiler.select_source_files(files, "3") if name not in ("foundation.c", "windows.c")
    ]
    platform = fmpy.platform_tuple
    made = compiler.compile_libraries("foundation", files, units, [platform])
    path = tmp_path_factory.mktemp("foundation") / compiler.make_library_file_name("foundation", platform)
    path.write_bytes(made[platform])
    return CDLL(str(path))


@pytest.fixture(scope="module")
def curve() -> Curve:
    return tabulate_approach(load_default("bolted_joint").values)


def scaled(curve: Curve, length: float, pressure: float) -> Curve:
    """Curve in other units of length and pressure."""
    slope = pressure / length**2
    return Curve(
        length * curve.displacement,
        pressure * curve.load,
        pressure / length * curve.stiffness,
        slope * curve.stiffness_slope_start,
        slope * curve.stiffness_slope_end,
    )


def pointer(values: np.ndarray) -> object:
    return values.ctypes.data_as(POINTER(c_double))


def draw_foundation(library: CDLL, curve: Curve, rng: np.random.Generator) -> RandomFoundation:
    """Foundation with random parameters; onset and lift-off lie in the closing, in the table or above."""
    table = scaled(curve, *np.exp(rng.uniform(-2.0, 2.0, 2)))
    low, high = table.displacement[[0, -1]]
    onset, smallest, *path = low + (high - low) * (1.2 * rng.random(2 + APPROACHES) ** 3 - 0.1)
    mu, ratio, offset = rng.uniform(0.05, 1.0), rng.uniform(0.3, 1.0), rng.uniform(0.01, 0.99)
    law = np.array([mu, ratio, offset, onset, min(onset, smallest)])
    expected_heights = heights_after_liftoff(slider_heights(table, onset, offset), law[4])
    approach = np.array([*path, *np.full(2 * expected_heights.size, np.nan)])
    heights = np.empty(expected_heights.size)
    found = np.empty((approach.size, 2 * (heights.size - 1), 3))
    before, after = (
        np.append(table.stiffness_slope_start[:1], table.stiffness_slope_end),
        np.append(table.stiffness_slope_start, table.stiffness_slope_end[-1:]),
    )
    nodes = np.stack([table.displacement, table.load, table.stiffness, before, after], axis=-1)
    arguments = (c_int(len(nodes)), pointer(nodes), pointer(law), c_int(approach.size), pointer(approach))
    assert library.read_properties(*arguments, pointer(heights), pointer(found)) == heights.size
    at_height = heights[np.arange(approach.size) % heights.size]
    approach = np.where(np.isnan(approach), at_height, approach)
    return RandomFoundation(Foundation(table, ratio, mu, heights), approach, expected_heights, found)


def test_properties_are_those_of_python(library: CDLL, curve: Curve) -> None:
    """Stiffness, friction limit and slope without contact, in partial and in full contact, on loading and
    unloading. The search for the ranges in contact starts at those of the previous approach."""
    rng, contacts = np.random.default_rng(3), np.zeros(3, dtype=int)
    for _ in range(FOUNDATIONS):
        drawn = draw_foundation(library, curve, rng)
        foundation, table = drawn.foundation, drawn.foundation.pressure_curve
        span = table.displacement[-1] - table.displacement[0]
        np.testing.assert_allclose(
            foundation.heights, drawn.expected_heights, rtol=0.0, atol=1e-11 * span, strict=True
        )
        properties = foundation.slider_properties(drawn.approach)
        load, stiffness, slope = (x[:, None] for x in table.derivatives(drawn.approach, 2))
        mu, ratio = foundation.friction_coefficient, foundation.stiffness_ratio
        sizes = (
            ratio * stiffness,
            mu * (load + stiffness * (np.abs(drawn.approach[:, None]) + span)),
            SLOPE_ROUND_OFF / ROUND_OFF * ratio * np.max(np.abs(slope)),
        )
        expected = (properties.stiffness, properties.friction_limit, properties.stiffness_slope)
        for i, size in enumerate(sizes):
            error = np.abs(drawn.found[..., i] - expected[i])
            assert np.all(error <= ROUND_OFF * size), (i, np.max(error / size))
        low, high = np.repeat(foundation.heights[:-1], 2), np.repeat(foundation.heights[1:], 2)
        delta = drawn.approach[:, None]
        contacts += [np.sum(delta < low), np.sum((delta > low) & (delta < high)), np.sum(delta >= high)]
        assert np.any(np.diff(drawn.approach) > 0.0)
        assert np.any(np.diff(drawn.approach) < 0.0)
    assert np.all(contacts > FOUNDATIONS)


def test_the_friction_limit_grows_with_the_pressure_in_full_contact(library: CDLL, curve: Curve) -> None:
    """Both limits of a range add up to mu times its normal force, below and beyond its upper height."""
    rng = np.random.default_rng(4)
    for _ in range(FOUNDATIONS):
        drawn = draw_foundation(library, curve, rng)
        table, heights = drawn.foundation.pressure_curve, drawn.foundation.heights
        closed = drawn.approach >= heights[-1]
        total = np.sum(drawn.found[..., 1], axis=-1)[closed]
        load, stiffness = table.derivatives(drawn.approach[closed], 1)
        first_load, first_stiffness = table.derivatives(heights[0], 1)
        normal = load - first_load - first_stiffness * (drawn.approach[closed] - heights[0])
        size = load + stiffness * (np.abs(drawn.approach[closed]) + heights[-1] - heights[0])
        error = np.abs(total - drawn.foundation.friction_coefficient * normal)
        assert np.all(error <= 100.0 * ROUND_OFF * size)
