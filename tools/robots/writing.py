"""A drive as a file of a robot's simulator."""

from dataclasses import asdict

from ..interface import load
from . import mjcf, urdf
from .transmission import transmission


def written(form: str, source: str, torque: float | None) -> tuple[str, list[str], dict[str, object]]:
    """A drive by its file or name in a format of robots, fitted up to a torque [N.m], rated unless stated.

    Returns the text, what is worth saying about it, and the same as numbers (SI) with the name of the drive.

    Raises ValueError for what is no drive or a torque outside its table, ImportError without mujoco.
    """
    drive = transmission(load(source).file)
    reached = drive.rated_torque if torque is None else torque
    if not 0.0 < reached <= drive.max_torque:
        raise ValueError(
            f"--torque = {reached:g} N.m is outside (0, {drive.max_torque:g}] N.m of {drive.name}"
        )
    text, miss, lacks = WRITERS[form](drive, reached)
    lines = [*(miss.lines(reached) if miss else ()), *(f"not carried: {line}" for line in lacks)]
    measured = asdict(miss) if miss else {}
    return text, lines, {"drive": drive.name, "torque": reached, **measured, "lacks": lacks}


WRITERS = {"mjcf": mjcf.text, "urdf": urdf.text}
"""{format: (drive, torque [N.m]) -> text, what it misses where it has springs, what it lacks}."""
