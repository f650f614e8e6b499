"""What fits the bolted joint: a curve over preload, loops in shear."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from jointfmu.parameters import ParameterFile

from ....fitting.procedure import DAMPING_RATIO, FitOption, Procedure

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


SERIES = FitOption(
    name="series_stiffness",
    text="of the structure, in series with the joint [N/m]; to fit it, free series_stiffness",
)


FITS = (
    Procedure(
        name="preload",
        text="stiffness or frequency over preload to the bolted joint",
        file=True,
        options=(
            FitOption(
                name="direction",
                text="of the motion",
                word=True,
                default="normal",
                choices=("normal", "tangential"),
            ),
            FitOption(name="modal_mass", text="what vibrates on the joint [kg]"),
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
            FitOption(name="preload", text="of each bolt in the test [N] (default: of the start's inputs)"),
            FitOption(name="modal_mass", text="what vibrates on the joint [kg]; with decays and responses"),
            DAMPING_RATIO,
            SERIES,
        ),
        run=_loop,
    ),
)
