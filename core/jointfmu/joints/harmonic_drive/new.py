"""A harmonic drive from its catalogue row."""

from collections.abc import Mapping

from ...drawing.part import Drawing, Given, NewJoint, Option
from ...drawing.reading import number

_UNITS: Mapping[str, str] = {"K1": "N.m/rad", "K2": "N.m/rad", "K3": "N.m/rad", "T1": "N.m", "T2": "N.m"}


def _drive(given: Given) -> NewJoint:
    from dataclasses import replace

    from .fit import catalogue

    row = {name: number(name, given[name], unit, unit) for name, unit in _UNITS.items()}
    rated, kind = row["T2"], "estimate"
    if given["rated_torque"] is not None:
        rated, kind = number("rated_torque", given["rated_torque"], "N.m", "N.m"), "catalogue"
    ratio = number("ratio", given["ratio"], "1", "1")
    source = given["source"] or "catalogue"
    found = catalogue.fit(catalogue.Row(**row, rated=rated), None, None, kind, ratio, source)
    file = replace(found.parameters, name=source)
    return NewJoint(file, found.facts, found.warnings())


NEW = Drawing(
    text="a harmonic drive by the row of its catalogue",
    example="--ratio 100 --K1 4700 --K2 6100 --K3 7100 --T1 2 --T2 6.9 --rated-torque 7.8",
    options=(
        Option(name="ratio", text="speed ratio [1]", metavar="R", required=True),
        Option(name="K1", text="stiffness below T1 [N.m/rad]", metavar="K", required=True),
        Option(name="K2", text="stiffness between T1 and T2 [N.m/rad]", metavar="K", required=True),
        Option(name="K3", text="stiffness above T2 [N.m/rad]", metavar="K", required=True),
        Option(name="T1", text="torque at the first corner [N.m]", metavar="T", required=True),
        Option(name="T2", text="torque at the second corner [N.m]", metavar="T", required=True),
        Option(name="rated_torque", text="rated torque [N.m] (default: T2)", metavar="T"),
        Option(name="source", text="where the row is printed", metavar="TEXT"),
    ),
    run=_drive,
)
