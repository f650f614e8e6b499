"""Bolted joint in the main job (`build_fmus.py`): ramp check, published points, figures, laboratory page."""

import tomllib
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jointfmu_fmu_src.joint_parts import RampPanel
from scipy.integrate import cumulative_simpson

from jointfmu.joints.bolted_joint.law import get_bolted_frame
from jointfmu.joints.bolted_joint.variables import PERMISSIBLE_TEMPERATURES
from jointfmu.parameters import load_default

from ...pages.laboratory.joint_additions import ContactMap, LaboratoryModel, MeasuredCurve, PublishedQuantity
from ...pages.report.figure import Figure, Panel, Series
from ...run.ramps import ramp
from ...run.ramps.ramp import RampResult
from ...studies.checks import relative_deviation
from ...studies.published.reference import PublishedPoint
from ...systems.master import Slave
from ...systems.ringing import PlotAxis, SlipDeflection, VibrationTest, WorkingPoint
from .picture import draw_plan

_FMU_NAME = "BoltedJoint"
"""Name of the FMU of the bolted joint."""


def _check_separation(fmu_folder: Path, ramp_result: ramp.RampResult) -> tuple[str, float]:
    """Compare the normal force of the FMU under growing separation with the integral of its stiffness."""
    pulled = ramp.run_ramp(
        fmu_folder / f"{_FMU_NAME}.fmu", "s_rel_z", 5e-6, 1e-8, {"preload": 9e3}
    ).variable_columns
    force = -cumulative_simpson(pulled["K_zz"], x=pulled["s_rel_z"], initial=0.0)
    return "f_z pulled apart against the integral of K_zz ds (scipy, Simpson)", relative_deviation(
        pulled["f_z"], force
    )


RAMP_CHECKS = {_FMU_NAME: _check_separation}
"""{FMU: check}. A check is a function: (folder, ramp of the FMU) -> (name of the compared quantity, largest
relative deviation [1])."""


def compute_through_fmu(published_point: PublishedPoint, fmu_folder: Path) -> float | None:
    """Compute a published quantity by running an FMU of the folder; None if no FMU outputs the quantity."""
    if published_point.quantity != "p_max":
        return None
    load = published_point.where["preload"]
    return float(
        ramp.run_ramp(fmu_folder / f"{_FMU_NAME}.fmu", "preload", load, load).variable_columns["p_max"][-1]
    )


_PRESSURE_MAP_LOADS = ((9e3, 0.0), (15e3, 4500.0))
"""Preload [N] and moment [N.m] of the two pressure maps: without a moment, and with the moment of the
paper."""


def make_figures(pipeline_result: Any) -> list[Figure]:
    """Make the figures of the bolted joint, from the results of building all FMUs (`PipelineResult`)."""
    joint = load_default("bolted_joint").values
    return [
        Figure(
            "Stiffness and damping over preload",
            "Normal (zz) and tangential (xx) direction; the damping is the viscous equivalent.",
            make_stiffness_charts(pipeline_result.load_ramps[_FMU_NAME]),
            data_file=f"{_FMU_NAME}.csv",
        ),
        Figure(
            "Contact pressure",
            "Bolts are numbered. First picture: the preload of the published pressures. Second picture: with "
            "a moment that changes the bolt forces of the two rows by 5 kN.",
            svg_pictures=[draw_plan(joint, *case) for case in _PRESSURE_MAP_LOADS],
        ),
    ]


def make_stiffness_charts(ramp_result: RampResult) -> list[Panel]:
    """Charts of stiffness and damping over the preload."""
    c, over = ramp_result.variable_columns, "preload per bolt [kN]"
    load = c["preload"] / 1e3
    return [
        Panel("Stiffness", over, "K [N/um]", [Series(n, load, c[n] / 1e6) for n in ("K_zz", "K_xx")]),
        Panel("Damping", over, "C [kN s/m]", [Series(n, load, c[n] / 1e3) for n in ("C_zz", "C_xx")]),
    ]


VIBRATION_PRELOADS = (3e3, 9e3, 15e3, 30e3)
"""Preloads per bolt [N] of the simulated free vibrations."""


def _make_working_point(fmu_path: Path, preload: float, start_values: Mapping[str, Any]) -> WorkingPoint:
    """Working point of the joint tightened to a preload [N], about which the body vibrates in shear."""
    start = {**start_values, "preload": preload, "v_rel_x": 1.0}
    with Slave(fmu_path, start, (), ("K_xx", "f_x")) as law:
        K, dashpot = law.get_outputs()
    if K <= 0.0:
        raise ValueError(f"load = {preload:g} N: the joint has no stiffness there; allowed are preloads > 0")
    return WorkingPoint(0.0, 0.0, K, 0.0 - dashpot)


VIBRATION_TEST = VibrationTest(
    model_name=_FMU_NAME,
    motion_inputs=("s_rel_x", "v_rel_x"),
    force_output="f_x",
    body_model="TranslationalMass",
    load_variable="preload",
    find_example_loads=lambda path, parameters: VIBRATION_PRELOADS,
    find_start_values=lambda preload: {"preload": preload},
    find_working_point=_make_working_point,
    release_force=1.0,
    load_axis=PlotAxis("preload", "kN", 1e-3),
    deflection_axis=PlotAxis("motion", "um", 1e6),
    support_description="in shear",
    stiffness_output="K_xx",
    deflection_for_slip=SlipDeflection(15e3, 8e-7, "half of the friction limit"),
)
"""System of the main job in which a bolted joint vibrates."""


_MEASURED_PRESSURE_RANGE = (0.3e6, 8e6)
"""Range [Pa] of the measured curves: the mean pressures of the load ramp."""
_CURVE_POINT_COUNT = 41
"""Number of points of a measured curve [1]."""


def _marked_bolt_positions(joint_parameters: Any) -> tuple[Sequence[Sequence[float]], str]:
    """Positions (b, 2) [m] of b bolts to be marked in the pressure map, and the label of the marks."""
    try:
        return get_bolted_frame(joint_parameters).bolt_positions_from_middle.tolist(), "bolts"
    except ValueError:  # a field of nodal pressures, or a plate
        return [], ""


def _measured_stiffness_curves() -> list[MeasuredCurve]:
    """Normal stiffness per area [N/m3] for pressures p, from measured approaches C p^m (constants C, m)."""
    text = (files("jointfmu_models") / "reference" / "measured_joints.toml").read_text(encoding="utf-8")
    curves = []
    for row in tomllib.loads(text)["normal"]:
        unit = row["pressure_unit"]
        C, m = (float(np.mean(row[name])) for name in "Cm")
        p = np.geomspace(
            _MEASURED_PRESSURE_RANGE[0],
            min(_MEASURED_PRESSURE_RANGE[1], row["to"] * unit),
            _CURVE_POINT_COUNT,
        )
        k = p / (C * m * 1e-6 * (p / unit) ** m)
        label = row["finish"]
        curves.append(MeasuredCurve(label, row["source"], "p_mean", "K_zz", p.tolist(), k.tolist(), "A_0"))
    return curves


LABORATORY_MODELS = {
    _FMU_NAME: LaboratoryModel(
        additional_panels=(RampPanel("preload", ("p_max", "p_mean")), RampPanel("p_mean", ("K_zz",))),
        slider_spans={
            "moment": (-5e3, 5e3),
            "bolt_stiffness": (0.0, 2e9),
            "preload": (0.0, 30e3),
            "temperature": PERMISSIBLE_TEMPERATURES,
            "plate_stiffness": (0.0, 5e9),
            **dict.fromkeys(("bolt.alpha", "side1.alpha", "side2.alpha"), (0.0, 3e-5)),
            **dict.fromkeys(("side1.clamped_length", "side2.clamped_length"), (0.0, 0.1)),
        },
        pointer_inputs=("s_rel_x", "s_rel_y"),
        published_points={"p_max": PublishedQuantity("p_max", {"preload": "preload"})},
        measured_curves=_measured_stiffness_curves(),
        contact_map=ContactMap(
            "contact pressure", "Pa", "MPa", "of the nodes that the FMU carries", _marked_bolt_positions
        ),
    )
}
"""{FMU: contents of its laboratory page that are not variables of the FMU}."""
