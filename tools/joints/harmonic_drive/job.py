"""Harmonic drive in the main job (`build_fmus.py`): ramp checks, published points, figures, laboratory."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.drive import FRICTION_HARMONICS, KINEMATIC_ERROR_HARMONICS

from ...pages.laboratory.joint_additions import (
    ExampleValues,
    LaboratoryModel,
    PublishedQuantity,
    TransmissionView,
)
from ...pages.report.figure import Figure, Panel, Series, published_series
from ...run.ramps import ramp
from ...run.ramps.ramp import RampResult
from ...studies.checks import relative_deviation
from ...studies.published.reference import PublishedPoint
from ...studies.published.validation import ValidatedPoint
from ...systems.master import Slave
from ...systems.ringing import PlotAxis, SlipDeflection, VibrationTest, WorkingPoint
from . import efficiency


def _check_compliance(fmu_folder: Path, ramp_result: ramp.RampResult) -> tuple[str, float]:
    """Compare the wind-up along the load ramp of HarmonicDriveCompliance with its integrated compliance."""
    c = ramp_result.variable_columns
    phi = cumulative_simpson(1.0 / c["K_WTS"], x=c["tau"], initial=0.0)
    return "phi_rel against the integral of dT/K_WTS (scipy, Simpson)", relative_deviation(c["phi_rel"], phi)


def _check_stiffness(fmu_folder: Path, ramp_result: ramp.RampResult) -> tuple[str, float]:
    """Compare the torque along the load ramp of HarmonicDriveSpring with the integral of its stiffness."""
    c = ramp_result.variable_columns
    tau = cumulative_simpson(c["K_WTS"], x=c["phi_rel"], initial=0.0)
    return "tau against the integral of K_WTS dphi (scipy, Simpson)", relative_deviation(c["tau"], tau)


RAMP_CHECKS = {"HarmonicDriveSpring": _check_stiffness, "HarmonicDriveCompliance": _check_compliance}
"""{FMU: check}. A check is a function: (folder, ramp of the FMU) -> (name of the compared quantity, largest
relative deviation [1])."""


def compute_through_fmu(published_point: PublishedPoint, fmu_folder: Path) -> float | None:
    """Compute a published quantity by running an FMU of the folder; None if no FMU outputs the quantity."""
    where = published_point.where

    def run_drive_fmu(output_name: str, **settings: float) -> float:
        """Run the FMU with changed parameters at the torque of the published point; returns one output."""
        torque = where["torque"]
        fmu = fmu_folder / "HarmonicDriveCompliance.fmu"
        return float(ramp.run_ramp(fmu, "tau", torque, torque, settings).variable_columns[output_name][-1])

    if published_point.quantity == "K_TS":
        changes = {"radial_deformation": where["deformation"]} if "deformation" in where else {}
        return run_drive_fmu("K_TS_pair", **changes)
    if published_point.quantity == "K_TS_least":
        ends = (where["lower"], where["upper"])
        return min(run_drive_fmu("K_TS_pair", radial_deformation=w) for w in ends)
    if published_point.quantity == "K_TS_change":
        changed = run_drive_fmu("K_TS_pair", eccentricity=where["eccentricity"])
        return 100.0 * (changed / run_drive_fmu("K_TS_pair") - 1.0)
    if published_point.quantity == "K_WTS":
        return run_drive_fmu("K_WTS")
    if published_point.quantity == "peak_pressure":
        return run_drive_fmu("p_max")
    return None


_COMPLIANCE_FMU = "HarmonicDriveCompliance"
"""Name of the FMU with torque as input."""


def make_figures(pipeline_result: Any) -> list[Figure]:
    """Make the figures of the harmonic drive, from the results of building all FMUs (`PipelineResult`)."""
    result = pipeline_result.load_ramps[_COMPLIANCE_FMU]
    return [
        Figure(
            "Stiffness over torque",
            "First chart: the outputs K_WTS and K_TS (contact pair) of the FMU. Second chart: the contact "
            "pair on the scale of the paper's figures.",
            make_stiffness_charts(result, pipeline_result.validated_points),
            data_file=f"{_COMPLIANCE_FMU}.csv",
        ),
        Figure(
            "Torque over wind-up",
            "Integral of dT/K_WTS; antisymmetric in the torque.",
            [make_torque_angle_chart(result)],
            data_file=f"{_COMPLIANCE_FMU}.csv",
        ),
        Figure(
            "Effect of friction",
            "Computed by the FMU with the friction of catalogue drives: efficiency over load, with the "
            "published values at rated torque and 2000 rev/min, and the torque at the output that "
            "back-drives the drive without a motor. Starting and running torque determine friction_coulomb "
            "and friction_viscous, the efficiency load_loss, the back-driving torque load_loss_back. For "
            "CSF drives the running torque is an estimate; there the back-driving torque determines both, "
            "if the result is not negative.",
            make_friction_charts(_spring_fmu(pipeline_result)),
        ),
    ]


def _spring_fmu(pipeline_result: Any) -> Path:
    """Path of the FMU HarmonicDriveSpring, FMI 2.0."""
    paths: list[Path] = pipeline_result.fmu_paths
    return next(p for p in paths if (p.parent.name, p.stem) == ("fmi2", "HarmonicDriveSpring"))


def make_friction_charts(fmu_path: Path) -> list[Panel]:
    """Charts of efficiency over load and of back-driving torque of catalogue drives, from an FMU."""
    panels, published_torques, found_torques = [], [], []
    drives, share = efficiency.drives_with_friction(), np.linspace(0.1, 1.0, 41) ** 2
    for drive in drives:
        rated = drive.known_numbers["rated_torque"].si_value
        published_torque = drive.known_numbers["back_driving_torque"].si_value
        with efficiency.open_fmu_test_rig(fmu_path, efficiency.ratio_and_friction_parameters(drive)) as bench:
            rows = {
                rpm: [bench.efficiency(rpm * np.pi / 30.0, load) for load in rated * share]
                for rpm in (500, 2000, 3500)
            }
            found_torques.append(bench.back_driving_torque(10.0 * published_torque))
        published_torques.append(published_torque)
        series = [Series(f"{rpm} rev/min", rated * share, row) for rpm, row in rows.items()]
        if "efficiency" in drive.known_numbers:
            published_efficiency = [drive.known_numbers["efficiency"].si_value]
            series.append(
                Series(
                    "published, 2000 rev/min",
                    [rated],
                    published_efficiency,
                    "empty",
                    marker_tooltips=[drive.joint_name],
                )
            )
        panels.append(Panel(f"Efficiency of {drive.joint_name}", "load [N m]", "efficiency", series))
    ends = [0.0, max(published_torques)]
    names = [drive.joint_name for drive in drives]
    marks = Series("FMU", published_torques, found_torques, "full", marker_tooltips=names)
    series_with_diagonal = [marks, Series("equal", ends, ends, is_dashed=True)]
    return [*panels, Panel("Back-driving torque", "published [N m]", "FMU [N m]", series_with_diagonal)]


def make_stiffness_charts(ramp_result: RampResult, validated_points: list[ValidatedPoint]) -> list[Panel]:
    """Charts of the stiffness of the drive and of its contact pair over torque, with published points."""
    c = ramp_result.variable_columns
    points = [row.published_point for row in validated_points]
    drive = [Series(name, c["tau"], c[name]) for name in ("K_WTS", "K_TS")]
    drive += published_series([p for p in points if p.quantity == "K_WTS"], "torque")
    least = [row for row in validated_points if row.published_point.quantity == "K_TS_least"]
    most = [
        r
        for r in validated_points
        if r.published_point.quantity == "K_TS" and "deformation" in r.published_point.where
    ]
    ends = [*most, *least]
    pair = [
        Series("K_TS on the paper's scale", c["tau"], c["K_TS_pair"]),
        Series(
            "computed: maximum and minimum over w",
            [r.published_point.where["torque"] for r in ends],
            [float(r.computed_value) for r in ends],
            "empty",
            marker_tooltips=[r.published_point.id for r in ends],
        ),
        *published_series([p for p in points if p.quantity in ("K_TS", "K_TS_least")], "torque"),
    ]
    return [
        Panel("Stiffness of the drive", "torque [N m]", "K [N m/rad]", drive),
        Panel("Stiffness of the contact pair", "torque [N m]", "K_TS [N m/rad]", pair),
    ]


def make_torque_angle_chart(ramp_result: RampResult) -> Panel:
    """Chart of the torque over the wind-up, for both directions."""
    tau, angle = (
        ramp_result.variable_columns["tau"],
        np.degrees(ramp_result.variable_columns["phi_rel"]) * 60.0,
    )
    both = np.concatenate([-angle[::-1], angle]), np.concatenate([-tau[::-1], tau])
    return Panel("Torque over wind-up", "wind-up [arcmin]", "torque [N m]", [Series("torque", *both)])


VIBRATION_TORQUES_OVER_RATED = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Torques over the rated torque [1] of the simulated free vibrations."""


def _vibration_torques(fmu_path: Path, start_values: Mapping[str, float]) -> list[float]:
    """Mean torques [N.m] at which free vibrations of a drive are simulated: zero to rated torque."""
    with Slave(fmu_path, start_values, (), ("rated_torque",)) as drive:
        (rated,) = drive.get_outputs()
    return [share * rated for share in VIBRATION_TORQUES_OVER_RATED]


def _make_working_point(fmu_path: Path, torque: float, start_values: Mapping[str, float]) -> WorkingPoint:
    """Working point of a drive under a torque [N.m], about which the body vibrates."""
    with Slave(fmu_path, {**start_values, "w2": 1.0}, ("w1",), ("tau",)) as dashpot:
        (damping,) = dashpot.get_outputs()
    with Slave(fmu_path, start_values, ("phi2", "w2"), ("tau", "K_WTS")) as law:
        angle, stiffness = _wind_up_and_stiffness(law, torque)
    return WorkingPoint(torque, angle, stiffness, damping)


def _wind_up_and_stiffness(drive_fmu: Slave, torque: float) -> tuple[float, float]:
    """Wind-up [rad] and stiffness [N.m/rad] of a drive under a torque [N.m]."""

    def torque_and_stiffness(wind_up_angle: float) -> tuple[float, float]:
        """Torque [N.m] and stiffness [N.m/rad] of the drive at an angle [rad]."""
        drive_fmu.set_inputs(wind_up_angle, 0.0)
        transmitted, stiffness = drive_fmu.get_outputs()
        return transmitted, stiffness

    def transmitted_torque(wind_up_angle: float) -> float:
        """Torque [N.m] of the drive at an angle [rad]."""
        return torque_and_stiffness(wind_up_angle)[0]

    angle = efficiency.solve_wind_up(transmitted_torque, torque, torque_and_stiffness(0.0)[1])
    return angle, torque_and_stiffness(angle)[1]


VIBRATION_TEST = VibrationTest(
    model_name="HarmonicDriveSpring",
    motion_inputs=("phi2", "w2"),
    force_output="tau2",
    body_model="RotationalInertia",
    load_variable="tau",
    find_example_loads=_vibration_torques,
    find_start_values=lambda torque: {},
    find_working_point=_make_working_point,
    release_force=1e-3,
    load_axis=PlotAxis("torque", "N m", 1.0),
    deflection_axis=PlotAxis("wind-up", "urad", 1e6),
    support_description="motor held",
    stiffness_output="K_WTS",
    deflection_for_slip=SlipDeflection(0.0, 5e-4, "three lengths of its hysteresis"),
    frictionless_parameters={"hysteresis_loss": 0.0},
)
"""System of the main job in which a harmonic drive vibrates."""


_LABORATORY_INPUT_RANGES = {
    "hysteresis_loss": (0.0, 1e-3),
    "hysteresis_stiffness": (0.0, 2e4),
    "lost_motion": (0.0, 1e-3),
    "friction_coulomb": (0.0, 0.1),
    "friction_stribeck": (0.0, 0.1),
    "friction_viscous": (0.0, 1e-3),
    "load_loss": (0.0, 0.5),
    "load_loss_back": (-1.0, 0.5),
    **{f"friction_{n}": (0.0, 0.05) for n in FRICTION_HARMONICS},
    **{f"friction_{n}_phase": (-math.pi, math.pi) for n in FRICTION_HARMONICS},
    "temperature_factor": (0.5, 5.0),
    "viscous_temperature_coefficient": (0.0, 0.1),
    "dry_temperature_coefficient": (0.0, 0.1),
    "temperature": (253.15, 353.15),
    "phi1": (-0.1, 0.1),
    **{f"error_{n}": (0.0, 1e-3) for n in KINEMATIC_ERROR_HARMONICS},
    **{f"error_{n}_phase": (-math.pi, math.pi) for n in KINEMATIC_ERROR_HARMONICS},
}
"""{parameter: lower and upper end of its slider [SI]}."""
_PUBLISHED_POINT_INPUTS = {
    "torque": "tau",
    "deformation": "radial_deformation",
    "eccentricity": "eccentricity",
}
"""{argument of a published number: variable of the FMU}."""

_TRANSMISSION_VIEW = TransmissionView(
    input_angle="phi1",
    speed="w1",
    follower="phi2",
    follower_speed="w2",
    torque="tau1",
    load="tau",
    error="phi_error",
    ratio="ratio",
    rated="rated_torque",
    default_speed=200.0,
)
"""Animation of the drive on the laboratory page."""
_DRIVE_LOAD_CYCLE = MODELS["HarmonicDriveSpring"].load_cycle
"""Load cycle of the FMU that shows hysteresis."""
_LABORATORY_EXAMPLE_DRIVE = efficiency.drives_with_friction()[0]
"""Catalogue drive of the example with friction."""
_LABORATORY_EXAMPLE = ExampleValues(
    f"friction of the catalogue's {_LABORATORY_EXAMPLE_DRIVE.joint_name}, 1 arcmin of hysteresis and of "
    "kinematic error",
    {
        k: v
        for k, v in efficiency.ratio_and_friction_parameters(_LABORATORY_EXAMPLE_DRIVE).items()
        if k != "ratio"
    }
    | {k: float(v) for k, v in (_DRIVE_LOAD_CYCLE.variable_values if _DRIVE_LOAD_CYCLE else {}).items()}
    | {"error_2": 1.5e-4},
)
"""Values that the example button of the laboratory page sets."""

LABORATORY_MODELS = {
    "HarmonicDriveSpring": LaboratoryModel(
        slider_spans=_LABORATORY_INPUT_RANGES,
        pointer_inputs=("phi2",),
        transmission_view=_TRANSMISSION_VIEW,
        example_values=_LABORATORY_EXAMPLE,
    ),
    "HarmonicDriveCompliance": LaboratoryModel(
        slider_spans=_LABORATORY_INPUT_RANGES,
        pointer_inputs=("tau",),
        published_points={
            "K_TS": PublishedQuantity("K_TS_pair", _PUBLISHED_POINT_INPUTS),
            "K_WTS": PublishedQuantity("K_WTS", _PUBLISHED_POINT_INPUTS),
            "peak_pressure": PublishedQuantity("p_max", _PUBLISHED_POINT_INPUTS),
        },
    ),
}
"""{FMU: contents of its laboratory page that are not variables of the FMU}."""
