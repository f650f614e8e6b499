"""Builder data of the bolted joint: points, patches and modes as data of the FMU; charts of the friction.

The C code reads the points of the contact as data, for any model of the pressure.
"""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.joints.bolted_joint.bodies import MODAL_DISPLACEMENT_DECIMALS, MemberModes
from jointfmu.joints.bolted_joint.bolts import bolt_force_per_moment, bolt_positions
from jointfmu.joints.bolted_joint.contact import (
    FORCE_TRANSFER_DECIMALS,
    MAX_PATCHES_PER_POINT,
    force_transfer,
)
from jointfmu.joints.bolted_joint.joint import MAX_CONTACT_POINTS, contact_points, find_friction_patches
from jointfmu.joints.bolted_joint.law import MAX_MODES, AnyBoltedJoint, ElasticBodies
from jointfmu.joints.bolted_joint.outputs import sum_cycle_energies
from jointfmu.mechanics.footprint.distribution import (
    BOLT_POSITION_MEAN_NAMES,
    MAX_PATCHES,
    PressureDistribution,
)
from jointfmu.mechanics.sliders import FOUNDATION_SLIDER_COUNT, height_offsets, torsion_directions
from jointfmu.quantity import Array

from ...joint_parts import FmuBuildData, RampPanel, chart, make_native_definition_loader
from ...joint_parts.data import DataConversion, DataTable
from ...joint_parts.interface_table import replace_table_points
from ...joint_parts.terminals import make_rotation_flange, make_translation_flange

_SECTIONS_READ_FROM_DATA = ("pattern.", "plate.", "field.", "bodies.")
"""Sections of a parameter file whose values the C code reads from data.c at run time."""
MAX_RIGID_SIDE_BOLTS = 64
"""Largest number of bolts [1] of a joint with rigid sides in compiled models; more need a compiler."""
_SINGLE_POINT_NODAL_FIELD = {"share": (1.0,), "x": (0.0,), "y": (0.0,), "equal": (1.0,), "tilt": (0.0,)}
"""Nodal field with a single point, with which the C code is generated."""


def _convert_parameters(joint_parameters: AnyBoltedJoint) -> Mapping[str, object]:
    """Parameters {name: value} for generating the C code, which reads contact points and modes at run time.

    Placeholders are a pressure field with one contact point and, for elastic members, one mode.
    """
    own = {
        name: value
        for name, value in replace_table_points(joint_parameters).items()
        if not name.startswith(_SECTIONS_READ_FROM_DATA)
    }
    spread = dict(zip(BOLT_POSITION_MEAN_NAMES, joint_parameters.pattern.bolt_position_means, strict=True))
    points: dict[str, object] = {
        f"field.{name}": value for name, value in (_SINGLE_POINT_NODAL_FIELD | spread).items()
    }
    return (
        own
        | points
        | (
            _make_single_mode_bodies(round(joint_parameters.n_bolts))
            if joint_parameters.has_elastic_members
            else {}
        )
    )


def _make_single_mode_bodies(bolt_count: int) -> dict[str, object]:
    """Elastic members (section [bodies]) with one mode without displacements, for generating the C code."""
    stated = [item.name for item in fields(ElasticBodies) if item.default is MISSING]
    values: dict[str, tuple[float, ...]] = dict.fromkeys(stated, (0.0,))
    values |= {"stiffness": (1.0,), **dict.fromkeys(("stretch", "bolt_x", "bolt_y"), (0.0,) * bolt_count)}
    return {f"bodies.{name}": value for name, value in values.items()}


def _make_data_tables(joint_parameters: AnyBoltedJoint) -> Mapping[str, DataTable]:
    """Make the tables {name: table} of numbers that the C code of a bolted joint reads as data.

    The tables have the contact points, friction patches, sliders, bolts and modes of the members.
    """
    patches = find_friction_patches(joint_parameters.pattern)
    return {
        "points": DataTable(
            _make_pressure_distribution_rows(contact_points(joint_parameters.pattern)), MAX_CONTACT_POINTS
        ),
        "patches": DataTable(
            np.column_stack([_make_pressure_distribution_rows(patches), patches.slider_circle_radius]),
            MAX_PATCHES,
        ),
        "torsion_directions": DataTable(torsion_directions(FOUNDATION_SLIDER_COUNT), 2),
        "height_offsets": DataTable(height_offsets(patches.preload_pressure_ratio)[:, None], MAX_PATCHES),
        **_make_body_tables(joint_parameters),
    }


def _make_body_tables(joint_parameters: AnyBoltedJoint) -> Mapping[str, DataTable]:
    """Make the data tables of elastic members: modes with their displacements, bolts, pressure transfer.

    A row of displacements has one point, patch or bolt, and a column for each mode, as 2-byte integers. A
    joint with rigid sides reserves one row for each table, and MAX_RIGID_SIDE_BOLTS rows for the bolts.
    """
    modes, most = MemberModes.from_rigid_members(0, 0, 0), (1, 1, 1, 1)
    bolts = bolt_positions(joint_parameters)
    pressing, pairs = np.zeros((0, 4)), 1
    if joint_parameters.has_elastic_members:
        assert isinstance(joint_parameters.bodies, ElasticBodies)
        points, patches = (
            contact_points(joint_parameters.pattern),
            find_friction_patches(joint_parameters.pattern),
        )
        modes = MemberModes.from_elastic_bodies(
            joint_parameters.bodies, len(points.area_share), patches.position
        )
        pressing = _make_pressure_transfer_rows(force_transfer(points, patches))
        pairs = MAX_PATCHES_PER_POINT * MAX_CONTACT_POINTS + MAX_PATCHES
        most = MAX_MODES, MAX_CONTACT_POINTS, MAX_PATCHES, len(bolts)
    axes = (f"patch_displacement_{axis}" for axis in ("x", "y", "around"))
    patch = dict(zip(axes, modes.patch_displacement, strict=True))
    moved = {"opening": modes.point_opening, **patch, "bolt_elongation": modes.bolt_elongation}
    room = dict(zip(moved, (most[1], *(most[2],) * 3, most[3]), strict=True))
    return {
        "modal_stiffness": DataTable(modes.modal_stiffness[:, None], most[0]),
        "bolts": DataTable(
            np.column_stack([bolts, bolt_force_per_moment(bolts)]),
            len(bolts) if joint_parameters.has_elastic_members else max(len(bolts), MAX_RIGID_SIDE_BOLTS),
        ),
        **{
            name: DataTable(_encode_modal_displacements(rows), room[name], is_integer=True)
            for name, rows in moved.items()
        },
        "pressure_transfer": DataTable(pressing, pairs, is_integer=True),
    }


def _make_pressure_transfer_rows(patch_force_shares: Any) -> Any:
    """Rows (n, 4) that transfer normal force from contact points to friction patches.

    A row has the index of the patch, the index of the point, the share of the point's force that the patch
    takes (an integer, in units of the last stored decimal), and 0.
    """
    patch, point = np.nonzero(patch_force_shares)
    digits = np.round(patch_force_shares[patch, point] * 10.0**FORCE_TRANSFER_DECIMALS)
    return np.column_stack([patch, point, digits, 0 * patch])


def _encode_modal_displacements(modal_displacements: Any) -> Any:
    """Encode modal displacements as integers in units of their last decimal, with zeros up to MAX_MODES."""
    return np.pad(
        np.round(modal_displacements * 10.0**MODAL_DISPLACEMENT_DECIMALS),
        ((0, 0), (0, MAX_MODES - modal_displacements.shape[1])),
    )


def _make_pressure_distribution_rows(pressure_distribution: PressureDistribution) -> Any:
    """Rows (n, 5) of contact points: share of the contact area, x, y [m], two pressures over mean pressure.

    The pressures are those under equal bolt forces, and those that a moment adds.
    """
    return np.column_stack(
        [
            pressure_distribution.area_share,
            pressure_distribution.position,
            pressure_distribution.preload_pressure_ratio,
            pressure_distribution.moment_pressure_ratio,
        ]
    )


LOOP_PRELOAD_OVER_RAMP_END_PRELOAD = 0.3
"""Preload of the drawn friction loops over the preload at the end of the load ramp [1]."""
LOOP_AMPLITUDES_OVER_SLIP_DISPLACEMENT = (0.06, 0.12, 0.22, 0.4)
"""Amplitudes of the drawn loops over the displacement at which a point with the mean approach slips [1]."""
_LOOP_BRANCH_POINT_COUNT = 13
"""Number of points of a branch of the drawn friction loops [1]."""


def _draw_friction_loops(tabulated_joint: Any, ramp_end_preload: float) -> list[chart.Panel]:
    """Draw hysteresis loops of friction with several amplitudes, and their loss factor over the amplitude.

    ramp_end_preload : preload at the end of the load ramp [N]
    """
    left = tabulated_joint.joint.embedding
    preload = left + LOOP_PRELOAD_OVER_RAMP_END_PRELOAD * (ramp_end_preload - left)
    approach = tabulated_joint.preloaded_approach(preload, 0.0)
    foundation, share = tabulated_joint.friction_law.foundation(), tabulated_joint.points.area_share
    mean = share @ np.maximum(approach - tabulated_joint.curve.displacement[0], 0.0)
    slips = foundation.friction_coefficient / foundation.stiffness_ratio * float(mean)

    def shear_force_at_first_loading(shear_displacement: Array) -> Array:
        """Shear force (...) [N] in first loading, at shear displacements (...) [m]."""
        return np.asarray(
            tabulated_joint.joint.A_0
            * (foundation.virgin_traction(approach, shear_displacement[:, None]) @ share)
        )

    lines = []
    for part in reversed(LOOP_AMPLITUDES_OVER_SLIP_DISPLACEMENT):
        u = part * slips * np.linspace(-1.0, 1.0, 2 * _LOOP_BRANCH_POINT_COUNT + 1)
        top = shear_force_at_first_loading(u[-1:])
        back = top - 2.0 * shear_force_at_first_loading(0.5 * (u[-1] - u))
        shift, loop = np.concatenate([u, u[::-1]]), np.concatenate([back, -back])
        lines.append(chart.Series(f"amplitude {u[-1] * 1e6:.3g} µm", shift * 1e6, loop / 1e3))
    u = LOOP_AMPLITUDES_OVER_SLIP_DISPLACEMENT[-1] * slips * np.linspace(0.0, 1.0, _LOOP_BRANCH_POINT_COUNT)
    lines.append(chart.Series("first shear", u * 1e6, shear_force_at_first_loading(u) / 1e3, is_dashed=True))
    size = slips * np.geomspace(0.01, 2.0, _LOOP_BRANCH_POINT_COUNT)
    sums = [sum_cycle_energies(foundation, share, approach, np.full(approach.size, a)) for a in size]
    loss = [s["loop_work"] / (2.0 * np.pi * s["loop_energy"]) for s in sums]
    over = chart.Series("eta_loop", size * 1e6, loss)
    return [
        chart.Panel(f"Loops at preload = {preload / 1e3:g} kN", "s_rel_x [um]", "-f_x [kN]", lines),
        chart.Panel(
            "Loss factor over the amplitude", "amplitude of s_rel_x [um]", "eta_loop [1]", [over], True
        ),
    ]


_TRANSLATION_FLANGES = zip("xyz", (75.0, 45.0, 15.0), strict=True)
"""Axes of the flanges for translations, with their heights in the icon."""
_ROTATION_FLANGES = zip("xyz", (-15.0, -45.0, -75.0), strict=True)
"""Axes of the flanges for rotations, with their heights in the icon."""

FMU_BUILD_DATA = FmuBuildData(
    joint_folder=Path(__file__).parent,
    load_native_definition=make_native_definition_loader(__name__),
    data_conversion=DataConversion(_convert_parameters, make_data_tables=_make_data_tables),
    chart_drawings={"BoltedJoint": {"loops": _draw_friction_loops}},
    load_ramp_panels={
        "BoltedJoint": (RampPanel("preload", ("K_zz", "K_xx")), RampPanel("preload", ("C_zz", "C_xx")))
    },
    terminals={
        "BoltedJoint": (
            *(make_translation_flange(*row) for row in _TRANSLATION_FLANGES),
            *(make_rotation_flange(*row) for row in _ROTATION_FLANGES),
        )
    },
)
"""Builder data of the bolted joint."""
