"""What fits the bolted joint: a curve over preload, loops in shear."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu.parameters import ParameterFile

from ....fitting.procedure import DAMPING_RATIO, Procedure
from ....joint_parts import Option

if TYPE_CHECKING:
    from ....fitting.outcome import FitResult


def _preload(
    path: Path,
    start: ParameterFile | None,
    free: Sequence[str] | None,
    direction: str,
    modal_mass: float | None,
    series_stiffness: float | None,
) -> "FitResult":
    from . import preload

    return preload.fit(path, start, free, direction=direction, modal_mass=modal_mass, series=series_stiffness)


def _loop(
    path: Path,
    start: ParameterFile | None,
    free: Sequence[str] | None,
    preload: float | None,
    modal_mass: float | None,
    damping_ratio: float,
    series_stiffness: float | None,
) -> "FitResult":
    from . import loop

    return loop.fit(
        path,
        start,
        free,
        preload=preload,
        modal_mass=modal_mass,
        damping_ratio=damping_ratio,
        series_stiffness=series_stiffness,
    )


SERIES = Option(
    "series_stiffness",
    "of the structure, in series with the joint [N/m]; to fit it, free series_stiffness",
    number=True,
)


FITS = (
    Procedure(
        name="preload",
        text="stiffness or frequency over preload to the bolted joint",
        file=True,
        options=(
            Option("direction", "of the motion", default="normal", choices=("normal", "tangential")),
            Option("modal_mass", "what vibrates on the joint [kg]", number=True),
            SERIES,
        ),
        run=_preload,
    ),
    Procedure(
        name="loop",
        text="loops, decays or responses in shear to the bolted joint",
        file=True,
        column="displacement",
        options=(
            Option("preload", "of each bolt in the test [N] (default: of the start's inputs)", number=True),
            Option("modal_mass", "what vibrates on the joint [kg]; with decays and responses", number=True),
            DAMPING_RATIO,
            SERIES,
        ),
        run=_loop,
    ),
)
