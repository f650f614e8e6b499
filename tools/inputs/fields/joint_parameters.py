"""Put a computed pressure field into the parameter file of a bolted joint, and plot the field."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from jointfmu.mechanics.footprint.distribution import (
    BOLT_POSITION_MEAN_NAMES,
    MAX_PATCHES,
    PressureDistribution,
    encode_nodal_field,
    moment_pressure,
    position_means,
)
from jointfmu.mechanics.footprint.patch_reduction import reduce_patches
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, build_parameter_set
from jointfmu.quantity.refusal import InputRefusal

from ...common import plots
from .bolted_interface import BoltedInterface, check_pressure_field, nodal_pressures
from .nodal_result import ContactPressureField
from .reduction import MAX_KEPT_NODES, FieldReduction, reduce_field

FIELD_FORCE_TOLERANCE = 0.01
"""Largest relative difference between the force of a pressure field and the total preload [1]."""
MAX_SCALED_FORCE_RATIO = 2.0
"""Ratio [1] of field force and bolt force, or its inverse, up to which scaling the field is advised."""
FIELD_MOMENT_OVER_GIVEN_MOMENT_RANGE = (0.5, 1.5)
"""Allowed range of the moment of the pressure over the given moment [1]; bolt forces carry the rest."""
_REPLACED_PARAMETER_PREFIXES = ("pattern.", "plate.", "field.", "bodies.", "sides")
"""Prefixes of the parameter names that a pressure field replaces.

Elastic bodies are replaced too: they belong to another contact."""


def insert_pressure_field(
    parameter_file: ParameterFile,
    contact_field: ContactPressureField,
    preload: float,
    field_source: str,
    moment_field: ContactPressureField | None = None,
    bending_moment: float | None = None,
    bolt_positions: Array | None = None,
    force_tolerance: float = FIELD_FORCE_TOLERANCE,
) -> tuple[ParameterFile, FieldReduction]:
    """Replace the pressure distribution and the contact area of a bolted joint by a computed field.

    Returns the new parameter file and the reduction of the field.

    Parameters
    ----------
    parameter_file  : parameter file of a joint whose pressure may be a field; `n_bolts`, `row_bolts` and
                      `row_distance` relate the field to the bolt forces
    preload         : [N] per bolt, at which the field was computed
    field_source    : origin of the field, written to the file
    moment_field    : field at the same nodes with an additional bending moment. None: the change of pressure
                      by a moment is in proportion to the distance from the centre of pressure
    bending_moment  : [N.m] of `moment_field`, positive if it increases the pressure at y > 0
    bolt_positions  : (n, 2) [m] positions of the bolts, for their bending stiffness; None: no bending
                      stiffness
    force_tolerance : [1] largest relative difference of the field's force from the bolt force, to which the
                      field is scaled

    Raises ValueError if the pressure of the joint cannot be a field, if the force of a field differs from the
    bolt force by more than the tolerance, if the two fields have different nodes, or if the moment of the
    pressure is far from the given moment.
    """
    check_pressure_field(parameter_file.joint)
    shape = normalise_pressure_field(
        parameter_file.values, contact_field, preload, moment_field, bending_moment, force_tolerance
    )
    reduction = reduce_field(
        replace(parameter_file.values, A_0=float(np.sum(contact_field.nodal_area))),
        shape,
        preload,
        nodal_pressures,
    )
    initial = reduction.reduced_distribution if shape.area_share.size > MAX_KEPT_NODES else None
    patches = reduce_patches(shape, MAX_PATCHES, initial)
    lists = encode_nodal_field(reduction.reduced_distribution) | encode_nodal_field(patches)
    new_values: dict[str, object] = {f"field.{name}": values for name, values in lists.items()}
    new_values["A_0"] = float(np.sum(contact_field.nodal_area))
    if bolt_positions is not None:
        positions = bolt_positions - contact_field.contact_centroid
        bolt_means = position_means(positions)
        new_values |= {
            f"field.{name}": value for name, value in zip(BOLT_POSITION_MEAN_NAMES, bolt_means, strict=True)
        }
        new_values |= {f"field.each_bolt_{a}": tuple(positions[:, i].tolist()) for i, a in enumerate("xy")}
    old_values = {
        n: v
        for n, v in parameter_file.values_by_name.items()
        if not n.startswith(_REPLACED_PARAMETER_PREFIXES)
    }
    text = (
        f"{field_source}, {preload:g} N per bolt; {reduction.point_count} points for {reduction.node_count} "
        "nodes"
    )
    return replace(
        parameter_file,
        values=build_parameter_set(type(parameter_file.values), old_values | new_values),
        origins={
            n: k for n, k in parameter_file.origins.items() if not n.startswith(_REPLACED_PARAMETER_PREFIXES)
        }
        | dict.fromkeys(new_values, "derived"),
        sources={
            n: s for n, s in parameter_file.sources.items() if not n.startswith(_REPLACED_PARAMETER_PREFIXES)
        }
        | dict.fromkeys(new_values, text)
        | {
            "A_0": f"{field_source}, sum of the nodal areas",
            "field.tilt": f"{text}; {_describe_moment_rule(moment_field, bending_moment)}",
        },
    ), reduction


def _describe_moment_rule(moment_field: ContactPressureField | None, bending_moment: float | None) -> str:
    """Text that says where the change of the pressure with the bending moment comes from.

    The text is part of the source of the entry `field.tilt`.
    """
    if moment_field is None:
        return "in proportion to the distance from the centre of pressure"
    return f"from the field at {bending_moment:g} N.m"


def normalise_pressure_field(
    bolted_joint: BoltedInterface,
    contact_field: ContactPressureField,
    preload: float,
    moment_field: ContactPressureField | None = None,
    bending_moment: float | None = None,
    force_tolerance: float = FIELD_FORCE_TOLERANCE,
) -> PressureDistribution:
    """Normalise a pressure field by the mean pressure of a joint. Parameters as for `insert_pressure_field`.

    With e = `preload_pressure_ratio` and t = `moment_pressure_ratio`, the pressure at a node is p_m e +
    M/(L_a A_0) t: p_m bolt force over contact area A_0, M bending moment, L_a distance of the bolt rows.
    Equilibrium requires sum(a t y) = L_a, with coordinate y of a node and its share a of the contact area.
    Without a second field, t = L_a e (y - y_p)/sum(a e (y - y_p)^2); y_p is the centre of pressure.
    """
    scale = _bolt_force_ratio(bolted_joint, contact_field, preload, "the field", force_tolerance)
    area = float(np.sum(contact_field.nodal_area))
    share, position = (
        contact_field.nodal_area / area,
        contact_field.node_positions - contact_field.contact_centroid,
    )
    mean = preload * bolted_joint.n_bolts / area
    equal = scale * contact_field.nodal_pressure / mean
    if moment_field is None:
        tilt = bolted_joint.row_distance * moment_pressure(share, position[:, 1], equal)
        return PressureDistribution(share, position, equal, tilt)
    if bending_moment is None:
        raise ValueError("the moment [N.m] of the second field is missing; state it")
    if not np.isfinite(bending_moment) or bending_moment == 0.0:
        raise ValueError(
            f"moment = {bending_moment:g} N.m of the second field is outside (-inf, 0) and (0, inf)"
        )
    scale = _bolt_force_ratio(bolted_joint, moment_field, preload, "the field with a moment", force_tolerance)
    _check_same_nodes(contact_field, moment_field)
    added = scale * moment_field.nodal_pressure - mean * equal
    field_over_given_moment = area * float(share @ (added * position[:, 1])) / bending_moment
    if (
        not FIELD_MOMENT_OVER_GIVEN_MOMENT_RANGE[0]
        <= field_over_given_moment
        <= FIELD_MOMENT_OVER_GIVEN_MOMENT_RANGE[1]
    ):
        low, high = FIELD_MOMENT_OVER_GIVEN_MOMENT_RANGE
        raise ValueError(
            f"the pressures of the second field balance {field_over_given_moment:.3g} times its moment of "
            f"{bending_moment:g} N.m, allowed is {low:g} to {high:g}; check value and sign: a positive "
            "moment raises the pressure at y > 0"
        )
    return PressureDistribution(
        share, position, equal, added * bolted_joint.row_distance * area / bending_moment
    )


def _bolt_force_ratio(
    bolted_joint: BoltedInterface,
    contact_field: ContactPressureField,
    preload: float,
    field_description: str,
    force_tolerance: float,
) -> float:
    """Ratio [1] of total bolt force to the force of a pressure field; InputRefusal if it is not near 1."""
    if not 0.0 < force_tolerance < 1.0:
        raise InputRefusal(
            f"force_tolerance = {force_tolerance:g} is outside (0, 1): relative difference of the forces",
            "force_tolerance",
        )
    if not 0.0 < preload < np.inf:
        raise ValueError(f"preload = {preload:g} N is outside (0, inf): preload of each bolt")
    expected = preload * bolted_joint.n_bolts
    ratio = contact_field.normal_force / expected
    if not abs(ratio - 1.0) <= force_tolerance:
        text = (
            f"the force of {field_description} is {contact_field.normal_force:.6g} N, expected "
            f"{expected:.6g} N within {100.0 * force_tolerance:.3g} %: {bolted_joint.n_bolts:g} bolts of "
            f"{preload:g} N"
        )
        if not 1.0 / MAX_SCALED_FORCE_RATIO < ratio < MAX_SCALED_FORCE_RATIO:
            advice = f"{_describe_force_ratio(ratio)}, the force of each bolt and the number of bolts"
            raise InputRefusal(f"{text}; {advice}", "preload")
        raise InputRefusal(
            f"{text}; with a larger tolerance the field is scaled to the bolt force", "force_tolerance"
        )
    return expected / contact_field.normal_force


def _describe_force_ratio(field_over_bolt_force: float) -> str:
    """Advice to check units, with the factor [1] of field force over bolt force if it is a power of 1000."""
    if not 0.0 < field_over_bolt_force < np.inf:
        return "check the columns of pressure and area"
    power = 3 * round(np.log10(field_over_bolt_force) / 3.0)
    if not power or not 0.5 < field_over_bolt_force / 10.0**power < 2.0:
        return "check the units of pressure and area"
    word = "small" if power < 0 else "large"
    return f"the field is a factor of about 1e{abs(power)} too {word}: check the units of pressure and area"


def _check_same_nodes(contact_field: ContactPressureField, moment_field: ContactPressureField) -> None:
    """Raise ValueError, which names the first difference, if two pressure fields have different nodes."""
    if contact_field.nodal_area.size != moment_field.nodal_area.size:
        raise ValueError(
            f"the field with a moment has {moment_field.nodal_area.size} nodes, expected those of the "
            f"first: {contact_field.nodal_area.size}"
        )
    size = float(np.ptp(contact_field.node_positions, axis=0).max())
    differs = np.max(np.abs(moment_field.node_positions - contact_field.node_positions), axis=1) > 1e-6 * size
    differs |= np.abs(moment_field.nodal_area - contact_field.nodal_area) > 1e-6 * np.max(
        contact_field.nodal_area
    )
    if np.any(differs):
        i = int(np.argmax(differs))
        raise ValueError(
            f"node {i + 1} of the field with a moment is at {moment_field.node_positions[i].tolist()} m "
            f"with {moment_field.nodal_area[i]:g} m2, expected {contact_field.node_positions[i].tolist()} m "
            f"with {contact_field.nodal_area[i]:g} m2"
        )


def draw_pressure_field(
    contact_field: ContactPressureField, field_reduction: FieldReduction, picture_path: str | Path
) -> None:
    """Plot the pressure at all nodes, and at the few points that replace them, as .png or .svg."""
    position = 1e3 * (contact_field.node_positions - contact_field.contact_centroid)
    width, height = np.ptp(position, axis=0)
    with plots.open_figure(picture_path, (10.4, float(np.clip(4.6 * height / width, 3.0, 7.0)))) as figure:
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        size = (
            20.0
            * contact_field.nodal_area
            / np.max(contact_field.nodal_area)
            * min(1.0, 3000.0 / contact_field.nodal_area.size)
        )
        nodes = left.scatter(
            *position.T, c=1e-6 * contact_field.nodal_pressure, s=size, cmap="viridis", lw=0.0
        )
        figure.colorbar(nodes, ax=left, label="pressure [MPa]", shrink=0.85)
        left.set_title(
            f"{contact_field.nodal_area.size} nodes, {contact_field.normal_force / 1e3:.4g} kN",
            loc="left",
            fontsize=10,
        )
        shape = field_reduction.reduced_distribution
        mean = contact_field.normal_force / float(np.sum(contact_field.nodal_area))
        points = right.scatter(
            *(1e3 * shape.position.T),
            c=1e-6 * mean * shape.preload_pressure_ratio,
            s=np.clip(2000.0 * shape.area_share, 4.0, 400.0),
            cmap="viridis",
            alpha=0.75,
        )
        figure.colorbar(points, ax=right, label="pressure [MPa]", shrink=0.85)
        right.set_title(
            f"{field_reduction.point_count} points, by their share of the area", loc="left", fontsize=10
        )
        left.set_ylabel("y, across the bolt rows [mm]")
        for axes in (left, right):
            axes.set_xlabel("x, along the bolt rows [mm]")
            axes.set_aspect("equal")
