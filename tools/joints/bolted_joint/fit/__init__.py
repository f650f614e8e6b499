"""Fit procedures of the bolted joint: stiffness over preload, and loops in shear."""

from ....fitting.procedure import DAMPING_RATIO, Procedure, fit_of
from ....joint_parts import Option

SERIES = Option(
    "series_stiffness",
    "stiffness of the structure in series with the joint [N/m]; to fit it: --free series_stiffness",
    number=True,
)


FITS = (
    Procedure(
        name="preload",
        text="stiffness or frequency over preload to the bolted joint",
        file=True,
        options=(
            Option(
                "direction", "direction of the motion", default="normal", choices=("normal", "tangential")
            ),
            Option("modal_mass", "mass that vibrates on the joint [kg]", number=True),
            SERIES,
        ),
        run=fit_of(f"{__name__}.preload"),
    ),
    Procedure(
        name="loop",
        text="loops, decays or responses in shear to the bolted joint",
        file=True,
        column="displacement",
        options=(
            Option("preload", "of each bolt in the test [N] (default: of the start's inputs)", number=True),
            Option(
                "modal_mass", "mass that vibrates on the joint [kg], for decays and responses", number=True
            ),
            DAMPING_RATIO,
            SERIES,
        ),
        run=fit_of(f"{__name__}.loop"),
    ),
)
