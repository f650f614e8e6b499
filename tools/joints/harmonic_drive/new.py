"""`jointfmu new` for a harmonic drive: by its name in the catalogue, or from numbers of a catalogue row."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from jointfmu.joints.harmonic_drive.friction import limits, viscous
from jointfmu.quantity.units import KELVIN_AT_ZERO

from ...catalogue import Printed
from ...command_line.common import flag
from ...drawing.part import Drawing, Given, NewJoint
from ...drawing.reading import number, temperature
from ...joint_parts import Option
from .catalogue import COLUMNS, LINES, ROW, find
from .friction import QUOTED, SPEED, efficiency, friction, interval_text

if TYPE_CHECKING:
    from .fit.drive import Row

_STATED = ("ratio", *LINES, "rated_torque", *QUOTED)
"""Columns of the catalogue that the user can state."""
_UNITS = {column.name: column.unit for column in COLUMNS if column.name in _STATED}
"""{column: unit of a number without a unit}."""
DAMPING = 1e-4
"""Damping d over K1 [s]: a damping ratio of 2 % for a natural frequency of 60 Hz."""
FIXED: Mapping[str, str] = {
    "circular-spline": "circular spline fixed, output the flexspline: it turns against the motor",
    "flexspline": "flexspline fixed, output the circular spline: with the motor, one more than printed",
    "wave-generator": "wave generator fixed, from flexspline to circular spline: 1 + 1/(ratio printed)",
}
"""{fixed part of the drive: effect on the ratio}."""
PEAK = 4.0
"""max_torque over rated torque [1], if no repeated peak torque is known; about that of catalogue drives."""


def _drive(given: Given) -> NewJoint:
    source = given["source"] or given["catalogue"] or "catalogue"
    printed = dict(find(given["catalogue"]).numbers) if given["catalogue"] else {}
    for name, unit in _UNITS.items():
        if given[name] is not None:
            value = number(name, given[name], _unit(given, name), unit, None if name == "ratio" else 0.0)
            if value == 0.0:
                raise ValueError("--ratio = 0 is outside (-inf, 0) and (0, inf)")
            printed[name] = _stated(given, value)
    if given["hysteresis"] is not None:
        printed["hysteresis_loss"] = _stated(
            given, number("hysteresis", given["hysteresis"], "arcmin", "rad")
        )
    if missing := [flag(name) for name in ("ratio", *LINES) if name not in printed]:
        raise ValueError(f"{', '.join(missing)} missing: state the row of the catalogue, or --catalogue NAME")
    if "rated_torque" not in printed:
        text = "no rated torque given; T2 of the catalogue"
        printed["rated_torque"] = Printed(printed["T2"].value, "estimate", text)
    friction_numbers, (printed["ratio"], ratio_text) = _brakes(given, printed), _held(given, printed["ratio"])
    printed = {name: number for name, number in printed.items() if name not in QUOTED}
    if given["corner"] is not None:
        if given["law"] == "hu2023":
            raise ValueError("--corner is of the catalogue's lines; --law hu2023 has no corners")
        corner = number("corner", given["corner"], "1", "1", None)
        printed["corner"] = Printed(corner, "user", "stated" if corner else "stated: the lines, with kinks")
    joint = (_of_pair if given["law"] == "hu2023" else _of_lines)(printed, friction_numbers, source)
    joint = replace(joint, facts={"ratio": (printed["ratio"].value, "1", ratio_text), **joint.facts})
    return joint if given["temperature"] is None else _at(joint, given["temperature"])


def _at(made: NewJoint, text: str) -> NewJoint:
    """Set the start temperature of the lubricant, and compute the friction facts at this temperature.

    text : temperature as the user states it
    """
    kelvin, drive = temperature("temperature", text), made.file.values
    file = replace(
        made.file,
        inputs={**made.file.inputs, "temperature": kelvin},
        origins={**made.file.origins, "inputs.temperature": "user"},
        sources={**made.file.sources, "inputs.temperature": f"stated: {text}"},
    )
    dry = float(limits(drive, 0.0, 0.0, kelvin)[0])
    text = f"{kelvin - KELVIN_AT_ZERO:g} degrees C"
    facts = {"starting_torque": (dry, "N.m", f"at the wave generator, at {text}")}
    wet = float(limits(drive, SPEED, 0.0, kelvin)[0] + viscous(drive, SPEED, kelvin))
    facts["running_torque"] = (wet, "N.m", f"the same at 2000 rev/min, at {text}")
    if "efficiency" in made.facts:
        what = f"{made.facts['efficiency'][2]}, at {text}"
        facts["efficiency"] = (efficiency(drive, kelvin), "1", what)
    return replace(made, file=file, facts={**made.facts, **facts})


def _held(given: Given, ratio: Printed) -> tuple[Printed, str]:
    """Speed ratio of input to output, from the published ratio and the fixed part; and an explanation."""
    if ratio.value < 0.0:
        if given["fixed"]:
            raise ValueError(
                f"--fixed {given['fixed']} beside --ratio = {ratio.value:g}, whose sign is stated; expected "
                "the ratio as catalogues print it, above 0"
            )
        return ratio, "as stated, with its sign"
    fixed = given["fixed"] or next(iter(FIXED))
    value = {
        "circular-spline": -ratio.value,
        "flexspline": ratio.value + 1.0,
        "wave-generator": 1.0 + 1.0 / ratio.value,
    }[fixed]
    source = f"{ratio.source}; {fixed.replace('-', ' ')} fixed"
    return ratio._replace(value=value, source=source), FIXED[fixed]


def _brakes(given: Given, printed: Mapping[str, Printed]) -> dict[str, Printed]:
    """Friction parameters of the drive, from stated numbers and those of the catalogue.

    Empty for a fixed wave generator. Raises ValueError for stated numbers that contradict each other.
    """
    stated = [name for name in QUOTED if given[name] is not None]
    if "efficiency" in stated and not printed["efficiency"].value < 1.0:
        raise ValueError(f"--efficiency = {given['efficiency']!r} is outside (0, 1)")
    if given["fixed"] == "wave-generator":
        if stated:
            raise ValueError(
                f"{flag(stated[0])} is of the wave generator, which stands with --fixed wave-generator"
            )
        return {}
    if "starting_torque" not in printed and stated:
        raise ValueError(f"{flag(stated[0])} needs {flag('starting_torque')}: without it no friction acts")
    if "starting_torque" in stated:  # scaled numbers belong to another starting torque; others must be met
        printed = {n: p for n, p in printed.items() if n not in QUOTED or p.kind != "estimate"}
        stated = [name for name in QUOTED if name in printed]
    return _with_drag(friction(printed, stated), given["motor_drag"])


def _with_drag(brakes: dict[str, Printed], stated: str | None) -> dict[str, Printed]:
    """Add the dry friction of the motor's bearings and seals to friction_coulomb.

    drag_text : as the user states it; None: no motor drag
    """
    if stated is None:
        return brakes
    drag = number("motor_drag", stated, "N.m", "N.m", None)
    if drag < 0.0:
        raise ValueError(f"--motor-drag = {stated!r} is outside [0, inf) N.m")
    text = f"motor drag {drag:g} N.m, stated"
    dry_friction = brakes.get("friction_coulomb")
    if dry_friction is None:
        return {**brakes, "friction_coulomb": Printed(drag, "user", text)}
    source, interval = dry_friction.source, dry_friction.interval
    if interval is not None:
        interval = interval[0] + drag, interval[1] + drag
        source = f"{source.rpartition('; ')[0]}; {interval_text(interval)}"
    total = Printed(dry_friction.value + drag, dry_friction.kind, f"{source}; with {text}", interval=interval)
    return {**brakes, "friction_coulomb": total}


def _stated(given: Given, value: float) -> Printed:
    """Number that the user states, with its source: a catalogue row, or a replacement for a named drive."""
    kind = "user" if given["catalogue"] and not given["source"] else "catalogue"
    return Printed(value, kind, given["source"] or "stated")


def _unit(given: Given, name: str) -> str:
    """Unit of a stated number without a unit."""
    return given["stiffness_unit"] or _UNITS[name] if name.startswith("K") else _UNITS[name]


def _of_lines(printed: dict[str, Printed], brakes: Mapping[str, Printed], name: str) -> NewJoint:
    """Make a drive with the three lines of the catalogue as stiffness (law `catalogue`)."""
    from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

    from .efficiency import LOST_MOTION, lost_motion
    from .fit import catalogue

    _row(printed)  # raises ValueError for an implausible row
    rated, peak = printed["rated_torque"].value, printed.pop("peak_torque", None)
    if peak is None:
        peak = Printed(PEAK * rated, "estimate", f"{PEAK:g} times rated_torque")
    printed["max_torque"] = peak
    facts = {}
    if "hysteresis_loss" in printed and printed["hysteresis_loss"].bound:
        bound = printed["hysteresis_loss"]
        text = f"{_short(bound)}; off unless --hysteresis is stated"
        facts["hysteresis_bound"] = (bound.value, "rad", text)
        printed["hysteresis_loss"] = Printed(0.0, "user", f"default choice: none; {bound.source}")
    printed_angle = printed.pop("lost_motion", None)
    text = f"not published; {DAMPING:g} s times K1, 2 % of critical at 60 Hz"
    printed["d"] = Printed(DAMPING * printed["K1"].value, "estimate", text)
    printed |= brakes
    file = catalogue.made(name, printed)
    spring = HarmonicDriveSpring.of(file.values)
    angle = float(spring.curve.inverse(rated))
    facts["wind_up"] = (angle, "rad", f"at the rated torque {rated:g} N.m, of the midline")
    text = f"of this drive, midway in its loop between +-{LOST_MOTION:g} times the rated torque"
    computed_angle = lost_motion(spring)
    if printed_angle:
        relation = "below" if computed_angle < printed_angle.value else "above"
        text += f"; {relation} {printed_angle.value:.4g} rad: {_short(printed_angle)}"
    facts["lost_motion"] = (computed_angle, "rad", text)
    if brakes:
        facts["efficiency"] = (efficiency(file.values), "1", "at rated torque and 2000 rev/min")
    kinds = {name: number.kind for name, number in printed.items() if name in file.flat}
    guessed = ", ".join(sorted(name for name, kind in kinds.items() if kind == "estimate"))
    notes = [f"estimates, not of the catalogue's row: {guessed}"]
    if file.values.corner == 0.0:
        notes.append(
            "corner = 0: the torque has kinks at T1 and T2, where the stiffness jumps without an event"
        )
    return NewJoint(file, facts, notes)


def _of_pair(printed: Mapping[str, Printed], brakes: Mapping[str, Printed], name: str) -> NewJoint:
    """Make a drive with the law of Hu 2023, fitted to the row."""
    from .fit import catalogue

    kind, ratio = printed["rated_torque"].kind, printed["ratio"].value
    row = _row(printed)
    found = catalogue.fit_pair(row, printed=catalogue.stated_numbers(row, kind, ratio, name), source=name)
    file = replace(found.parameters, name=name)
    loss = printed.get("hysteresis_loss")
    if loss is not None and loss.kind != "estimate":
        brakes = {"hysteresis_loss": loss, **brakes}
    for label, stated in brakes.items():
        file = file.with_values({label: stated.value}, stated.kind, stated.source)
    return NewJoint(file, found.facts, found.warnings())


def _short(number: Printed) -> str:
    """Source of a number without the part in brackets."""
    return number.source.split(" (", 1)[0]


def _row(printed: Mapping[str, Printed]) -> "Row":
    """Catalogue row of the numbers. Raises ValueError for an implausible row."""
    from .fit.drive import Row

    return Row(**{name: printed[name].value for name in LINES}, rated=printed["rated_torque"].value)


NEW = Drawing(
    text="a harmonic drive by its name in the catalogue, or from the numbers of a catalogue row",
    example="--catalogue CSG-17-100",
    options=(
        Option("catalogue", "name of the drive, see jointfmu catalogue", "NAME"),
        Option("ratio", "speed ratio as in catalogues [1], above 0; negative: used with its sign", "R"),
        Option(
            "fixed",
            "part that is fixed; it decides the sign of the ratio (circular-spline: negative)",
            choices=tuple(FIXED),
        ),
        *(Option(column.name, f"{column.text} [{column.unit}]", column.name[0]) for column in ROW),
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
        Option(
            "starting_torque",
            "starting torque at the wave generator without load [N.m] (default: of a named drive published "
            "or scaled, else none)",
            "T",
        ),
        Option(
            "running_torque",
            "torque at the wave generator without load, at 2000 rev/min [N.m] (default: as starting torque)",
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
        Option("source", "where the row is published", "TEXT"),
        Option(
            "corner",
            "half-width of the smooth corners at T1 and T2 over their wind-up [1], 0: sharp (default: 0.04)",
            "C",
        ),
        Option(
            "law",
            "catalogue: the three lines (default); hu2023: law of the contact pair, fitted to the lines",
            choices=("catalogue", "hu2023"),
        ),
    ),
    run=_drive,
)
