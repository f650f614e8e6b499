"""What fits the harmonic drive: a measured torque-angle curve, its loops, a catalogue row."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ....fitting.procedure import Option, Procedure
from ....parameters import ParameterFile

if TYPE_CHECKING:
    from ....fitting.outcome import Outcome

Names = Sequence[str] | None


def _torque_angle(
    path: Path, start: ParameterFile | None, free: Names, rated_torque: float | None
) -> "Outcome":
    from . import torque_angle

    return torque_angle.fit(path, start, free, rated_torque)


def _loop(path: Path, start: ParameterFile | None, free: Names, inertia: float | None) -> "Outcome":
    from . import hysteresis

    return hysteresis.fit(path, start, free, inertia)


def _catalogue(
    start: ParameterFile | None,
    free: Names,
    rated_torque: float | None,
    source: str,
    ratio: float | None,
    **row: float,
) -> "Outcome":
    from . import catalogue

    rated, origin = (row["T2"], "estimate") if rated_torque is None else (rated_torque, "catalogue")
    return catalogue.fit(catalogue.Row(**row, rated=rated), start, free, origin, ratio, source)


FITS = (
    Procedure(
        name="torque-angle",
        text="a torque-angle curve to the harmonic drive",
        file=True,
        options=(Option(name="rated_torque", text="of the drive [N.m]; scales max_torque with it"),),
        run=_torque_angle,
    ),
    Procedure(
        name="loop",
        text="loops, decays or responses to the hysteresis of the harmonic drive",
        file=True,
        column="angle",
        options=(
            Option(name="inertia", text="what vibrates on the drive [kg.m2]; with decays and responses"),
        ),
        run=_loop,
    ),
    Procedure(
        name="catalogue",
        text="a catalogue row to the harmonic drive",
        file=False,
        options=(
            Option(name="K1", text="stiffness below T1 [N.m/rad]", required=True),
            Option(name="K2", text="stiffness between T1 and T2 [N.m/rad]", required=True),
            Option(name="K3", text="stiffness above T2 [N.m/rad]", required=True),
            Option(name="T1", text="torque at the first corner [N.m]", required=True),
            Option(name="T2", text="torque at the second corner [N.m]", required=True),
            Option(name="rated_torque", text="rated torque [N.m] (default: T2)"),
            Option(name="source", text="where the row is printed", word=True, default="catalogue"),
            Option(name="ratio", text="speed ratio (default: that of the start)"),
        ),
        run=_catalogue,
    ),
)
