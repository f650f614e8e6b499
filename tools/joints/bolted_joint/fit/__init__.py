"""Fit procedures of the bolted joint: stiffness over preload, and loops in shear."""

from ....common.options import Option
from ....inputs.fitting.procedure import DAMPING_RATIO_OPTION, FitProcedure, make_lazy_fit

SERIES_STIFFNESS_OPTION = Option(
    "series_stiffness",
    "stiffness of the structure in series with the joint [N/m]; --free series_stiffness fits it (default: "
    "rigid)",
    is_number=True,
)
"""Option for the stiffness of a structure in series with the joint."""


FIT_PROCEDURES = (
    FitProcedure(
        procedure_name="preload",
        procedure_description="the bolted joint to stiffness or frequency over preload",
        default_start_text="none, state it",
        takes_file=True,
        procedure_options=(
            Option(
                "direction",
                "direction of the measured motion relative to the interface",
                default="normal",
                choices=("normal", "tangential"),
            ),
            Option(
                "modal_mass",
                "mass that vibrates on the joint [kg], for frequencies only (default: mass is fitted instead "
                "of the stiffness)",
                is_number=True,
            ),
            SERIES_STIFFNESS_OPTION,
        ),
        run_fit=make_lazy_fit(f"{__name__}.preload"),
    ),
    FitProcedure(
        procedure_name="loop",
        procedure_description="friction and stiffness of the bolted joint to loops, decays or responses of "
        "its displacement in shear",
        default_start_text="bolted joint: box specimen of Zhao 2018",
        takes_file=True,
        identifying_column="displacement",
        procedure_options=(
            Option(
                "preload",
                "force of each bolt of a bolted joint at tightening [N], from which the embedding of "
                "--params is subtracted (default: preload of --params)",
                is_number=True,
            ),
            Option(
                "modal_mass",
                "mass that vibrates on a bolted joint [kg], needed for decays and responses",
                is_number=True,
            ),
            DAMPING_RATIO_OPTION,
            SERIES_STIFFNESS_OPTION,
        ),
        run_fit=make_lazy_fit(f"{__name__}.loop"),
    ),
)
"""Fit procedures of the bolted joint."""
