"""What fits the bolted joint: a curve over preload."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ....fitting.procedure import Option, Procedure
from ....parameters import ParameterFile

if TYPE_CHECKING:
    from ....fitting.outcome import Outcome


def _preload(
    path: Path,
    start: ParameterFile | None,
    free: Sequence[str] | None,
    direction: str,
    modal_mass: float | None,
    series_stiffness: float | None,
) -> "Outcome":
    from . import preload

    return preload.fit(path, start, free, direction=direction, modal_mass=modal_mass, series=series_stiffness)


FITS = (
    Procedure(
        name="preload",
        text="stiffness or frequency over preload to the bolted joint",
        file=True,
        options=(
            Option(
                name="direction",
                text="of the motion",
                word=True,
                default="normal",
                choices=("normal", "tangential"),
            ),
            Option(name="modal_mass", text="what vibrates on the joint [kg]"),
            Option(
                name="series_stiffness",
                text="of the structure, in series with the joint [N/m]; to fit it, free series_stiffness",
            ),
        ),
        run=_preload,
    ),
)
