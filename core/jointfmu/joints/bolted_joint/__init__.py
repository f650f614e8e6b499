"""Bolted joint: an interface under the uneven pressure of its bolts."""

from ..kind import JointKind, RoughSurface
from .law import (
    BoltedJointParameters,
    RoughBoltedJointParameters,
    TableBoltedJointParameters,
    find_contradictions,
)
from .variables import MODELS

KIND = JointKind(
    name="bolted_joint",
    package=__name__,
    default_file_stem="box_specimen",
    laws={
        "zhao2018": BoltedJointParameters,
        "roughness": RoughBoltedJointParameters,
        "table": TableBoltedJointParameters,
    },
    models=MODELS,
    surfaces=(RoughSurface("surface"),),
    working_point=("preload", "moment", "temperature"),
    find_contradictions=find_contradictions,
)
"""Description of the bolted joint for builders and tools."""
