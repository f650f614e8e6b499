"""Figures in the report of a bolted joint: pictures, stiffness shares, bolt forces, effect of friction."""

from collections.abc import Callable, Sequence

import numpy as np
from jointfmu_fmu_src.joint_parts.chart import Panel, Series

from jointfmu.joints.bolted_joint.bodies import MODAL_DISPLACEMENT_DECIMALS
from jointfmu.joints.bolted_joint.compliances import Compliances
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import (
    ElasticBodies,
    preload_at_temperature,
    slip_force,
    working_preload,
)
from jointfmu.joints.bolted_joint.outputs import bolt_force_name
from jointfmu.joints.model import Model
from jointfmu.mechanics.footprint.distribution import NodalField
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array
from jointfmu.quantity.units import conversion_factor

from ...common.shown import choose_display_unit, format_quantity, format_unit
from ...pages.report.figure import ComparisonRow, Figure
from ...pages.report.load_history import LoadHistory
from .external_load import (
    MAX_BOLT_OVER_TIGHTENING_FORCE,
    OPEN_PRESSURE_RATIO,
    compute_bolt_forces,
    compute_opening_moment,
)
from .field import NOMINAL_PRESSURE, PlaneLayout
from .gross_slip import PRELOAD_ENTRY_NAME, compute_friction_results, compute_preload_results
from .picture import draw_plan, draw_section

MAX_PLOTTED_OVER_OPENING_LOAD = 1.3
"""Largest plotted tensile force over the opening load of the interface [1]."""
MAX_BOLT_SHARE_EXCESS_OVER_MEAN = 0.05
"""Excess of the largest bolt share over the mean share [1], up to which bolts count as equally loaded."""
EQUAL_BOLT_FORCE_TOLERANCE = 10.0 * 10.0**-MODAL_DISPLACEMENT_DECIMALS
"""Difference of two bolt forces over the largest change of a bolt force since tightening [1], up to which
they share a curve: a few times the rounding of the modal displacements."""


def make_bolted_joint_figures(load_history: LoadHistory) -> list[Figure]:
    """Make all figures of a bolted joint's report: pictures, complete joint, preload, friction."""
    return [
        make_plan_and_section_figure(load_history),
        *make_stiffness_figures(load_history),
        *make_preload_figures(load_history),
        *make_friction_figures(load_history),
    ]


def make_plan_and_section_figure(load_history: LoadHistory) -> Figure:
    """Plan view of the joint, and a section if the file has the thickness of the sides."""
    joint = load_history.file.values
    preload, moment = _working_point(load_history)
    bodies, bolts = joint.bodies, PlaneLayout.from_joint_parameters(joint).bolt_positions
    pictures = [draw_plan(joint, preload, moment)]
    if joint.has_elastic_members and isinstance(bodies, ElasticBodies) and bodies.thickness:
        pictures.append(draw_section(joint))
    text = "The tightened interface, seen from side 2; open areas are grey. "
    if isinstance(joint.pattern, NodalField):
        text += "Dots show the pressure at some nodes of the field, which represent all nodes. "
    if not PlaneLayout.from_joint_parameters(joint).contact_outline:
        text += "The outline is not in the file. "
    text += (
        "The file has no bolt positions. "
        if not len(bolts)
        else "The numbers of the bolts are those of the FMU's F_bolt. "
        if joint.has_elastic_members
        else ""
    )
    text += (
        "Hatched surfaces move rigidly with the connected bodies; the section is schematic."
        if joint.has_elastic_members
        else "The sides are rigid: the FMU contains the interface"
        + (" and its bolts." if joint.bolt_stiffness else " only.")
        + " The members, usually much softer, are not included; jointfmu new makes the complete joint from a "
        "drawing."
    )
    return Figure("The joint", text, svg_pictures=pictures)


def make_friction_figures(load_history: LoadHistory) -> list[Figure]:
    """Table of gross-slip force and loss factor over the range of mu; empty if the file states no range."""
    if "mu" not in load_history.file.ranges:
        return []
    shear, rows = compute_friction_results(load_history.file, _working_point(load_history)[0])
    table = [("mu", "gross slip at", f"loss factor at {_format_in_display_unit(shear, 'N')} of shear")]
    for row in sorted(rows):
        table.append(
            (
                f"{row.friction_coefficient:.4g}",
                _format_in_display_unit(row.slip_force, "N"),
                f"{row.loss_factor:.3g}",
            )
        )
    text = (
        f"The friction coefficient is the least certain input: {load_history.file.sources['mu']}. "
        "The loss factor "
        "is that of the interface between rigid sides, under the same shear force."
    )
    return [Figure("Effect of the friction coefficient", text, table_rows=table)]


def make_preload_figures(load_history: LoadHistory) -> list[Figure]:
    """Table of stiffness, gross-slip force and opening load over the range of the preload.

    Empty if the file states no range of the preload.
    """
    file = load_history.file
    if PRELOAD_ENTRY_NAME not in file.ranges:
        return []
    table: list[tuple[str, ...]] = [
        ("preload", "stiffness along z", "stiffness along x", "gross slip at", "interface opens at")
    ]
    capacity = NOMINAL_PRESSURE.load_capacity(file)
    for row in sorted(compute_preload_results(file)):
        values = zip(row, ("N", "N/m", "N/m", "N", "N"), strict=True)
        preload, *cells = (_format_in_display_unit(value, unit) for value, unit in values)
        excess = " (above the proof load)" if capacity and row.preload > capacity[0] else ""
        table.append((f"{preload}{excess}", *cells))
    text = (
        f"The preload is uncertain: {file.sources[PRELOAD_ENTRY_NAME]}. Embedding takes "
        f"{_format_in_display_unit(file.values.embedding, 'N')} of each preload. The stiffness is that of "
        "the FMU; the force along z that opens the interface is a linear estimate."
    )
    return [Figure("Effect of the preload", text, table_rows=table)]


def _working_point(load_history: LoadHistory) -> tuple[float, float]:
    """Preload [N] at the start temperature and moment [N.m] of the tightened joint."""
    preload, moment = (float(load_history.loop_inputs.get(name, 0.0)) for name in ("preload", "moment"))
    temperature = load_history.start_values["temperature"]
    return float(preload_at_temperature(load_history.file.values, preload, temperature)), moment


def make_stiffness_figures(load_history: LoadHistory) -> list[Figure]:
    """Figures of the stiffness of joint, interface and bolts, and of bolt forces over a force along z.

    Empty for rigid sides.
    """
    joint, spring = load_history.file.values, load_history.tabulated_joint
    if not joint.has_elastic_members:
        return []
    assert isinstance(spring, BoltedJointSpring)
    preload, moment = _working_point(load_history)
    compliances = spring.compliances(preload, moment)
    remaining_preload = float(working_preload(joint, preload))
    opening = compliances.opening_load(remaining_preload)
    limit = float(slip_force(joint, remaining_preload))
    panel = _bolt_force_chart(spring, preload, moment, MAX_PLOTTED_OVER_OPENING_LOAD * opening)
    share = compliances.bolt_force[:, 2]
    most_loaded = int(np.argmax(share))
    is_uneven = share[most_loaded] > (1.0 + MAX_BOLT_SHARE_EXCESS_OVER_MEAN) * np.mean(share)
    location = (
        f"around bolt {most_loaded + 1}, which carries {share[most_loaded]:.3g} of the force"
        if is_uneven
        else "around the bolts"
    )
    text = _stiffness_text(compliances, remaining_preload, moment) + (
        f"\n\nA force of {_format_in_display_unit(opening, 'N')} along z opens the interface {location} "
        "(linear estimate with these stiffnesses); a joint that peels opens at a lower load, as the plot "
        "shows. "
        f"{_opening_moment_text(spring, preload, moment)}The "
        f"whole interface slips at {_format_in_display_unit(limit, 'N')} along x or y; slip begins at the "
        "edges at a far lower load, and its loss is under Loops.\n\nThe plot shows a tensile force up to "
        f"{MAX_PLOTTED_OVER_OPENING_LOAD:g} times the opening load, free in the other five motions, and up "
        f"to {MAX_BOLT_OVER_TIGHTENING_FORCE:g} times the force of a bolt at tightening."
    )
    return [Figure("The complete joint", text, [panel], table_rows=_stiffness_rows(compliances))]


def _opening_moment_text(joint_spring: BoltedJointSpring, preload: float, bending_moment: float) -> str:
    """Sentence with the moments about x and y at which the joint starts to open; empty if none is found."""
    moments = [
        f"{_format_in_display_unit(found, 'N.m')} about {axis}"
        for i, axis in enumerate("xy")
        if (found := compute_opening_moment(joint_spring, preload, bending_moment, i)) is not None
    ]
    if not moments:
        return ""
    return (
        f"A moment of {' or '.join(moments)} opens the first point of the contact: its pressure falls to "
        f"{OPEN_PRESSURE_RATIO:.0%} of that at tightening. "
    )


def _format_in_display_unit(value_in_si: float, si_unit: str) -> str:
    """Format a value in SI units with three digits in the unit in which it is displayed."""
    return " ".join(format_quantity(value_in_si, si_unit, 4))


def _stiffness_rows(joint_compliances: Compliances) -> list[tuple[str, ...]]:
    """Table rows, one per direction: stiffnesses, and shares of the compliance."""
    heads = ("complete joint", "interface alone", "members", "bolts alone", "interface", "members", "bolts")
    rows: list[tuple[str, ...]] = [("", *heads)]
    for name, unit, stiffnesses, shares in joint_compliances.compliance_table_rows():
        shown = choose_display_unit(unit, max(stiffnesses))
        scale, ending = conversion_factor(unit, shown), format_unit(shown)
        cells = [f"{scale * value:.4g} {ending}" if value > 0.0 else "none" for value in stiffnesses]
        rows.append((name, *cells, *(f"{share:.1%}" for share in shares)))
    return rows


def _stiffness_text(joint_compliances: Compliances, remaining_preload: float, bending_moment: float) -> str:
    """Text under the table of stiffnesses: preload, moment, meaning of the shares."""
    share = joint_compliances.compliance_shares[0]
    largest = float(np.max(share))
    effect = (
        "it matters for the stiffness"
        if joint_compliances.is_interface_relevant
        else "it hardly affects the stiffness"
    )
    return (
        "Small motions of the attachments about the tightened state, "
        f"{_format_in_display_unit(remaining_preload, 'N')} in each bolt"
        + (f" with a moment of {bending_moment:g} N m" if bending_moment else "")
        + ", one at a time with the other five fixed. The stiffness of the complete "
        "joint is that of the FMU. The last three columns are shares of its compliance, by stored energy. "
        "Members is the stiffness of the complete joint divided by the share of the members; interface "
        "alone and bolts alone are between rigid sides. So the columns do not add up to the complete joint: "
        "deforming members load the interface unevenly."
        f"\n\nThe interface has {share[2]:.1%} of the compliance along z and at most {largest:.1%} in any "
        f"direction: {effect}. The bolts carry "
        f"{joint_compliances.joint_load_factor:.3f} of a force along z (load factor n Phi_K of VDI 2230), "
        "with the other motions free; where the interface is open they carry the full force, as the plot "
        "shows."
    )


def _group_equal_bolts(bolt_forces: Array) -> list[list[int]]:
    """Group the bolts with equal forces (bolts, loads) [N], the first load at tightening: lists of indices.

    The groups are in the order of their first bolts.
    """
    groups: list[list[int]] = []
    scale = float(np.max(np.abs(bolt_forces - bolt_forces[:, :1]), initial=0.0))
    for j, row in enumerate(bolt_forces):
        for group in groups:
            if np.allclose(row, bolt_forces[group[0]], rtol=0.0, atol=EQUAL_BOLT_FORCE_TOLERANCE * scale):
                group.append(j)
                break
        else:
            groups.append([j])
    return groups


def _name_bolts(bolt_indices: Sequence[int]) -> str:
    """Text with the numbers of bolts that have equal forces and share one curve of a chart."""
    names = ", ".join(bolt_force_name(j) for j in bolt_indices)
    return f"{names} (equal)" if len(bolt_indices) > 1 else names


def _bolt_force_chart(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float, max_tensile_force: float
) -> Panel:
    """Chart of the force of each bolt over a tensile force along z, up to `max_tensile_force` [N]."""
    pulls = np.linspace(0.0, max_tensile_force, 27)
    columns = 1e-3 * compute_bolt_forces(joint_spring, preload, bending_moment, pulls).T
    series = [
        Series(_name_bolts(bolts), 1e-3 * pulls[: len(columns[bolts[0]])], columns[bolts[0]])
        for bolts in _group_equal_bolts(columns)
    ]
    return Panel(
        "Bolt forces under a tensile force along z", "tensile force along z [kN]", "bolt force [kN]", series
    )


REPORT_FIGURES = {"BoltedJoint": make_bolted_joint_figures}
"""{FMU: function that makes the figures of its report}."""
CATALOGUE_COMPARISONS: dict[str, Callable[[Model, ParameterFile], list[ComparisonRow]]] = {}
"""Comparisons with catalogue values: none, because there are no catalogues of bolted joints."""
