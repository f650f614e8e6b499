"""Fit procedures of the harmonic drive: torque-angle curve, loops, logs of a robot, row of a catalogue."""

from ....common.options import Option
from ....inputs.fitting.procedure import FitProcedure, make_lazy_fit
from ..catalogue import STIFFNESS_COLUMNS

DEFAULT_START_TEXT = "CD-14-100 of Hu 2023"
"""Drive from which a fit starts if the user states none."""

FIT_PROCEDURES = (
    FitProcedure(
        procedure_name="torque-angle",
        procedure_description="the harmonic drive to a torque-angle curve",
        default_start_text=DEFAULT_START_TEXT,
        takes_file=True,
        procedure_options=(
            Option(
                "rated_torque",
                "rated torque of your drive [N.m]: scales the torques of the start file. Needed if the curve "
                "goes beyond max_torque of the start file (default: no scaling)",
                default_unit="N.m",
            ),
            Option(
                "law",
                "table: use the measured midline itself as the curve (default: fit the law of --params)",
                choices=("table",),
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.torque_angle"),
    ),
    FitProcedure(
        procedure_name="loop",
        procedure_description="the hysteresis of the harmonic drive to loops, decays or responses of its "
        "angle",
        default_start_text=f"harmonic drive: {DEFAULT_START_TEXT}",
        takes_file=True,
        identifying_column="angle",
        procedure_options=(
            Option(
                "inertia",
                "moment of inertia that vibrates on a harmonic drive [kg.m2], needed for decays and "
                "responses",
                is_number=True,
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.hysteresis"),
    ),
    FitProcedure(
        procedure_name="log",
        procedure_description="the friction of the harmonic drive to logs of a robot",
        default_start_text="none, state it, or --drive, or --rated-torque with --ratio",
        takes_file=True,
        takes_several_files=True,
        procedure_options=(
            Option(
                "columns",
                "headings of FILE for time, q, dq, i, tau, gravity, q_motor, link_torque, temperature, if "
                "they differ: q=HEADING or 'q=HEADING [UNIT]'",
                "TEXT",
                is_list=True,
            ),
            Option(
                "torque_constant",
                "torque constant of the motor, torque over current in column i [N.m/A]",
                is_number=True,
            ),
            Option(
                "torque_at",
                "place of the torque in column tau: motor, or joint (from a torque sensor, or from a "
                "controller that converts to the joint)",
                default="motor",
                choices=("motor", "joint"),
            ),
            Option("drive", "name of the drive in the catalogue, instead of --params", "NAME"),
            Option(
                "rated_torque",
                "rated torque of the drive [N.m]; with --ratio, instead of --params",
                default_unit="N.m",
            ),
            Option(
                "ratio", "speed ratio of the drive [1] (default: that of --drive or --params)", is_number=True
            ),
            Option(
                "motor_inertia",
                "moment of inertia of the rotor [kg.m2], which does not load the teeth (default: fitted, if "
                "FILE has q_motor or link_torque; otherwise all inertia is that of the arm, and the losses "
                "that grow with the load are too small)",
                is_number=True,
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.log"),
    ),
    FitProcedure(
        procedure_name="catalogue",
        procedure_description="the harmonic drive to the stiffness numbers of a catalogue",
        default_start_text=DEFAULT_START_TEXT,
        takes_file=False,
        procedure_options=(
            *(
                Option(
                    column.column_name,
                    f"{column.column_meaning} [{column.si_unit}]; or with its own unit, as in "
                    f"{'2.9N.m/arcmin' if column.column_name.startswith('K') else '0.4kgf.m'}",
                    is_required=True,
                    default_unit=column.si_unit,
                    unit_option="stiffness_unit" if column.column_name.startswith("K") else "",
                )
                for column in STIFFNESS_COLUMNS
            ),
            Option(
                "stiffness_unit",
                "unit of values of K1, K2, K3 that you state without one: kgf.m/arcmin, or with the factor "
                "of the column heading '1e4 N.m/rad' (default: N.m/rad)",
                "TEXT",
            ),
            Option("rated_torque", "rated torque [N.m] (default: the value of --T2)", default_unit="N.m"),
            Option(
                "source", "publication of the numbers, for the parameter file", "TEXT", default="catalogue"
            ),
            Option("ratio", "speed ratio [1] (default: that of --params)", is_number=True),
            Option(
                "law",
                "catalogue: the three straight lines of the catalogue; hu2023: contact law of the teeth (Hu "
                "2023), fitted to these lines",
                default="catalogue",
                choices=("catalogue", "hu2023"),
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.catalogue"),
    ),
)
"""Fit procedures of the harmonic drive."""
