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
            Option("rated_torque", "of the drive [N.m]; scales max_torque with it", unit="N.m"),
            Option(
                "law",
                "table: the mid-line itself (default: the law of the start, fitted)",
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
            Option("inertia", "what vibrates on the drive [kg.m2]; with decays and responses", number=True),
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
                "headings of time, q, dq, i, tau, gravity, temperature with other names: q=HEADING "
                "or 'q=HEADING [UNIT]'",
                "TEXT",
                many=True,
            ),
            Option("torque_constant", "torque of the motor over its current [N.m/A]", number=True),
            Option("ratio", "speed ratio (default: that of the start)", number=True),
            Option("motor_inertia", "of the rotor [kg.m2], which the teeth do not carry (0)", number=True),
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
                "of K1, K2, K3 without one of their own, as '1e4 N.m/rad' or kgf.m/arcmin (N.m/rad)",
                "TEXT",
            ),
            Option("rated_torque", "rated torque [N.m] (default: T2)", unit="N.m"),
            Option("source", "where the row is printed", "TEXT", default="catalogue"),
            Option("ratio", "speed ratio (default: that of the start)", number=True),
            Option(
                "law",
                "catalogue: the three lines; hu2023: that of the contact pair, fitted to them",
                default="catalogue",
                choices=("catalogue", "hu2023"),
            ),
        ),
        run=fit_of(f"{__name__}.catalogue"),
    ),
)
