"""`jointfmu new cycloidal-drive`: a cycloidal or RV reducer from the numbers that its maker prints.

Makers print the torsional rigidity K, the lost motion (between -3 % and +3 % of the rated torque, midway in
the hysteresis loop), and the angle between the branches at zero torque, called backlash. The midline is

    phi(T) = T/K + lost_motion/2 tanh(T/T_p),   T_p = PLAY_TORQUE_OVER_RATED_TORQUE rated_torque.

The backlash is the parameter `hysteresis_loss`. The parameter `lost_motion` is found so that the computed
loop has the printed lost motion. The parameter file is one of a harmonic drive with the law `catalogue`: the
input shaft takes the place of the wave generator.
"""

from dataclasses import replace

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import ParameterFile

from ...common.options import Option
from ...inputs.catalogue import SourcedNumber
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand
from ...inputs.drawing.quantities import parse_quantity_value
from .catalogue import MAX_OVER_RATED_TORQUE
from .efficiency import compute_hysteresis_loss, compute_lost_motion
from .friction import FRICTION_COLUMNS
from .new import (
    DAMPING_OVER_STIFFNESS,
    check_stated_friction,
    compute_wind_up_results,
    make_friction_options,
    read_friction_parameters,
    set_lubricant_temperature,
)

LOST_MOTION_TORQUE_OVER_RATED = 0.03
"""Torque over rated torque [1], positive and negative, at which makers of cycloidal drives state lost
motion."""
RELATIVE_LOST_MOTION_TOLERANCE = 1e-9
"""Relative tolerance [1] of the parameter `lost_motion`: far below the two digits that makers print."""
RIGIDITY_CHANGE_OVER_RATED_TORQUE = 0.5
"""Torque over rated torque [1] at which the first torsional rigidity ends and the second begins."""


def _make_joint(drawing_options: DrawingOptions) -> NewJoint:
    """Make a cycloidal drive from the options of `jointfmu new`."""
    from .fit import catalogue

    source = drawing_options["source"] or "stated"
    ratio, rated = (parse_quantity_value(name, drawing_options[name]) for name in ("ratio", "rated_torque"))
    if ratio == 0.0:
        raise ValueError("--ratio = 0: expected a number above or below 0")
    texts = drawing_options["rigidity"]
    if len(texts) > 2:
        raise ValueError(
            f"--rigidity has {len(texts)} numbers; expected one, or two: up to and above 50 % of rated torque"
        )
    low, high = parse_quantity_value("rigidity", texts[0]), parse_quantity_value("rigidity", texts[-1])
    if high < low:
        raise ValueError(
            f"--rigidity = {texts[1]!r} above 50 % of rated torque is below {texts[0]!r}; expected at least "
            "the same"
        )
    peak = SourcedNumber(
        MAX_OVER_RATED_TORQUE * rated, "estimate", f"{MAX_OVER_RATED_TORQUE:g} times rated_torque"
    )
    if drawing_options["peak_torque"] is not None:
        peak = SourcedNumber(
            parse_quantity_value("peak_torque", drawing_options["peak_torque"]), "catalogue", source
        )
        if peak.si_value < rated:
            raise ValueError(
                f"--peak-torque = {peak.si_value:g} N.m is outside [{rated:g}, inf) N.m: at least the rated "
                "torque"
            )
    numbers = {
        "ratio": SourcedNumber(ratio, "catalogue", f"{source}, with its sign"),
        "rated_torque": SourcedNumber(rated, "catalogue", source),
        "max_torque": peak,
        "K1": SourcedNumber(low, "catalogue", source),
        "K2": SourcedNumber(high, "catalogue", source),
        "K3": SourcedNumber(high, "catalogue", source),
        "T1": SourcedNumber(
            RIGIDITY_CHANGE_OVER_RATED_TORQUE * rated,
            "derived",
            f"{RIGIDITY_CHANGE_OVER_RATED_TORQUE:.0%} of rated torque",
        ),
        "T2": SourcedNumber(rated, "derived", "rated torque"),
        "d": SourcedNumber(
            DAMPING_OVER_STIFFNESS * low,
            "estimate",
            f"not published; {DAMPING_OVER_STIFFNESS:g} s times the torsional rigidity",
        ),
    }
    if drawing_options["hysteresis"] is not None:
        loss = parse_quantity_value("hysteresis", drawing_options["hysteresis"])
        numbers["hysteresis_loss"] = SourcedNumber(loss, "catalogue", source)
    for name in FRICTION_COLUMNS:
        if drawing_options[name] is not None:
            numbers[name] = SourcedNumber(
                parse_quantity_value(name, drawing_options[name]), "catalogue", source
            )
    friction = read_friction_parameters({**drawing_options, "fixed": None}, numbers)
    numbers = {name: number for name, number in numbers.items() if name not in FRICTION_COLUMNS} | friction
    name = f"cycloidal drive {rated:g} N.m, ratio {ratio:g}"
    file = catalogue.make_drive_with_catalogue_law(name, numbers)
    if drawing_options["lost_motion"] is not None:
        file = _set_lost_motion(file, drawing_options["lost_motion"], source)
    joint = NewJoint(file, {})
    check_stated_friction(drawing_options, joint)
    guessed = ", ".join(sorted(n for n, number in numbers.items() if number.value_origin == "estimate"))
    joint = replace(
        joint, facts=_compute_drive_results(joint), warnings=[f"estimated, not printed: {guessed}"]
    )
    return (
        joint
        if drawing_options["temperature"] is None
        else set_lubricant_temperature(joint, drawing_options["temperature"])
    )


def _set_lost_motion(
    parameter_file: ParameterFile, lost_motion_text: str, lost_motion_source: str
) -> ParameterFile:
    """Set the parameter `lost_motion` so that the computed loop has the printed lost motion.

    lost_motion_text : printed lost motion as the user states it

    Raises ValueError if the elastic wind-up alone exceeds the printed lost motion.
    """
    from scipy.optimize import brentq

    from .fit.drive import RAD_PER_ARCMIN

    printed = parse_quantity_value("lost_motion", lost_motion_text)

    def lost_motion_excess(lost_motion_parameter: float) -> float:
        """Computed lost motion less the printed one [rad], at a parameter `lost_motion` [rad]."""
        drive = replace(parameter_file.values, lost_motion=lost_motion_parameter)
        return (
            compute_lost_motion(HarmonicDriveSpring.tabulate(drive), LOST_MOTION_TORQUE_OVER_RATED) - printed
        )

    if (elastic := lost_motion_excess(0.0)) > 0.0:
        lowest = (elastic + printed) / RAD_PER_ARCMIN
        raise ValueError(
            f"--lost-motion = {lost_motion_text!r} is outside [{lowest:.4g}, inf) arcmin: the torsional "
            "rigidity alone gives this angle between -3 % and +3 % of rated torque"
        )
    high = printed
    while lost_motion_excess(high) < 0.0:
        high *= 2.0
    text = (
        f"{lost_motion_source}: {printed:.5g} rad between -3 % and +3 % of rated torque, less the elastic "
        "wind-up"
    )
    play = float(brentq(lost_motion_excess, 0.0, high, rtol=RELATIVE_LOST_MOTION_TOLERANCE))
    return parameter_file.with_values({"lost_motion": play}, "derived", text)


def _compute_drive_results(new_joint: NewJoint) -> dict[str, tuple[float, str, str]]:
    """Compute wind-up at rated torque, lost motion and hysteresis loss of a cycloidal drive for the user."""
    drive = new_joint.parameter_file.values
    spring = HarmonicDriveSpring.tabulate(drive)
    facts = compute_wind_up_results(spring, LOST_MOTION_TORQUE_OVER_RATED)
    if drive.hysteresis_loss:
        text = "computed angle between the branches at zero torque, after rated torque"
        facts["hysteresis_loss"] = (compute_hysteresis_loss(spring), "rad", text)
    return facts


NEW_CYCLOIDAL_DRIVE_COMMAND = NewJointCommand(
    joint_description="a cycloidal or RV reducer from the numbers that its maker prints",
    example_options="--ratio 121 --rated-torque 412 --rigidity 108 --lost-motion 1 --hysteresis 1",
    command_options=(
        Option(
            "ratio",
            "speed ratio, input over output [1]; negative: the output turns against the input",
            "R",
            is_required=True,
        ),
        Option("rated_torque", "rated torque at the output [N.m]", "T", is_required=True),
        Option(
            "rigidity",
            "torsional rigidity [N.m/arcmin]; or two numbers: up to 50 % of the rated torque, and above 50 %",
            "K",
            is_required=True,
            is_list=True,
        ),
        Option(
            "lost_motion",
            "lost motion [arcmin]: change of the output angle from -3 % to +3 % of the rated torque, on the "
            "midline of the hysteresis loop (default: only the elastic wind-up)",
            "A",
        ),
        Option(
            "hysteresis",
            "hysteresis loss, which makers print as backlash: angle between the branches of the loop at "
            "zero torque [arcmin] (default: no hysteresis)",
            "H",
        ),
        Option(
            "peak_torque",
            f"largest permissible torque at the output [N.m] (default: {MAX_OVER_RATED_TORQUE:g} times the "
            "rated torque)",
            "T",
        ),
        *make_friction_options(),
        Option("source", "publication of the numbers, for the parameter file (default: 'stated')", "TEXT"),
    ),
    make_joint=_make_joint,
)
"""Options of `jointfmu new cycloidal-drive`, and the function that makes the joint."""
