"""A catalogue's torsional stiffness as it stands: the law of the three lines.

Nothing is fitted. Beside it the law of the contact pair is fitted to the same row (`catalogue.fit`), and what
it makes of the lines is told.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.given import CORNER, CatalogueDrive
from jointfmu.parameters import ParameterFile, default
from jointfmu.quantity import build, flat_fields

from ....catalogue import Printed
from ....fitting.least_squares import Solution
from ....fitting.outcome import FitResult
from . import catalogue
from . import drive as own
from .row import Row
from .row_pictures import angle_picture, stiffness, stiffness_picture

PAIR = "law of the contact pair"
_NOTHING = Solution((), {}, np.zeros(0), 1.0, np.zeros((0, 0)), np.zeros((0, 0)), (), None)
"""No unknowns."""


def made(name: str, printed: Mapping[str, Printed], start: ParameterFile | None = None) -> ParameterFile:
    """The parameters of a catalogue drive.

    printed : {parameter: number}; what is not there is that of `start`, where it has it
    start   : of a drive with any law; None: the default

    Raises ValueError for a number outside its interval.
    """
    file = start or default("harmonic_drive")
    shared = [label for label, _ in flat_fields(Drive) if label in file.flat]
    if isinstance(file.values, CatalogueDrive):
        shared.append("corner")
    values = {label: file.flat[label] for label in shared} | {k: p.value for k, p in printed.items()}
    origins = {k: v for k, v in file.origins.items() if k in shared} | {k: p.kind for k, p in printed.items()}
    sources = {k: v for k, v in file.sources.items() if k in shared}
    sources |= {k: p.source for k, p in printed.items()}
    if "corner" not in values:
        values["corner"], origins["corner"] = CORNER, "user"
        sources["corner"] = "default choice: the angle at the corners of catalogue drives within 0.4 %"
    return ParameterFile("harmonic_drive", name, build(CatalogueDrive, values), origins, sources)


def fit(
    row: Row,
    start: ParameterFile | None = None,
    free: Sequence[str] | None = None,
    rated_kind: str = "catalogue",
    ratio: float | None = None,
    source: str = "catalogue",
) -> FitResult:
    """The law of a row's lines; arguments as those of `catalogue.fit`, but that nothing is free.

    Raises ValueError for a name to fit and for numbers outside their intervals.
    """
    if free:
        raise ValueError("the law catalogue has nothing to fit; --free is allowed with --law hu2023")
    origin = f"{source} ({row})"
    rated = origin if rated_kind == "catalogue" else "no rated torque given; T2 of the catalogue"
    most = catalogue.MAX_OVER_RATED * row.rated
    printed = {
        name: Printed(getattr(row, name), "catalogue", origin) for name in ("K1", "K2", "K3", "T1", "T2")
    }
    printed["rated_torque"] = Printed(row.rated, rated_kind, rated)
    printed["max_torque"] = Printed(most, "estimate", f"{catalogue.MAX_OVER_RATED:g} times rated_torque")
    if ratio is not None:
        printed["ratio"] = Printed(ratio, "catalogue", origin)
    file = made(source, printed, start)
    pair, note = _pair(row, start if start and start.law == "hu2023" else None)
    facts = _facts(row, file.values, most)
    also = {}
    if pair is not None:
        also = {PAIR: pair}
        facts |= _pair_facts(row, pair, most)
    torque = catalogue.torques(row, most)
    return FitResult(
        file,
        _NOTHING,
        facts,
        angle_picture(row, file.values, also, torque),
        notes=note,
        second_picture=stiffness_picture(row, file.values, also, most),
    )


def _pair(row: Row, start: ParameterFile | None) -> tuple[Drive | None, list[str]]:
    """The law of the contact pair that keeps the row's angles; None and why if none does."""
    try:
        drive: Drive = catalogue.fit(row, start).parameters.values
    except RuntimeError as error:
        return None, [f"the {PAIR} cannot be told beside it: {error}"]
    return drive, []


def _facts(row: Row, drive: CatalogueDrive, most: float) -> dict[str, tuple[float, str, str]]:
    """How far the law's angle is from the lines."""
    facts = {}
    for name, T in (("T1", row.T1), ("T2", row.T2), ("rated", row.rated), ("max", most)):
        miss = float(own.windup(drive, np.array(T)) / row.angle(T)) - 1.0
        facts[f"angle_error_{name}"] = (miss, "1", f"law over catalogue - 1 at {T:g} N.m")
    text = f"{catalogue.MAX_OVER_RATED:g} times the rated torque {row.rated:g} N.m"
    return facts | {"max_torque": (most, "N.m", text)}


def _pair_facts(row: Row, pair: Drive, most: float) -> dict[str, tuple[float, str, str]]:
    """What the law of the contact pair, which is smooth, makes of the lines."""
    torque = np.linspace(0.0, most, 401)[1:]
    angle = own.windup(pair, torque) / row.angle(torque) - 1.0
    i = int(np.argmax(np.abs(angle)))
    text = f"{PAIR} over catalogue - 1"
    facts = {"pair_angle_error": (float(angle[i]), "1", f"{text} at {torque[i]:.3g} N.m, the largest")}
    for name, T in (("zero", 0.0), ("rated", row.rated), ("max", most)):
        K, step = float(stiffness(pair, np.array(T))), float(row.stiffness(T))
        facts[f"pair_stiffness_{name}"] = (
            K / step - 1.0,
            "1",
            f"{text} at {T:g} N.m: {K:.5g} for {step:g} N.m/rad",
        )
    return facts
