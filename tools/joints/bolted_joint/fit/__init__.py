"""Fit procedures of the bolted joint: stiffness over preload, and loops in shear."""

from ....common.options import Option
from ....inputs.fitting.procedure import DAMPING_RATIO_OPTION, Procedure, make_lazy_fit

SERIES_STIFFNESS_OPTION = Option(
    "series_stiffness",
    "stiffness of the structure in series with the joint [N/m]; to fit it: --free series_stiffness",
    is_number=True,
)
"""Option for the stiffness of a structure in series with the joint."""


FIT_PROCEDURES = (
    Procedure(
        name="preload",
        description="the bolted joint to stiffness or frequency over preload",
        takes_file=True,
        options=(
            Option(
                "direction", "direction of the motion", default="normal", choices=("normal", "tangential")
            ),
            Option("modal_mass", "mass that vibrates on the joint [kg]", is_number=True),
            SERIES_STIFFNESS_OPTION,
        ),
        run_fit=make_lazy_fit(f"{__name__}.preload"),
    ),
    Procedure(
        name="loop",
        description="the bolted joint to loops, decays or responses in shear",
        takes_file=True,
        identifying_column="displacement",
        options=(
            Option(
                "preload",
                "preload of each bolt in the test [N] (default: that of the start file)",
                is_number=True,
            ),
            Option(
                "modal_mass", "mass that vibrates on the joint [kg], for decays and responses", is_number=True
            ),
            DAMPING_RATIO_OPTION,
            SERIES_STIFFNESS_OPTION,
        ),
        run_fit=make_lazy_fit(f"{__name__}.loop"),
    ),
)
"""Fit procedures of the bolted joint."""
