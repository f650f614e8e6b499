"""Fit procedures of the harmonic drive: torque-angle curve, loops, logs of a robot, row of a catalogue."""

from ....common.options import Option
from ....inputs.fitting.procedure import Procedure, make_lazy_fit
from ..catalogue import STIFFNESS_COLUMNS

FIT_PROCEDURES = (
    Procedure(
        name="torque-angle",
        description="the harmonic drive to a torque-angle curve",
        takes_file=True,
        options=(
            Option(
                "rated_torque",
                "rated torque of the drive [N.m]; max_torque is scaled with it",
                default_unit="N.m",
            ),
            Option(
                "law",
                "table: use the midline itself (default: fit the law of the start file)",
                choices=("table",),
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.torque_angle"),
    ),
    Procedure(
        name="loop",
        description="the hysteresis of the harmonic drive to loops, decays or responses",
        takes_file=True,
        identifying_column="angle",
        options=(
            Option(
                "inertia",
                "moment of inertia that vibrates on the drive [kg.m2], for decays and responses",
                is_number=True,
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.hysteresis"),
    ),
    Procedure(
        name="log",
        description="the friction of the harmonic drive to logs of a robot",
        takes_file=True,
        takes_several_files=True,
        options=(
            Option(
                "columns",
                "other headings of time, q, dq, i, tau, gravity, q_motor, link_torque, temperature in the "
                "file: q=HEADING or 'q=HEADING [UNIT]'",
                "TEXT",
                is_list=True,
            ),
            Option("torque_constant", "motor torque over motor current [N.m/A]", is_number=True),
            Option(
                "torque_at",
                "place of the torque in column tau: joint for a torque sensor, or a controller that states "
                "torques at the joint",
                default="motor",
                choices=("motor", "joint"),
            ),
            Option("drive", "name of the drive in the catalogue, instead of --params", "NAME"),
            Option(
                "rated_torque",
                "rated torque of the drive [N.m], with --ratio, instead of --params",
                default_unit="N.m",
            ),
            Option("ratio", "speed ratio (default: that of the drive)", is_number=True),
            Option(
                "motor_inertia",
                "moment of inertia of the rotor [kg.m2]; its torque does not pass through the teeth",
                is_number=True,
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.log"),
    ),
    Procedure(
        name="catalogue",
        description="the harmonic drive to a catalogue row",
        takes_file=False,
        options=(
            *(
                Option(
                    column.name,
                    f"{column.meaning} [{column.unit}]",
                    is_required=True,
                    default_unit=column.unit,
                    unit_option="stiffness_unit" if column.name.startswith("K") else "",
                )
                for column in STIFFNESS_COLUMNS
            ),
            Option(
                "stiffness_unit",
                "unit of K1, K2, K3 given without one, as '1e4 N.m/rad' or kgf.m/arcmin (default: N.m/rad)",
                "TEXT",
            ),
            Option("rated_torque", "rated torque [N.m] (default: T2)", default_unit="N.m"),
            Option("source", "where the row is published", "TEXT", default="catalogue"),
            Option("ratio", "speed ratio (default: that of the start file)", is_number=True),
            Option(
                "law",
                "catalogue: the three lines; hu2023: law of the contact pair, fitted to the lines",
                default="catalogue",
                choices=("catalogue", "hu2023"),
            ),
        ),
        run_fit=make_lazy_fit(f"{__name__}.catalogue"),
    ),
)
"""Fit procedures of the harmonic drive."""
