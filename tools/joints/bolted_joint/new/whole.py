"""What stands in a bolted joint beside its interface: members and bolts, printed side by side with it."""

from typing import NamedTuple

from jointfmu.joints.bolted_joint.compliances import PARTS, Compliances
from jointfmu.parameters import ParameterFile

from . import ATTACHED
from .computed import Plates, whole_joint

Facts = dict[str, tuple[float, str, str]]


class WholeFacts(NamedTuple):
    """Parameters of a joint, what is told of the whole, and warnings."""

    file: ParameterFile
    facts: Facts
    warnings: list[str]


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
    rows = _stiffnesses(parts, attached) | _load(parts, plates.tension, attached)
    rows |= _share(parts, sides == "rigid")
    return WholeFacts(file if sides == "rigid" else found.file, rows, [])


def _stiffnesses(found: Compliances, attached: str) -> Facts:
    """Of the whole joint, then of its members, in all directions."""
    rows, members = {}, {}
    for name, unit, (whole, interface, alone, _), parts in found.rows():
        shares = ", ".join(f"{share:.0%} {part}" for share, part in zip(parts, PARTS, strict=True))
        rows[f"whole_{name}"] = (
            whole,
            unit,
            f"of the whole joint between {ATTACHED[attached]}; of its energy {shares}; the interface alone "
            f"is {interface / whole:.3g} times as stiff",
        )
        members[f"members_{name}"] = (alone, unit, "of its members, as a spring in series with the rest")
    return rows | members


def _share(found: Compliances, alone: bool) -> Facts:
    """Whether the interface matters for the whole; `alone`: it is all that the FMU has."""
    share = found.shares[0]
    rest = max(part for i, part in enumerate(share) if i != 2)
    text = f"part of the interface in the whole's compliance along z, at most {rest:.3g} in others; " + (
        "the FMU is the interface alone (--sides rigid)"
        if alone
        else "the FMU is the whole (sides = elastic)"
    )
    return {"interface_share": (float(share[2]), "1", text)}


def _load(found: Compliances, tension: float, attached: str) -> Facts:
    """What an outer force along the axis does, without an eccentric one's bending."""
    where = f"a force along z at {ATTACHED[attached]}"
    opens = found.opening_load(tension)
    return {
        "whole_load_factor": (found.load_factor, "1", f"n Phi_K: part that the bolts take of {where}"),
        "whole_bolt_share": (
            float(found.bolt_force[:, 2].max()),
            "1",
            f"part that one bolt takes at most of {where}",
        ),
        "opening_load": (opens, "N", f"{where} that takes all pressure from the interface, linear"),
    }
