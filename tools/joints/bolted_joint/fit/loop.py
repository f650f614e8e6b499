"""Fit of the bolted joint to loops, decays or responses in shear: friction, stiffness level and exponent.

At constant preload the first loading in shear, B(u) [N] at the displacement u [m], follows from the normal
force of the contact (Jäger 1995, Ciavarella 1998):

    B(u) = mu (F_N(0) - F_N(kappa u/mu)),    kappa = K_T/K_N,

F_N(s) normal force [N] of all nodes at the separation s [m] from the preloaded state. So three quantities can
be fitted: the stiffness at rest gives the level (factor) of the law, the force at gross slip gives mu, and
the decrease of the stiffness in between gives the exponent of K_N as a function of the load.

With elastic sides the first loading is computed with the complete joint, as exported. The fit does not change
the modes of the bodies.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from jointfmu.joints.bolted_joint.law import AnyBoltedJoint, preload_pressure, working_preload
from jointfmu.mechanics.curve import Curve, tabulate_approach
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.progress import set_status_text
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal
from jointfmu.quantity.units import unit_sizes

from ....inputs.fitting import hysteresis_fit
from ....inputs.fitting.branches import MeasuredLoops
from ....inputs.fitting.hysteresis import HysteresisLaw
from ....inputs.fitting.least_squares import FitSolution, Unknown, UnknownExchange
from ....inputs.fitting.measurement import (
    SIMILAR_JOINT_REMEDY,
    Measurement,
    MeasurementColumns,
    read_measurement,
)
from ....inputs.fitting.outcome import (
    DerivedFitValues,
    FitResult,
    build_fitted_file,
    find_undetermined_parameters,
    make_fit_unknowns,
)
from .preload import (
    BOLTED_JOINT_FOR_FITS,
    SERIES_STIFFNESS_NAME,
    compute_joint_stiffness,
    describe_series_remedy,
    make_embedding_fact,
    merged_normalised_pressure,
    note_large_roughness,
)
from .preload import DEFAULT_FITTED_PARAMETERS as INTERFACE

LOOP_COLUMN_NAMES = MeasurementColumns(
    "force", "displacement", unit_sizes("N", "kN"), unit_sizes("m", "mm", "um", "nm")
)
"""Columns of force and displacement in a file of loops, with their units."""
DEFAULT_FITTED_PARAMETERS = {law: ("mu", *names) for law, names in INTERFACE.items()}
"""{law: parameters to fit}: friction, stiffness level and, if the law has one, exponent. The exponent is not
fitted to vibrations, in which exponent and level have nearly the same effect."""
START_VALUES: Mapping[str, Sequence[float]] = {"mu": (0.05, 0.15, 0.4), "surface.D": (1.2, 1.45)}
"""{parameter: further start values of the search}, in addition to the values of the start file. The start
value of the level follows from the data."""
UNKNOWNS_OUTSIDE_JOINT = (hysteresis_fit.DAMPING_RATIO_NAME, SERIES_STIFFNESS_NAME)
"""Unknowns that are not parameters of the joint."""
START_SERIES_STIFFNESSES_OVER_JOINT_STIFFNESS = (2.0, 1.1, 1.5, 5.0)
"""Start values of the series stiffness over the measured stiffness at rest [1]."""
MAX_FRICTION_LIMIT_MISFIT = 0.02
"""Relative difference of the friction limit and the flat ends of loops [1], from which a note is printed."""
TABLE_END_OVER_LOOP_AMPLITUDE = 1.05
"""Largest displacement of the tabulated law over the amplitude of the loops [1]."""
PLAUSIBLE_FRICTION_COEFFICIENT_RANGE = (0.005, 3.0)
"""Plausible friction coefficients [1]."""
MIN_SLIP_RATIO_FOR_FRICTION = 0.7
"""Largest friction force of the data over friction limit [1], below which mu depends on the exponent of the
law: an exponent that is 25 % too large gives a mu that is 15 to 25 % too large."""
_FIRST_LOADING_STEP_COUNT = 48
"""Number of steps of the table of first loading [1], finer near rest."""
_ELASTIC_FIRST_LOADING_STEP_COUNT, _GROSS_SLIP_OVER_ELASTIC_DISPLACEMENT = 24, 4.0
"""Elastic sides: steps of the table, and displacement of gross slip over friction_limit/K_xx [1]."""


def make_shear_loop_law(
    joint_parameters: AnyBoltedJoint,
    preload: float,
    series_stiffness: float | None = None,
    max_displacement: float = np.inf,
) -> tuple[HysteresisLaw, DerivedFitValues]:
    """Make the hysteresis law of the joint in shear, at a preload [N] of each bolt.

    series_stiffness : [N/m] of a structure in series; None: rigid. The displacement is the sum for joint
                       and structure, and Masing's rule holds for both together.
    max_displacement : [m] largest displacement for which the first loading of elastic sides is computed

    Also returns, for the joint without the structure: friction limit [N], stiffness at rest [N/m], and the
    exponent [1] of the load with which the stiffness falls as the joint opens.
    Raises ValueError if nothing is in contact, if a pressure exceeds the range of the contact law, or if
    there is no equilibrium with elastic sides.
    """
    curve, approach, weight = _preloaded_interface(joint_parameters, preload)
    kappa, mu = float(joint_parameters.shear_stiffness_ratio()), joint_parameters.mu
    separation = (float(np.max(approach)) - curve.displacement[0]) * np.linspace(
        0.0, 1.0, _FIRST_LOADING_STEP_COUNT + 1
    ) ** 2
    load, stiffness, d2_load = (
        value @ weight for value in curve.derivatives(approach - separation[:, None], 2)
    )
    motion, force, tangent_stiffness = separation * mu / kappa, mu * (load[0] - load), kappa * stiffness
    limit = float(mu * load[0])
    if joint_parameters.has_elastic_members:
        gross_slip = (
            _GROSS_SLIP_OVER_ELASTIC_DISPLACEMENT * limit / shear_stiffness_at_rest(joint_parameters, preload)
        )
        motion, force, tangent_stiffness = _first_loading_of_elastic_sides(
            joint_parameters, preload, gross_slip, float(motion[-1]), max_displacement
        )
    compliance = 0.0 if series_stiffness is None else 1.0 / series_stiffness
    displacement = motion + compliance * force
    table = CubicHermiteSpline(
        displacement, force, tangent_stiffness / (1.0 + compliance * tangent_stiffness)
    )
    energy = table.antiderivative()
    end, max_force = float(displacement[-1]), float(force[-1])

    def friction_force(displacement: Array) -> Array:
        """Shear force [N] in first loading at displacements [m]."""
        return np.where(displacement < end, table(np.minimum(displacement, end)), max_force)

    def friction_work(displacement: Array) -> Array:
        """Work [J] of the shear force in first loading up to displacements [m]."""
        inside = np.minimum(displacement, end)
        return np.asarray(energy(inside) + max_force * (displacement - inside))

    return HysteresisLaw(friction_force, friction_work), {
        "friction_limit": (limit, "N", "mu times the normal force"),
        "shear_stiffness": (float(tangent_stiffness[0]), "N/m", "K_xx of the joint at rest: the level"),
        "exponent": (
            float(d2_load[0] * load[0] / stiffness[0] ** 2),
            "1",
            "power of the load with which the stiffness falls as the joint opens",
        ),
    }


@lru_cache(maxsize=8)
def _first_loading_of_elastic_sides(
    joint_parameters: AnyBoltedJoint,
    preload: float,
    linear_displacement_term: float,
    quadratic_displacement_term: float,
    max_displacement: float,
) -> tuple[Array, Array, Array]:
    """First loading in shear of a joint with elastic members: displacements, forces, tangent stiffnesses (n).

    The displacements [m] of side 2 are s = a t + b t^2, with t from 0 to 1 in equal steps. If a + b exceeds
    `max_displacement` [m], all displacements are scaled down to end there.

    linear_displacement_term, quadratic_displacement_term : a [m], b [m]
    """
    fraction = np.linspace(0.0, 1.0, _ELASTIC_FIRST_LOADING_STEP_COUNT + 1)
    motion = (linear_displacement_term * fraction + quadratic_displacement_term * fraction**2) * min(
        1.0, max_displacement / (linear_displacement_term + quadratic_displacement_term)
    )
    force, stiffness = _compute_shear_force_along_path(joint_parameters, preload, motion)
    curve = CubicSpline(motion, force, bc_type=((1, stiffness[0]), (1, stiffness[-1])))
    return motion, force, curve(motion, 1)


def _compute_shear_force_along_path(
    joint_parameters: AnyBoltedJoint, preload: float, displacement: Array
) -> tuple[Array, Array]:
    """Compute shear force (n) [N] and K_xx (n) [N/m] along displacements x (n) [m], from the virgin state."""
    inputs: dict[str, ArrayLike] = {"preload": preload, "s_rel_x": displacement}
    columns = (
        BOLTED_JOINT_FOR_FITS.open_with_parameters(joint_parameters).evaluate_path(inputs).variable_columns
    )
    return -columns["f_x"], columns["K_xx"]


def _compute_masing_deviation(
    joint_parameters: AnyBoltedJoint,
    preload: float,
    measured_loops: MeasuredLoops,
    hysteresis_law: HysteresisLaw,
) -> Array:
    """Deviation (n) [N] of the force from Masing's rule, at the n samples of loops, for elastic sides.

    Bending of the bodies changes the slip direction of parts of the contact, so that unloading does not
    mirror loading. After gross slip the deviation is about half a percent of the friction force.
    """
    deviation = np.empty_like(measured_loops.joint_force)
    for run in range(measured_loops.run_of_sample[-1] + 1):
        branches = np.unique(measured_loops.branch_of_sample[measured_loops.run_of_sample == run])
        middle = 0.5 * (
            np.max(measured_loops.branch_start_motion[branches])
            + np.min(measured_loops.branch_start_motion[branches])
        )
        paths = [
            np.linspace(
                middle, measured_loops.branch_start_motion[branches[0]], _ELASTIC_FIRST_LOADING_STEP_COUNT + 1
            )
        ]
        for k in branches:
            start, motion = (
                measured_loops.branch_start_motion[k],
                measured_loops.joint_motion[measured_loops.branch_of_sample == k],
            )
            end = motion[np.argmax(np.abs(motion - start))]
            paths.append(np.linspace(start, end, _ELASTIC_FIRST_LOADING_STEP_COUNT + 1))
        run_force, _ = _compute_shear_force_along_path(
            joint_parameters, preload, np.concatenate(paths) - middle
        )
        for k, path, force in zip(branches, paths[1:], np.split(run_force, len(paths))[1:], strict=True):
            start, motion = (
                measured_loops.branch_start_motion[k],
                measured_loops.joint_motion[measured_loops.branch_of_sample == k],
            )
            difference = force - force[0] - hysteresis_law.force_change(path, np.full_like(path, start))
            distance = np.abs(motion - start)
            deviation[measured_loops.branch_of_sample == k] = np.interp(
                distance, np.abs(path - start), difference
            )
    return deviation


def shear_stiffness_at_rest(joint_parameters: AnyBoltedJoint, preload: float) -> float:
    """Shear stiffness K_xx [N/m] of the joint without slip, at a preload [N] of each bolt.

    Raises ValueError if nothing is in contact or a pressure exceeds the range of the contact law.
    """
    curve, approach, weight = _preloaded_interface(joint_parameters, preload)
    if joint_parameters.has_elastic_members:
        return float(compute_joint_stiffness(joint_parameters, np.array([preload]), "tangential")[0])
    return float(joint_parameters.shear_stiffness_ratio() * (curve.derivatives(approach, 1)[1] @ weight))


def _preloaded_interface(joint_parameters: AnyBoltedJoint, preload: float) -> tuple[Curve, Array, Array]:
    """Preloaded interface: pressure-approach curve, approaches (n) [m] and areas (n) [m2] of its n nodes.

    Raises ValueError if nothing is in contact or a pressure exceeds the range of the contact law.
    """
    shape, curve = merged_normalised_pressure(joint_parameters.pattern), tabulate_approach(joint_parameters)
    pressure = preload_pressure(joint_parameters, shape, preload, 0.0)
    if not 0.0 < (max_pressure := float(np.max(pressure))) < curve.end_point[1]:
        raise ValueError(
            f"preload = {preload:g} N per bolt presses with {max_pressure:.3g} Pa, allowed is up to "
            f"{curve.end_point[1]:.3g} Pa, where the law ends; state the preload of the test"
        )
    return curve, curve.inverse(pressure), joint_parameters.A_0 * shape.area_share


def fit(
    data_path: str | Path,
    start_parameters: ParameterFile | None = None,
    fitted_names: Sequence[str] | None = None,
    *,
    preload: float | None = None,
    modal_mass: float | None = None,
    damping_ratio: float = 0.0,
    series_stiffness: float | None = None,
) -> FitResult:
    """Fit a bolted joint to a file of loops, decays, responses, or frequency and damping over the amplitude.

    Parameters
    ----------
    start_parameters : parameters to start from; None: the default joint
    fitted_names     : names to fit, also `damping_ratio` and `series_stiffness`; None: those of
                       DEFAULT_FITTED_PARAMETERS
    preload          : [N] of each bolt in the test; None: the one in the inputs of `start_parameters`
    modal_mass       : [kg] mass that vibrates on the joint; required unless the file has loops
    damping_ratio    : [1] of the structure alone
    series_stiffness : [N/m] of the structure, in series with the joint; None: rigid, unless it is fitted

    Raises ValueError with a one-line message for a bad file, unit or value, a loop that creates energy, or a
    name that cannot be fitted. Raises RuntimeError if the fit does not converge.
    """
    data = read_measurement(data_path, LOOP_COLUMN_NAMES)
    file = start_parameters or load_default("bolted_joint")
    force = file.start_value("preload") if preload is None else preload
    if not 0.0 < force < np.inf:
        raise InputRefusal(
            f"preload = {force:g} N is outside (0, inf); state that of each bolt in the test", "preload"
        )
    names = list(
        fitted_names or DEFAULT_FITTED_PARAMETERS[file.law][: 3 if data.measurement_kind == "loops" else 2]
    )
    if series_stiffness is not None and not 0.0 < series_stiffness < np.inf:
        raise InputRefusal(
            f"series stiffness = {series_stiffness:g} N/m is outside (0, inf)", SERIES_STIFFNESS_NAME
        )

    def make_joint(parameter_values: Mapping[str, float]) -> AnyBoltedJoint:
        """Make the joint with values of the fitted parameters."""
        parameters: AnyBoltedJoint = file.with_values(
            _select_joint_parameters(parameter_values), "calibration", "fit"
        ).values
        return parameters

    def get_series_stiffness(parameter_values: Mapping[str, float]) -> float | None:
        """Series stiffness [N/m]: fitted or stated; None: rigid structure."""
        return parameter_values.get(SERIES_STIFFNESS_NAME, series_stiffness)

    reach = (
        TABLE_END_OVER_LOOP_AMPLITUDE * data.largest_amplitude if data.measurement_kind == "loops" else np.inf
    )

    def make_joint_hysteresis_law(parameter_values: Mapping[str, float]) -> HysteresisLaw:
        """Make the hysteresis law in shear of joint and structure, for values of the fitted parameters."""
        set_status_text(
            "tries " + ", ".join(f"{name} = {value:.4g}" for name, value in parameter_values.items())
        )
        return make_shear_loop_law(
            make_joint(parameter_values), force, get_series_stiffness(parameter_values), reach
        )[0]

    model = hysteresis_fit.build_measurement_model(
        data, make_joint_hysteresis_law, "modal_mass", modal_mass, damping_ratio
    )
    measured_rest = data.rest_stiffness(modal_mass)
    min_measured_rest = measured_rest

    def joint_and_structure_stiffness(parameter_values: Mapping[str, float]) -> float:
        """Stiffness [N/m] at rest of joint and structure in series."""
        series = get_series_stiffness(parameter_values)
        return 1.0 / (
            1.0 / shear_stiffness_at_rest(make_joint(parameter_values), force)
            + (0.0 if series is None else 1.0 / series)
        )

    notes = []
    if isinstance(data.measured_data, MeasuredLoops):
        min_measured_rest = data.measured_data.min_rest_stiffness
        _check_measured_loops(
            data,
            data.measured_data,
            measured_rest / joint_and_structure_stiffness({}),
            make_joint({}),
            force,
            file,
            SERIES_STIFFNESS_NAME in names,
        )
        if not data.measured_data.is_stiffness_resolved and not fitted_names:
            _, *level_names = names
            names = names[:1]
            notes.append(
                f"the loops do not determine {', '.join(level_names)}, values of {file.name} are kept: all "
                "of the interface slips within few samples after each reversal; the stiffness after a "
                f"reversal is at least {min_measured_rest:.3g} N/m"
            )
    if (
        series_stiffness is not None
        and SERIES_STIFFNESS_NAME not in names
        and series_stiffness <= min_measured_rest
    ):
        raise InputRefusal(
            f"series stiffness = {series_stiffness:g} N/m is outside ({min_measured_rest:.4g}, inf): in the "
            "data, joint and structure together have at least this stiffness at rest",
            SERIES_STIFFNESS_NAME,
        )
    unknown_list = make_fit_unknowns(
        file,
        [name for name in names if name not in UNKNOWNS_OUTSIDE_JOINT],
        {},
        UNKNOWNS_OUTSIDE_JOINT if data.measurement_kind != "loops" else (SERIES_STIFFNESS_NAME,),
    )
    unknown_list += [hysteresis_fit.UNKNOWN_DAMPING_RATIO] * (hysteresis_fit.DAMPING_RATIO_NAME in names)
    unknown_list += [
        Unknown(
            SERIES_STIFFNESS_NAME,
            "N/m",
            START_SERIES_STIFFNESSES_OVER_JOINT_STIFFNESS[0] * measured_rest,
            0.0,
            np.inf,
        )
    ] * (SERIES_STIFFNESS_NAME in names)
    level = _replace_stiffness_level_by_rest_stiffness(file, names, joint_and_structure_stiffness)
    is_vibration_with_level = data.measurement_kind != "loops" and set(
        DEFAULT_FITTED_PARAMETERS[file.law][1:]
    ) <= set(names)
    starts = {
        **START_VALUES,
        SERIES_STIFFNESS_NAME: [
            times * measured_rest for times in START_SERIES_STIFFNESSES_OVER_JOINT_STIFFNESS[1:]
        ],
    }
    is_joint_alone = series_stiffness is None and SERIES_STIFFNESS_NAME not in names
    is_corrected = data.measurement_kind == "loops" and file.values.has_elastic_members and is_joint_alone

    def subtract_masing_deviation(parameter_values: Mapping[str, float]) -> Measurement:
        """Measured loops minus the deviation of the joint from Masing's rule."""
        assert isinstance(data.measured_data, MeasuredLoops)
        off = _compute_masing_deviation(
            make_joint(parameter_values),
            force,
            data.measured_data,
            make_joint_hysteresis_law(parameter_values),
        )
        return replace(
            data, measured_data=replace(data.measured_data, joint_force=data.measured_data.joint_force - off)
        )

    solution, scale, data = hysteresis_fit.fit_measurement(
        data,
        unknown_list,
        model,
        starts,
        level,
        is_vibration_with_level and level is not None,
        subtract_masing_deviation if is_corrected else None,
    )
    result = build_fitted_file(
        file,
        _select_joint_parameters(solution.values),
        "calibration",
        data.measurement_path.name,
        f"{data.describe_range}, preload {force:g} N",
        find_undetermined_parameters(solution),
    )
    law, joint_facts = make_shear_loop_law(
        make_joint(solution.values), force, get_series_stiffness(solution.values), reach
    )
    slip_ratio = (
        float(law.friction_force(np.array([data.largest_amplitude]))[0]) / joint_facts["friction_limit"][0]
    )
    if isinstance(data.measured_data, MeasuredLoops) and data.measured_data.slip_force:
        text = "measured, half the force difference of the flat ends"
        joint_facts["slip_force"] = (data.measured_data.slip_force, "N", text)
    text = "largest friction force of the data over friction_limit"
    facts = make_embedding_fact(file, force) | joint_facts | {"slip_reached": (slip_ratio, "1", text)}
    is_exponent_fitted = not {*DEFAULT_FITTED_PARAMETERS[file.law][2:]}.isdisjoint(names)
    if "mu" in names and not is_exponent_fitted and slip_ratio < MIN_SLIP_RATIO_FOR_FRICTION:
        exponent, mu = joint_facts["exponent"][0], solution.values["mu"]
        notes.append(
            f"slip_reached = {slip_ratio:.3g} is below {MIN_SLIP_RATIO_FOR_FRICTION:g}: the data determine "
            f"only exponent/mu = {exponent / mu:.4g}; mu = {mu:.3g} holds for the exponent {exponent:.3g} of "
            "the law, which is not fitted: add data of larger amplitude"
        )
    fit_result = FitResult(
        result,
        solution,
        facts | hysteresis_fit.summarize_fit(data, solution, law, scale),
        hysteresis_fit.make_fit_plots(data, model, solution.values, scale),
        notes=[
            *notes,
            *note_large_roughness(file, solution, not is_joint_alone),
            *_note_friction_limit(joint_facts, result.values.mu),
            *hysteresis_fit.list_misfit_notes(data, solution, law, scale),
        ],
    )
    if fit_result.rejection_reason():
        return fit_result
    return replace(
        fit_result, procedure_rejection_reason=_reject_friction_coefficient(solution, force, modal_mass)
    )


def _note_friction_limit(joint_facts: DerivedFitValues, mu: float) -> list[str]:
    """Note for the user if the friction limit of the law misses the flat ends of the loops; else empty."""
    if "slip_force" not in joint_facts:
        return []
    limit, slip_force = joint_facts["friction_limit"][0], joint_facts["slip_force"][0]
    if abs(limit / slip_force - 1.0) <= MAX_FRICTION_LIMIT_MISFIT:
        return []
    return [
        f"friction_limit is {100.0 * abs(limit / slip_force - 1.0):.2g} % "
        f"{'above' if limit > slip_force else 'below'} slip_force: the law cannot follow the shape of the "
        f"loops; the flat ends alone give mu = {mu * slip_force / limit:.4g}"
    ]


def _reject_friction_coefficient(
    solution: FitSolution, preload: float, modal_mass: float | None
) -> str | None:
    """Reason to reject a fit whose friction coefficient is not plausible, as text; None if it is plausible.

    preload, modal_mass : of each bolt [N], of the vibrating mass [kg]; None: loops
    """
    low, high = PLAUSIBLE_FRICTION_COEFFICIENT_RANGE
    mu = solution.values.get("mu")
    if mu is None or low <= mu <= high:
        return None
    mass_text = "" if modal_mass is None else f"the vibrating mass, --modal-mass {modal_mass:g} kg, "
    return (
        f"mu = {mu:.4g} is outside [{low:g}, {high:g}]; check {mass_text}the preload of each bolt, "
        f"{preload:g} N, and the units of the columns"
    )


def _check_measured_loops(
    measured_data: Measurement,
    measured_loops: MeasuredLoops,
    measured_over_start_stiffness: float,
    joint_parameters: AnyBoltedJoint,
    preload: float,
    start_file: ParameterFile,
    is_series_fitted: bool,
) -> None:
    """Check measured loops: stiffness after reversals, gross-slip force, and no bolt touches its hole.

    measured_over_start_stiffness : measured stiffness over stiffness of the start values [1]
    joint_parameters, preload     : joint with the start values, preload [N] of each bolt
    is_series_fitted              : whether the fit finds a stiffness in series; the joint may then be soft

    Raises ValueError for loops whose force rises again after slip. Raises InputRefusal for a stiffness far
    from the stiffness of the start values, and for a slip force without a plausible friction coefficient.
    """
    if bearing := measured_loops.find_clearance_slip():
        clearance, slip_change = bearing
        raise ValueError(
            f"{measured_data.measurement_path}: the force rises again after slip: the joint slips at about "
            f"{0.5 * slip_change:.3g} N through a clearance of about {1e6 * clearance:.3g} um and then "
            "bears; the fit has friction alone: expected loops that stay within the clearance"
        )
    slip_force = measured_loops.slip_force
    if slip_force is not None:
        normal_force = float(working_preload(joint_parameters, preload)) * joint_parameters.n_bolts
        low, high = PLAUSIBLE_FRICTION_COEFFICIENT_RANGE
        if not low <= slip_force / normal_force <= high:
            raise InputRefusal(
                f"{measured_data.measurement_path}: the force at gross slip is {slip_force:.4g} N, which "
                f"needs mu = {slip_force / normal_force:.3g} at a normal force of {normal_force:.4g} N, "
                f"allowed are {low:g} to {high:g}: check the unit of column force, and the preload of each "
                "bolt",
                "preload",
            )
    is_stiff = measured_over_start_stiffness > 1.0
    if is_stiff or (measured_loops.is_stiffness_resolved and not is_series_fitted):
        remedy = (
            SIMILAR_JOINT_REMEDY
            if is_stiff
            else "members or structure in series with the joint may make it soft: "
            f"{describe_series_remedy(start_file, False)}"
        )
        LOOP_COLUMN_NAMES.check_stiffness_ratio(
            measured_data.measurement_path,
            measured_over_start_stiffness,
            measured_data.stated_units,
            start_file,
            slip_force is not None,
            remedy,
        )


def _replace_stiffness_level_by_rest_stiffness(
    parameter_file: ParameterFile,
    fitted_names: Sequence[str],
    compute_stiffness_at_rest: Callable[[Mapping[str, float]], float],
) -> UnknownExchange | None:
    """Make the stiffness at rest [N/m] an unknown of the fit, in place of the law's stiffness parameter.

    compute_stiffness_at_rest : {fitted parameter: value} -> stiffness at rest [N/m], without slip

    Returns the exchange of both unknowns; None if the stiffness parameter is not fitted.
    """
    _, level, *_ = DEFAULT_FITTED_PARAMETERS[parameter_file.law]
    if level not in fitted_names:
        return None
    return UnknownExchange(level, compute_stiffness_at_rest, "N/m", "stiffness at rest")


def _select_joint_parameters(parameter_values: Mapping[str, float]) -> dict[str, float]:
    """Select the parameters of the joint from the fitted values, without the unknowns outside the joint."""
    return {name: value for name, value in parameter_values.items() if name not in UNKNOWNS_OUTSIDE_JOINT}
