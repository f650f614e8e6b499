"""Bolted joint: an interface under the uneven pressure of its bolts."""

from ..kind import Kind, RoughSurface
from .law import BoltedJoint, RoughBoltedJoint, contradictions
from .variables import MODELS

KIND = Kind(
    name="bolted_joint",
    package=__name__,
    default="box_specimen",
    laws={"zhao2018": BoltedJoint, "roughness": RoughBoltedJoint},
    models=MODELS,
    surfaces=(RoughSurface("surface"),),
    working_point=("preload", "moment"),
    contradictions=contradictions,
)
