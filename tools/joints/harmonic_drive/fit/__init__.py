"""Fit procedures of the harmonic drive: torque-angle curve, loops, logs of a robot, row of a catalogue."""

from ....fitting.procedure import Procedure, fit_of
from ....joint_parts import Option
from ..catalogue import ROW

FITS = (
    Procedure(
        name="torque-angle",
        text="a torque-angle curve to the harmonic drive",
        file=True,
        options=(
            Option(
                "rated_torque", "rated torque of the drive [N.m]; max_torque is scaled with it", unit="N.m"
            ),
            Option(
                "law",
                "table: use the midline itself (default: fit the law of the start file)",
                choices=("table",),
            ),
        ),
        run=fit_of(f"{__name__}.torque_angle"),
    ),
    Procedure(
        name="loop",
        text="loops, decays or responses to the hysteresis of the harmonic drive",
        file=True,
        column="angle",
        options=(
            Option(
                "inertia", "inertia that vibrates on the drive [kg.m2], for decays and responses", number=True
            ),
        ),
        run=fit_of(f"{__name__}.hysteresis"),
    ),
    Procedure(
        name="log",
        text="a robot's logs to the friction of the harmonic drive",
        file=True,
        many=True,
        options=(
            Option(
                "columns",
                "other headings of time, q, dq, i, tau, gravity, q_motor, link_torque, temperature in the "
                "file: q=HEADING or 'q=HEADING [UNIT]'",
                "TEXT",
                many=True,
            ),
            Option("torque_constant", "motor torque over motor current [N.m/A]", number=True),
            Option("ratio", "speed ratio (default: that of the start file)", number=True),
            Option(
                "motor_inertia", "inertia of the rotor [kg.m2], which does not load the teeth", number=True
            ),
        ),
        run=fit_of(f"{__name__}.log"),
    ),
    Procedure(
        name="catalogue",
        text="a catalogue row to the harmonic drive",
        file=False,
        options=(
            *(
                Option(
                    column.name,
                    f"{column.text} [{column.unit}]",
                    required=True,
                    unit=column.unit,
                    unit_by="stiffness_unit" if column.name.startswith("K") else "",
                )
                for column in ROW
            ),
            Option(
                "stiffness_unit",
                "unit of K1, K2, K3 given without one, as '1e4 N.m/rad' or kgf.m/arcmin (default: N.m/rad)",
                "TEXT",
            ),
            Option("rated_torque", "rated torque [N.m] (default: T2)", unit="N.m"),
            Option("source", "where the row is published", "TEXT", default="catalogue"),
            Option("ratio", "speed ratio (default: that of the start file)", number=True),
            Option(
                "law",
                "catalogue: the three lines; hu2023: law of the contact pair, fitted to the lines",
                default="catalogue",
                choices=("catalogue", "hu2023"),
            ),
        ),
        run=fit_of(f"{__name__}.catalogue"),
    ),
)
