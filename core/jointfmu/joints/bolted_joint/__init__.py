"""Bolted joint: an interface under the uneven pressure of its bolts (Zhao 2018)."""

from ...asperity.zhao2018 import Zhao2018
from ..kind import Kind, RoughSurface
from .law import BoltedJoint
from .variables import MODELS

KIND = Kind(
    name="bolted_joint",
    package=__name__,
    default="box_specimen",
    parameters=BoltedJoint,
    law=Zhao2018,
    models=MODELS,
    surfaces=(RoughSurface("surface"),),
    working_point=("preload", "moment"),
    papers=("zhao2018",),
)
