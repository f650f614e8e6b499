"""The spring in C: an equation."""

from jointfmu_fmu_src.native.part import EQUATIONS as PART

__all__ = ["PART"]
