"""`jointfmu new` for a harmonic drive: by its name in the catalogue, or from numbers of a catalogue row."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from jointfmu.joints.harmonic_drive.friction import friction_limits, viscous_torque
from jointfmu.quantity.units import CELSIUS_ZERO_IN_KELVIN, unit_size

from ...common.options import Option, format_option_flag
from ...inputs.catalogue import SourcedNumber
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand
from ...inputs.drawing.quantities import parse_quantity_value
from ...inputs.drawing.reading import parse_temperature
from .catalogue import (
    MAX_OVER_RATED_TORQUE,
    STIFFNESS_COLUMN_NAMES,
    STIFFNESS_COLUMNS,
    find_drive,
    find_drive_with_ratio,
)
from .friction import (
    CATALOGUE_MOTOR_SPEED,
    FRICTION_COLUMNS,
    compute_friction_parameters,
    compute_rated_efficiency,
    describe_interval,
)

if TYPE_CHECKING:
    from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

    from .fit.drive import CatalogueRow

_STATABLE_CATALOGUE_COLUMNS = ("ratio", *STIFFNESS_COLUMN_NAMES, "rated_torque", *FRICTION_COLUMNS)
"""Columns of the catalogue that the user can state."""
DAMPING_OVER_STIFFNESS = 1e-4
"""Damping d over the stiffness K1 [s] of a new drive: damping ratio of 2 % at a frequency of 60 Hz."""
FIXED_PARTS: Mapping[str, str] = {
    "circular-spline": "circular spline fixed, output the flexspline: it turns against the motor",
    "flexspline": "flexspline fixed, output the circular spline: with the motor, one more than printed",
    "wave-generator": "wave generator fixed, from flexspline to circular spline: 1 + 1/(ratio printed)",
}
"""{fixed part of the drive: effect on the ratio}."""
MIN_EFFICIENCY = 0.1
"""Least efficiency [1] at rated torque and 2000 rev/min: drives of the catalogue have 0.5 to 0.85."""


def _make_joint(drawing_options: DrawingOptions) -> NewJoint:
    """Make a harmonic drive from the options of `jointfmu new`."""
    source, printed = drawing_options["source"] or drawing_options["catalogue"] or "catalogue", {}
    if drawing_options["catalogue"]:
        drive = find_drive(drawing_options["catalogue"])
        printed = dict(drive.known_numbers)
    for name in _STATABLE_CATALOGUE_COLUMNS:
        if drawing_options[name] is not None:
            value = parse_quantity_value(
                name,
                drawing_options[name],
                drawing_options["stiffness_unit"] if name.startswith("K") else None,
            )
            if value == 0.0:
                raise ValueError("--ratio = 0: expected a number above or below 0")
            if (
                name == "ratio"
                and drawing_options["catalogue"]
                and abs(value) != drive.known_numbers["ratio"].si_value
            ):
                drive = find_drive_with_ratio(drive, abs(value))
                source, printed = drawing_options["source"] or drive.joint_name, dict(drive.known_numbers)
            printed[name] = _attach_source_to_stated_value(drawing_options, value)
    if drawing_options["hysteresis"] is not None:
        printed["hysteresis_loss"] = _attach_source_to_stated_value(
            drawing_options, parse_quantity_value("hysteresis", drawing_options["hysteresis"])
        )
    if missing := [
        format_option_flag(name) for name in ("ratio", *STIFFNESS_COLUMN_NAMES) if name not in printed
    ]:
        raise ValueError(
            f"{', '.join(missing)} missing: state them from the maker's catalogue, or use --catalogue NAME "
            "(jointfmu catalogue lists names)"
        )
    if "rated_torque" not in printed:
        text = "no rated torque given; T2 of the catalogue"
        printed["rated_torque"] = SourcedNumber(printed["T2"].si_value, "estimate", text)
    friction_numbers = read_friction_parameters(drawing_options, printed)
    (printed["ratio"], ratio_text) = _signed_speed_ratio(drawing_options, printed["ratio"])
    printed = {name: number for name, number in printed.items() if name not in FRICTION_COLUMNS}
    if drawing_options["corner"] is not None:
        if drawing_options["law"] == "hu2023":
            raise ValueError("--corner has no effect with --law hu2023, which has no corners; leave it out")
        corner = parse_quantity_value("corner", drawing_options["corner"])
        printed["corner"] = SourcedNumber(
            corner, "user", "stated" if corner else "stated: the lines, with kinks"
        )
    joint = (
        _make_joint_with_contact_pair_law
        if drawing_options["law"] == "hu2023"
        else _make_joint_with_catalogue_law
    )(printed, friction_numbers, source)
    check_stated_friction(drawing_options, joint)
    joint = replace(joint, facts={"ratio": (printed["ratio"].si_value, "1", ratio_text), **joint.facts})
    return (
        joint
        if drawing_options["temperature"] is None
        else set_lubricant_temperature(joint, drawing_options["temperature"])
    )


def check_stated_friction(drawing_options: DrawingOptions, new_joint: NewJoint) -> None:
    """Raise ValueError if friction that the user states leaves no usable efficiency."""
    stated = [
        name
        for name in ("starting_torque", "running_torque", "motor_drag")
        if drawing_options[name] is not None
    ]
    if not stated:
        return
    drive, efficiency = (
        new_joint.parameter_file.values,
        compute_rated_efficiency(new_joint.parameter_file.values),
    )
    if efficiency >= MIN_EFFICIENCY:
        return
    name = max(stated, key=lambda name: parse_quantity_value(name, drawing_options[name]))
    highest = drive.rated_torque / abs(drive.ratio) * (1.0 / MIN_EFFICIENCY - 1.0)
    raise ValueError(
        f"{format_option_flag(name)} = {drawing_options[name]!r} is read as "
        f"{parse_quantity_value(name, drawing_options[name]):g} N.m at the motor: it leaves an efficiency "
        f"of {efficiency:.1%} at rated torque, expected at least {MIN_EFFICIENCY:.0%}, which is up to about "
        f"{highest:.2g} N.m; check the unit, as in 50mN.m"
    )


def set_lubricant_temperature(new_joint: NewJoint, temperature_text: str) -> NewJoint:
    """Set the start temperature of the lubricant, and compute the friction results at this temperature.

    temperature_text : temperature as the user states it
    """
    kelvin, drive = parse_temperature("temperature", temperature_text), new_joint.parameter_file.values
    file = replace(
        new_joint.parameter_file,
        inputs={**new_joint.parameter_file.inputs, "temperature": kelvin},
        origins={**new_joint.parameter_file.origins, "inputs.temperature": "user"},
        sources={**new_joint.parameter_file.sources, "inputs.temperature": f"stated: {temperature_text}"},
    )
    dry = float(friction_limits(drive, 0.0, 0.0, kelvin)[0])
    temperature_text = f"{kelvin - CELSIUS_ZERO_IN_KELVIN:g} degrees C"
    facts = {"starting_torque": (dry, "N.m", f"at the wave generator, at {temperature_text}")}
    wet = float(
        friction_limits(drive, CATALOGUE_MOTOR_SPEED, 0.0, kelvin)[0]
        + viscous_torque(drive, CATALOGUE_MOTOR_SPEED, kelvin)
    )
    facts["running_torque"] = (wet, "N.m", f"the same at 2000 rev/min, at {temperature_text}")
    if "efficiency" in new_joint.facts:
        what = f"{new_joint.facts['efficiency'][2]}, at {temperature_text}"
        facts["efficiency"] = (compute_rated_efficiency(drive, kelvin), "1", what)
    return replace(new_joint, parameter_file=file, facts={**new_joint.facts, **facts})


def _signed_speed_ratio(
    drawing_options: DrawingOptions, stated_ratio: SourcedNumber
) -> tuple[SourcedNumber, str]:
    """Speed ratio input/output with its sign, which depends on the fixed part; and a text on the sign."""
    if stated_ratio.si_value < 0.0:
        if drawing_options["fixed"]:
            raise ValueError(
                f"--fixed {drawing_options['fixed']} with --ratio = {stated_ratio.si_value:g}, whose sign "
                "is stated; expected the ratio as catalogues print it, above 0"
            )
        return stated_ratio, "as stated, with its sign"
    fixed = drawing_options["fixed"] or next(iter(FIXED_PARTS))
    value = {
        "circular-spline": -stated_ratio.si_value,
        "flexspline": stated_ratio.si_value + 1.0,
        "wave-generator": 1.0 + 1.0 / stated_ratio.si_value,
    }[fixed]
    source = f"{stated_ratio.value_source}; {fixed.replace('-', ' ')} fixed"
    return stated_ratio._replace(si_value=value, value_source=source), FIXED_PARTS[fixed]


def read_friction_parameters(
    drawing_options: DrawingOptions, sourced_numbers: Mapping[str, SourcedNumber]
) -> dict[str, SourcedNumber]:
    """Read the friction parameters of the drive, from stated numbers and numbers of the catalogue.

    Empty for a fixed wave generator. Raises ValueError for stated numbers that contradict each other.
    """
    stated = [name for name in FRICTION_COLUMNS if drawing_options[name] is not None]
    if "efficiency" in stated and not MIN_EFFICIENCY <= sourced_numbers["efficiency"].si_value < 1.0:
        raise ValueError(
            f"--efficiency = {drawing_options['efficiency']!r} is outside [{MIN_EFFICIENCY:g}, 1); write "
            "percent as 70%"
        )
    if drawing_options["fixed"] == "wave-generator":
        if stated:
            raise ValueError(
                f"{format_option_flag(stated[0])} has no effect with --fixed wave-generator, which does not "
                "turn; leave it out"
            )
        return {}
    if "starting_torque" not in sourced_numbers and stated:
        raise ValueError(
            f"{format_option_flag(stated[0])} needs {format_option_flag('starting_torque')}: without it no "
            "friction acts"
        )
    if "starting_torque" in stated:  # scaled numbers belong to another starting torque; others must be met
        sourced_numbers = {
            n: p
            for n, p in sourced_numbers.items()
            if n not in FRICTION_COLUMNS or p.value_origin != "estimate"
        }
        stated = [name for name in FRICTION_COLUMNS if name in sourced_numbers]
    return _add_motor_drag(
        compute_friction_parameters(sourced_numbers, stated), drawing_options["motor_drag"]
    )


def _add_motor_drag(
    friction_numbers: dict[str, SourcedNumber], drag_text: str | None
) -> dict[str, SourcedNumber]:
    """Add the dry friction of the motor's bearings and seals to friction_coulomb.

    drag_text : motor drag as the user states it; None: no motor drag
    """
    if drag_text is None:
        return friction_numbers
    drag = parse_quantity_value("motor_drag", drag_text)
    text = f"motor drag {drag:g} N.m, stated"
    dry_friction = friction_numbers.get("friction_coulomb")
    if dry_friction is None:
        return {**friction_numbers, "friction_coulomb": SourcedNumber(drag, "user", text)}
    source, interval = dry_friction.value_source, dry_friction.estimate_interval
    if interval is not None:
        interval = interval[0] + drag, interval[1] + drag
        source = f"{source.rpartition('; ')[0]}; {describe_interval(interval)}"
    total = SourcedNumber(
        dry_friction.si_value + drag,
        dry_friction.value_origin,
        f"{source}; with {text}",
        estimate_interval=interval,
    )
    return {**friction_numbers, "friction_coulomb": total}


def _attach_source_to_stated_value(drawing_options: DrawingOptions, stated_value: float) -> SourcedNumber:
    """Attach its origin and source to a number that the user states in an option.

    The source is a catalogue row, or a replacement of a number of a named drive.
    """
    kind = "user" if drawing_options["catalogue"] and not drawing_options["source"] else "catalogue"
    return SourcedNumber(stated_value, kind, drawing_options["source"] or "stated")


def _make_joint_with_catalogue_law(
    sourced_numbers: dict[str, SourcedNumber], friction_numbers: Mapping[str, SourcedNumber], drive_name: str
) -> NewJoint:
    """Make a drive with the three lines of the catalogue as stiffness (law `catalogue`)."""
    from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

    from .efficiency import LOST_MOTION_TORQUE_OVER_RATED
    from .fit import catalogue

    _catalogue_row(sourced_numbers)  # raises ValueError for an implausible row
    rated, peak = sourced_numbers["rated_torque"].si_value, sourced_numbers.pop("peak_torque", None)
    if peak is None:
        peak = SourcedNumber(
            MAX_OVER_RATED_TORQUE * rated, "estimate", f"{MAX_OVER_RATED_TORQUE:g} times rated_torque"
        )
    sourced_numbers["max_torque"] = peak
    facts = {}
    if "hysteresis_loss" in sourced_numbers and sourced_numbers["hysteresis_loss"].is_upper_limit:
        bound = sourced_numbers["hysteresis_loss"]
        text = f"{_source_without_brackets(bound)}; not used unless --hysteresis is stated"
        facts["hysteresis_bound"] = (bound.si_value, "rad", text)
        sourced_numbers["hysteresis_loss"] = SourcedNumber(
            0.0, "user", f"default choice: none; {bound.value_source}"
        )
    printed_angle = sourced_numbers.pop("lost_motion", None)
    text = f"not published; {DAMPING_OVER_STIFFNESS:g} s times K1, 2 % of critical at 60 Hz"
    sourced_numbers["d"] = SourcedNumber(
        DAMPING_OVER_STIFFNESS * sourced_numbers["K1"].si_value, "estimate", text
    )
    sourced_numbers |= friction_numbers
    file = catalogue.make_drive_with_catalogue_law(drive_name, sourced_numbers)
    spring = HarmonicDriveSpring.tabulate(file.values)
    facts |= compute_wind_up_results(spring, LOST_MOTION_TORQUE_OVER_RATED)
    if printed_angle:
        computed_angle, unit, text = facts["lost_motion"]
        relation = "below" if computed_angle < printed_angle.si_value else "above"
        limit = (
            f"{printed_angle.si_value:.4g} rad ({printed_angle.si_value / unit_size('arcmin'):.4g} arcmin)"
        )
        text += f"; {relation} {limit}: {_source_without_brackets(printed_angle)}"
        facts["lost_motion"] = (computed_angle, unit, text)
    if friction_numbers:
        facts["efficiency"] = (compute_rated_efficiency(file.values), "1", "at rated torque and 2000 rev/min")
    kinds = {
        name: number.value_origin for name, number in sourced_numbers.items() if name in file.values_by_name
    }
    guessed = ", ".join(sorted(name for name, kind in kinds.items() if kind == "estimate"))
    notes = [f"estimated, not in the catalogue row: {guessed}"]
    if file.values.corner == 0.0:
        notes.append("corner = 0: the stiffness jumps at T1 and T2, and the FMU signals no event there")
    return NewJoint(file, facts, notes)


def compute_wind_up_results(
    drive_spring: "HarmonicDriveSpring", lost_motion_torque_over_rated: float
) -> dict[str, tuple[float, str, str]]:
    """Compute wind-up at rated torque and lost motion of a drive for the user.

    lost_motion_torque_over_rated : torque over rated torque [1] at which catalogues state the lost motion
    """
    from .efficiency import compute_lost_motion

    rated = drive_spring.joint.rated_torque
    text = (
        f"computed between +-{lost_motion_torque_over_rated:g} times the rated torque, in the middle of the "
        "loop"
    )
    return {
        "wind_up": (
            float(drive_spring.curve.inverse(rated)),
            "rad",
            f"at the rated torque {rated:g} N.m, on the midline",
        ),
        "lost_motion": (compute_lost_motion(drive_spring, lost_motion_torque_over_rated), "rad", text),
    }


def _make_joint_with_contact_pair_law(
    sourced_numbers: Mapping[str, SourcedNumber],
    friction_numbers: Mapping[str, SourcedNumber],
    drive_name: str,
) -> NewJoint:
    """Make a drive with the law of Hu 2023, fitted to the numbers of a catalogue row."""
    from .fit import catalogue

    kind, ratio = sourced_numbers["rated_torque"].value_origin, sourced_numbers["ratio"].si_value
    row = _catalogue_row(sourced_numbers)
    found = catalogue.fit_contact_pair_law(
        row,
        sourced_numbers=catalogue.make_sourced_numbers(row, kind, ratio, drive_name),
        row_source=drive_name,
    )
    file = replace(found.parameters, name=drive_name)
    loss = sourced_numbers.get("hysteresis_loss")
    if loss is not None and loss.value_origin != "estimate":
        friction_numbers = {"hysteresis_loss": loss, **friction_numbers}
    for label, stated in friction_numbers.items():
        file = file.with_values({label: stated.si_value}, stated.value_origin, stated.value_source)
    return NewJoint(file, found.facts, found.warnings())


def _source_without_brackets(sourced_number: SourcedNumber) -> str:
    """Source of a number without the part in brackets."""
    return sourced_number.value_source.split(" (", 1)[0]


def _catalogue_row(sourced_numbers: Mapping[str, SourcedNumber]) -> "CatalogueRow":
    """Catalogue row of the numbers. Raises ValueError for an implausible row."""
    from .fit.drive import CatalogueRow

    return CatalogueRow(
        **{name: sourced_numbers[name].si_value for name in STIFFNESS_COLUMN_NAMES},
        rated_torque=sourced_numbers["rated_torque"].si_value,
    )


def make_friction_options(first_default: str = "") -> tuple[Option, ...]:
    """Options of `jointfmu new` for the friction of a drive.

    first_default : text on the source of the default value, if it is not the value without friction
    """
    return (
        Option(
            "starting_torque",
            f"starting torque at the input without load [N.m] (default: {first_default}no friction)",
            "T",
        ),
        Option(
            "running_torque",
            f"torque at the input without load, at 2000 rev/min [N.m] (default: {first_default}equal to "
            "--starting-torque)",
            "T",
        ),
        Option(
            "back_driving_torque",
            "torque at the output that turns the drive if no motor holds the input [N.m] (default: "
            f"{first_default}the friction under load that follows from --efficiency)",
            "T",
        ),
        Option(
            "efficiency",
            f"efficiency at rated torque and 2000 rev/min [1], as in 0.7 or 70% (default: {first_default}the "
            "friction under load that follows from --back-driving-torque, if stated)",
            "E",
        ),
        Option(
            "motor_drag",
            "dry friction of bearings and seals of the motor, added to that of the drive [N.m] (default: "
            "none)",
            "T",
        ),
        Option("temperature", "start temperature of the lubricant [degC], or as in 293K (default: 20)", "T"),
    )


NEW_JOINT_COMMAND = NewJointCommand(
    joint_description="a harmonic drive by its name in the catalogue, or from its catalogue numbers",
    example_options="--catalogue CSG-17-100",
    command_options=(
        Option("catalogue", "name of the drive, as in CSG-17-100 (list: jointfmu catalogue)", "NAME"),
        Option(
            "ratio",
            "speed ratio [1]: positive as in catalogues, and --fixed decides its sign; or negative, input "
            "speed over output speed; with --catalogue: selects the drive with this ratio (default: that of "
            "--catalogue)",
            "R",
        ),
        Option(
            "fixed",
            "part that is fixed; it decides the sign of the ratio (default: circular-spline, the ratio is "
            "negative)",
            choices=tuple(FIXED_PARTS),
        ),
        *(
            Option(column.column_name, f"{column.column_meaning} [{column.si_unit}]", column.column_name[0])
            for column in STIFFNESS_COLUMNS
        ),
        Option(
            "stiffness_unit",
            "unit of --K1, --K2, --K3 if you state the number alone, as in kgf.m/arcmin, or with the factor "
            "of the column heading, as in '1e4 N.m/rad' (default: N.m/rad); a number may have its own unit, "
            "as in --K1 2.9N.m/arcmin",
            "UNIT",
        ),
        Option(
            "rated_torque",
            "rated torque at the output [N.m] (default: from --catalogue, else the value of --T2)",
            "T",
        ),
        Option(
            "hysteresis",
            "hysteresis loss: angle between the branches of the loop at zero torque [arcmin] (default: no "
            "hysteresis)",
            "H",
        ),
        *make_friction_options("from --catalogue, else "),
        Option(
            "source",
            "publication of the numbers, for the parameter file (default: the drive of --catalogue, else "
            "'catalogue')",
            "TEXT",
        ),
        Option(
            "corner",
            "half-width of the rounded corners of the curve at T1 and T2, relative to the wind-up there "
            "[1]; 0: sharp corners (default: 0.04)",
            "C",
        ),
        Option(
            "law",
            "catalogue: the three straight lines of the catalogue (default); hu2023: contact law of the "
            "teeth (Hu 2023), fitted to these lines",
            choices=("catalogue", "hu2023"),
        ),
    ),
    make_joint=_make_joint,
)
"""Options of `jointfmu new harmonic-drive`, and the function that makes the joint."""
