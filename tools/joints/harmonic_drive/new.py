"""`jointfmu new` for a harmonic drive: by its name in the catalogue, or from numbers of a catalogue row."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from jointfmu.joints.harmonic_drive.friction import friction_limits, viscous_torque
from jointfmu.quantity.units import CELSIUS_ZERO_IN_KELVIN

from ...common.options import Option, format_option_flag
from ...inputs.catalogue import SourcedNumber
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand
from ...inputs.drawing.quantities import parse_value
from ...inputs.drawing.reading import parse_temperature
from .catalogue import (
    STIFFNESS_COLUMN_NAMES,
    STIFFNESS_COLUMNS,
    TABLE_END_OVER_RATED_TORQUE,
    find_drive,
    find_ratio,
)
from .friction import (
    CATALOGUE_MOTOR_SPEED,
    FRICTION_COLUMNS,
    describe_interval,
    friction_parameters,
    rated_efficiency,
)

if TYPE_CHECKING:
    from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

    from .fit.drive import CatalogueRow

_OPTION_COLUMNS = ("ratio", *STIFFNESS_COLUMN_NAMES, "rated_torque", *FRICTION_COLUMNS)
"""Columns of the catalogue that the user can state."""
DAMPING_TIME = 1e-4
"""Damping d over the stiffness K1 [s] of a new drive: damping ratio of 2 % at a frequency of 60 Hz."""
FIXED_PARTS: Mapping[str, str] = {
    "circular-spline": "circular spline fixed, output the flexspline: it turns against the motor",
    "flexspline": "flexspline fixed, output the circular spline: with the motor, one more than printed",
    "wave-generator": "wave generator fixed, from flexspline to circular spline: 1 + 1/(ratio printed)",
}
"""{fixed part of the drive: effect on the ratio}."""
MIN_EFFICIENCY = 0.1
"""Least efficiency [1] at rated torque and 2000 rev/min: drives of the catalogue have 0.5 to 0.85."""


def _make_joint(options: DrawingOptions) -> NewJoint:
    """Make a harmonic drive from the options of `jointfmu new`."""
    source, printed = options["source"] or options["catalogue"] or "catalogue", {}
    if options["catalogue"]:
        drive = find_drive(options["catalogue"])
        printed = dict(drive.numbers)
    for name in _OPTION_COLUMNS:
        if options[name] is not None:
            value = parse_value(
                name, options[name], options["stiffness_unit"] if name.startswith("K") else None
            )
            if value == 0.0:
                raise ValueError("--ratio = 0 is outside (-inf, 0) and (0, inf)")
            if name == "ratio" and options["catalogue"] and abs(value) != drive.numbers["ratio"].value:
                drive = find_ratio(drive, abs(value))
                source, printed = options["source"] or drive.name, dict(drive.numbers)
            printed[name] = _stated_number(options, value)
    if options["hysteresis"] is not None:
        printed["hysteresis_loss"] = _stated_number(options, parse_value("hysteresis", options["hysteresis"]))
    if missing := [
        format_option_flag(name) for name in ("ratio", *STIFFNESS_COLUMN_NAMES) if name not in printed
    ]:
        raise ValueError(f"{', '.join(missing)} missing: state the row of the catalogue, or --catalogue NAME")
    if "rated_torque" not in printed:
        text = "no rated torque given; T2 of the catalogue"
        printed["rated_torque"] = SourcedNumber(printed["T2"].value, "estimate", text)
    friction_numbers = read_friction_parameters(options, printed)
    (printed["ratio"], ratio_text) = _signed_ratio(options, printed["ratio"])
    printed = {name: number for name, number in printed.items() if name not in FRICTION_COLUMNS}
    if options["corner"] is not None:
        if options["law"] == "hu2023":
            raise ValueError("--corner is of the catalogue's lines; --law hu2023 has no corners")
        corner = parse_value("corner", options["corner"])
        printed["corner"] = SourcedNumber(
            corner, "user", "stated" if corner else "stated: the lines, with kinks"
        )
    joint = (
        _make_joint_with_contact_pair_law if options["law"] == "hu2023" else _make_joint_with_catalogue_law
    )(printed, friction_numbers, source)
    check_efficiency(options, joint)
    joint = replace(joint, facts={"ratio": (printed["ratio"].value, "1", ratio_text), **joint.facts})
    return joint if options["temperature"] is None else set_temperature(joint, options["temperature"])


def check_efficiency(options: DrawingOptions, joint: NewJoint) -> None:
    """Raise ValueError if friction that the user states leaves no usable efficiency."""
    stated = [
        name for name in ("starting_torque", "running_torque", "motor_drag") if options[name] is not None
    ]
    if not stated:
        return
    drive, efficiency = joint.file.values, rated_efficiency(joint.file.values)
    if efficiency >= MIN_EFFICIENCY:
        return
    name = max(stated, key=lambda name: parse_value(name, options[name]))
    highest = drive.rated_torque / abs(drive.ratio) * (1.0 / MIN_EFFICIENCY - 1.0)
    raise ValueError(
        f"{format_option_flag(name)} = {options[name]!r} is read as "
        f"{parse_value(name, options[name]):g} N.m at the "
        f"motor: it leaves an efficiency of {efficiency:.1%} at rated torque, expected at least "
        f"{MIN_EFFICIENCY:.0%}, which is up to about {highest:.2g} N.m; check the unit, as in 50mN.m"
    )


def set_temperature(joint: NewJoint, temperature_text: str) -> NewJoint:
    """Set the start temperature of the lubricant, and compute the friction facts at this temperature.

    temperature_text : temperature as the user states it
    """
    kelvin, drive = parse_temperature("temperature", temperature_text), joint.file.values
    file = replace(
        joint.file,
        inputs={**joint.file.inputs, "temperature": kelvin},
        origins={**joint.file.origins, "inputs.temperature": "user"},
        sources={**joint.file.sources, "inputs.temperature": f"stated: {temperature_text}"},
    )
    dry = float(friction_limits(drive, 0.0, 0.0, kelvin)[0])
    temperature_text = f"{kelvin - CELSIUS_ZERO_IN_KELVIN:g} degrees C"
    facts = {"starting_torque": (dry, "N.m", f"at the wave generator, at {temperature_text}")}
    wet = float(
        friction_limits(drive, CATALOGUE_MOTOR_SPEED, 0.0, kelvin)[0]
        + viscous_torque(drive, CATALOGUE_MOTOR_SPEED, kelvin)
    )
    facts["running_torque"] = (wet, "N.m", f"the same at 2000 rev/min, at {temperature_text}")
    if "efficiency" in joint.facts:
        what = f"{joint.facts['efficiency'][2]}, at {temperature_text}"
        facts["efficiency"] = (rated_efficiency(drive, kelvin), "1", what)
    return replace(joint, file=file, facts={**joint.facts, **facts})


def _signed_ratio(options: DrawingOptions, stated_ratio: SourcedNumber) -> tuple[SourcedNumber, str]:
    """Speed ratio input/output with its sign, which depends on the fixed part; and a text on the sign."""
    if stated_ratio.value < 0.0:
        if options["fixed"]:
            raise ValueError(
                f"--fixed {options['fixed']} with --ratio = {stated_ratio.value:g}, whose sign is "
                "stated; expected "
                "the ratio as catalogues print it, above 0"
            )
        return stated_ratio, "as stated, with its sign"
    fixed = options["fixed"] or next(iter(FIXED_PARTS))
    value = {
        "circular-spline": -stated_ratio.value,
        "flexspline": stated_ratio.value + 1.0,
        "wave-generator": 1.0 + 1.0 / stated_ratio.value,
    }[fixed]
    source = f"{stated_ratio.source}; {fixed.replace('-', ' ')} fixed"
    return stated_ratio._replace(value=value, source=source), FIXED_PARTS[fixed]


def read_friction_parameters(
    options: DrawingOptions, sourced_numbers: Mapping[str, SourcedNumber]
) -> dict[str, SourcedNumber]:
    """Read the friction parameters of the drive, from stated numbers and numbers of the catalogue.

    Empty for a fixed wave generator. Raises ValueError for stated numbers that contradict each other.
    """
    stated = [name for name in FRICTION_COLUMNS if options[name] is not None]
    if "efficiency" in stated and not MIN_EFFICIENCY <= sourced_numbers["efficiency"].value < 1.0:
        raise ValueError(
            f"--efficiency = {options['efficiency']!r} is outside [{MIN_EFFICIENCY:g}, 1); write percent as "
            "70%"
        )
    if options["fixed"] == "wave-generator":
        if stated:
            raise ValueError(
                f"{format_option_flag(stated[0])} is of the wave generator, which stands with --fixed "
                "wave-generator"
            )
        return {}
    if "starting_torque" not in sourced_numbers and stated:
        raise ValueError(
            f"{format_option_flag(stated[0])} needs {format_option_flag('starting_torque')}: without "
            "it no friction acts"
        )
    if "starting_torque" in stated:  # scaled numbers belong to another starting torque; others must be met
        sourced_numbers = {
            n: p for n, p in sourced_numbers.items() if n not in FRICTION_COLUMNS or p.origin != "estimate"
        }
        stated = [name for name in FRICTION_COLUMNS if name in sourced_numbers]
    return _add_motor_drag(friction_parameters(sourced_numbers, stated), options["motor_drag"])


def _add_motor_drag(
    friction_numbers: dict[str, SourcedNumber], drag_text: str | None
) -> dict[str, SourcedNumber]:
    """Add the dry friction of the motor's bearings and seals to friction_coulomb.

    drag_text : motor drag as the user states it; None: no motor drag
    """
    if drag_text is None:
        return friction_numbers
    drag = parse_value("motor_drag", drag_text)
    text = f"motor drag {drag:g} N.m, stated"
    dry_friction = friction_numbers.get("friction_coulomb")
    if dry_friction is None:
        return {**friction_numbers, "friction_coulomb": SourcedNumber(drag, "user", text)}
    source, interval = dry_friction.source, dry_friction.interval
    if interval is not None:
        interval = interval[0] + drag, interval[1] + drag
        source = f"{source.rpartition('; ')[0]}; {describe_interval(interval)}"
    total = SourcedNumber(
        dry_friction.value + drag, dry_friction.origin, f"{source}; with {text}", interval=interval
    )
    return {**friction_numbers, "friction_coulomb": total}


def _stated_number(options: DrawingOptions, value: float) -> SourcedNumber:
    """Number that the user states, with its source text.

    The source is a catalogue row, or a replacement of a number of a named drive.
    """
    kind = "user" if options["catalogue"] and not options["source"] else "catalogue"
    return SourcedNumber(value, kind, options["source"] or "stated")


def _make_joint_with_catalogue_law(
    sourced_numbers: dict[str, SourcedNumber], friction_numbers: Mapping[str, SourcedNumber], drive_name: str
) -> NewJoint:
    """Make a drive with the three lines of the catalogue as stiffness (law `catalogue`)."""
    from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

    from .efficiency import LOST_MOTION_TORQUE_OVER_RATED
    from .fit import catalogue

    _catalogue_row(sourced_numbers)  # raises ValueError for an implausible row
    rated, peak = sourced_numbers["rated_torque"].value, sourced_numbers.pop("peak_torque", None)
    if peak is None:
        peak = SourcedNumber(
            TABLE_END_OVER_RATED_TORQUE * rated,
            "estimate",
            f"{TABLE_END_OVER_RATED_TORQUE:g} times rated_torque",
        )
    sourced_numbers["max_torque"] = peak
    facts = {}
    if "hysteresis_loss" in sourced_numbers and sourced_numbers["hysteresis_loss"].is_upper_limit:
        bound = sourced_numbers["hysteresis_loss"]
        text = f"{_short_source(bound)}; not used unless --hysteresis is stated"
        facts["hysteresis_bound"] = (bound.value, "rad", text)
        sourced_numbers["hysteresis_loss"] = SourcedNumber(
            0.0, "user", f"default choice: none; {bound.source}"
        )
    printed_angle = sourced_numbers.pop("lost_motion", None)
    text = f"not published; {DAMPING_TIME:g} s times K1, 2 % of critical at 60 Hz"
    sourced_numbers["d"] = SourcedNumber(DAMPING_TIME * sourced_numbers["K1"].value, "estimate", text)
    sourced_numbers |= friction_numbers
    file = catalogue.make_drive_with_catalogue_law(drive_name, sourced_numbers)
    spring = HarmonicDriveSpring.tabulate(file.values)
    facts |= wind_up_facts(spring, LOST_MOTION_TORQUE_OVER_RATED)
    if printed_angle:
        computed_angle, unit, text = facts["lost_motion"]
        relation = "below" if computed_angle < printed_angle.value else "above"
        text += f"; {relation} {printed_angle.value:.4g} rad: {_short_source(printed_angle)}"
        facts["lost_motion"] = (computed_angle, unit, text)
    if friction_numbers:
        facts["efficiency"] = (rated_efficiency(file.values), "1", "at rated torque and 2000 rev/min")
    kinds = {name: number.origin for name, number in sourced_numbers.items() if name in file.values_by_name}
    guessed = ", ".join(sorted(name for name, kind in kinds.items() if kind == "estimate"))
    notes = [f"estimated, not in the catalogue row: {guessed}"]
    if file.values.corner == 0.0:
        notes.append("corner = 0: the stiffness jumps at T1 and T2, and the FMU signals no event there")
    return NewJoint(file, facts, notes)


def wind_up_facts(
    spring: "HarmonicDriveSpring", lost_motion_torque_ratio: float
) -> dict[str, tuple[float, str, str]]:
    """Facts about a drive: wind-up at rated torque, and lost motion.

    lost_motion_torque_ratio : torque over rated torque [1] at which catalogues state the lost motion
    """
    from .efficiency import lost_motion

    rated = spring.joint.rated_torque
    text = (
        f"computed between +-{lost_motion_torque_ratio:g} times the rated torque, in the middle of the loop"
    )
    return {
        "wind_up": (
            float(spring.curve.inverse(rated)),
            "rad",
            f"at the rated torque {rated:g} N.m, on the midline",
        ),
        "lost_motion": (lost_motion(spring, lost_motion_torque_ratio), "rad", text),
    }


def _make_joint_with_contact_pair_law(
    sourced_numbers: Mapping[str, SourcedNumber],
    friction_numbers: Mapping[str, SourcedNumber],
    drive_name: str,
) -> NewJoint:
    """Make a drive with the law of Hu 2023, fitted to the numbers of a catalogue row."""
    from .fit import catalogue

    kind, ratio = sourced_numbers["rated_torque"].origin, sourced_numbers["ratio"].value
    row = _catalogue_row(sourced_numbers)
    found = catalogue.fit_contact_pair_law(
        row, sourced_numbers=catalogue.make_sourced_numbers(row, kind, ratio, drive_name), source=drive_name
    )
    file = replace(found.parameters, name=drive_name)
    loss = sourced_numbers.get("hysteresis_loss")
    if loss is not None and loss.origin != "estimate":
        friction_numbers = {"hysteresis_loss": loss, **friction_numbers}
    for label, stated in friction_numbers.items():
        file = file.with_values({label: stated.value}, stated.origin, stated.source)
    return NewJoint(file, found.facts, found.warnings())


def _short_source(sourced_number: SourcedNumber) -> str:
    """Source of a number without the part in brackets."""
    return sourced_number.source.split(" (", 1)[0]


def _catalogue_row(sourced_numbers: Mapping[str, SourcedNumber]) -> "CatalogueRow":
    """Catalogue row of the numbers. Raises ValueError for an implausible row."""
    from .fit.drive import CatalogueRow

    return CatalogueRow(
        **{name: sourced_numbers[name].value for name in STIFFNESS_COLUMN_NAMES},
        rated=sourced_numbers["rated_torque"].value,
    )


FRICTION_OPTIONS = (
    Option(
        "starting_torque",
        "starting torque at the input (wave generator) without load [N.m] (default: that of the catalogue, "
        "published or scaled, else none)",
        "T",
    ),
    Option(
        "running_torque",
        "torque at the input without load, at 2000 rev/min [N.m] (default: as starting torque)",
        "T",
    ),
    Option("back_driving_torque", "torque at the output that turns the drive without a motor [N.m]", "T"),
    Option("efficiency", "efficiency at rated torque and 2000 rev/min [1]", "E"),
    Option(
        "motor_drag",
        "dry friction of bearings and seals of the motor, added to the drive's [N.m] (default: none)",
        "T",
    ),
    Option("temperature", "start temperature of the lubricant [degC, or as in 293 K] (default: 20)", "T"),
)
"""Options of friction and temperature, of all drives."""


NEW_JOINT_COMMAND = NewJointCommand(
    description="a harmonic drive by its name in the catalogue, or from the numbers of a catalogue row",
    example="--catalogue CSG-17-100",
    options=(
        Option("catalogue", "name of the drive, see jointfmu catalogue", "NAME"),
        Option(
            "ratio",
            "speed ratio as in catalogues [1], above 0; negative: used with its sign; with --catalogue it "
            "selects the row of this ratio",
            "R",
        ),
        Option(
            "fixed",
            "part that is fixed; it decides the sign of the ratio (circular-spline: negative)",
            choices=tuple(FIXED_PARTS),
        ),
        *(
            Option(column.name, f"{column.meaning} [{column.unit}]", column.name[0])
            for column in STIFFNESS_COLUMNS
        ),
        Option(
            "stiffness_unit",
            "unit of K1, K2, K3 given without one, as '1e4 N.m/rad' or kgf.m/arcmin (default: N.m/rad)",
            "UNIT",
        ),
        Option("rated_torque", "rated torque [N.m] (default: the catalogue's, or T2)", "T"),
        Option(
            "hysteresis",
            "hysteresis loss, the angle between the branches at zero torque [arcmin] (default: none)",
            "H",
        ),
        *FRICTION_OPTIONS,
        Option("source", "where the row is published", "TEXT"),
        Option(
            "corner",
            "half-width of the smooth corners at T1 and T2, relative to the wind-up there "
            "[1]; 0: sharp (default: 0.04)",
            "C",
        ),
        Option(
            "law",
            "catalogue: the three lines (default); hu2023: law of the contact pair, fitted to the lines",
            choices=("catalogue", "hu2023"),
        ),
    ),
    make_joint=_make_joint,
)
"""Options of `jointfmu new harmonic-drive`, and the function that makes the joint."""
