"""What stands in a bolted joint beside its interface: members and bolts, printed side by side with it."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from jointfmu.parameters import ParameterFile

from . import ATTACHED
from .computed import Array, Plates, whole_joint

if TYPE_CHECKING:
    from ....fem.whole_joint import Compliance

Facts = dict[str, tuple[float, str, str]]


class WholeFacts(NamedTuple):
    """Parameters of a joint, what is told of the whole, and warnings."""

    file: ParameterFile
    facts: Facts
    warnings: list[str]


_TURNS = ("rx", "ry", "rz")


def facts(file: ParameterFile, plates: Plates, attached: str, sides: str | None) -> WholeFacts:
    """The whole joint beside the interface, and the parameters with elastic sides; or a line that says why it
    cannot be computed.

    sides : rigid or elastic as stated; None: elastic if the packages are there

    Raises ValueError if it was asked for and cannot be computed.
    """
    try:
        found = whole_joint(file, plates, attached)
    except ValueError as error:
        if sides == "elastic":
            raise
        return WholeFacts(
            file, {}, [f"members and bolts are not computed, the FMU is the interface alone: {error}"]
        )
    parts = found.compliances
    rows = {f"whole_K_{named(name)}": _row(one, name, attached) for name, one in parts.items()}
    rows |= _load(parts["z"], plates.tension, attached) | _share(parts, sides == "rigid")
    return WholeFacts(file if sides == "rigid" else found.file, rows, [])


def named(direction: str) -> str:
    """A direction as stiffnesses are called: zz, rx."""
    return direction if direction in _TURNS else 2 * direction


def _row(one: "Compliance", direction: str, attached: str) -> tuple[float, str, str]:
    unit = "N.m/rad" if direction in _TURNS else "N/m"
    parts = ((one.interface, "interface"), (one.members, "members"), (one.bolts, "bolts"))
    shares = ", ".join(f"{part / one.whole:.0%} {name}" for part, name in parts)
    text = f"of the whole joint between {ATTACHED[attached]}; of its energy {shares}"
    return 1.0 / one.whole, unit, f"{text}; the interface alone is {one.whole / one.rigid:.3g} times as stiff"


def _share(found: "Mapping[str, Compliance]", alone: bool) -> Facts:
    """Whether the interface matters for the whole; `alone`: it is all that the FMU has."""
    along, *rest = (found[name].interface / found[name].whole for name in ("z", "x", "y", *_TURNS))
    text = f"part of the interface in the whole's compliance along z, at most {max(rest):.3g} in others; " + (
        "the FMU is the interface alone (--sides rigid)"
        if alone
        else "the FMU is the whole (sides = elastic)"
    )
    return {"interface_share": (along, "1", text)}


def opening_load(preload: float, bolt_force: Array) -> float:
    """Force [N] along z that takes all pressure of a preload [N] from the interface, linearly; bolt_force
    (bolts) [N per N] what each bolt gets of it."""
    return preload / (1.0 / len(bolt_force) - float(bolt_force.mean()))


def _load(one: "Compliance", preload: float, attached: str) -> Facts:
    """What an outer force along the axis does, without an eccentric one's bending."""
    most, force = one.bolt_force.max(), opening_load(preload, one.bolt_force)
    where = f"a force along z at {ATTACHED[attached]}"
    return {
        "whole_load_factor": (
            float(one.bolt_force.sum()),
            "1",
            f"n Phi_K: part that the bolts take of {where}",
        ),
        "whole_bolt_share": (float(most), "1", f"part that one bolt takes at most of {where}"),
        "opening_load": (force, "N", f"{where} that takes all pressure from the interface, linear"),
    }
