"""A joint's parameters with the pressure that finite elements found."""

from dataclasses import replace

from jointfmu.parameters import ParameterFile

from ..fields.joint_parameters import with_field
from .bolted_contact import JointSolution

TILT = 1.0 / 3.0
"""Moment of the second field, over the one that unloads a row of bolts [1]: that of Zhao 2018."""


def with_solution(
    file: ParameterFile, solution: JointSolution, preload: float, moment: float = 0.0
) -> ParameterFile:
    """The joint with the field at a preload [N] per bolt, and what a moment adds from a second one.

    solution : at that preload and moment [N.m]; what is missing is solved from there
    """
    joint = solution.joint
    tilting = moment or TILT * joint.assembly.most_moment(preload)
    equal = solution.under(preload).field if moment else solution.field
    tilted = solution.field if moment else solution.under(preload, tilting).field if tilting else None
    source = f"finite elements of the assembly {joint.assembly.name}"
    bolts = joint.assembly.bolts.positions
    file, _ = with_field(file, equal, preload, source, tilted=tilted, moment=tilting or None, bolts=bolts)
    return replace(file, name=f"{file.name}, computed field")
