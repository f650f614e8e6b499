"""Friction of every drive of the catalogue: what is printed of it, and the rest scaled from its relatives."""

import re
from collections.abc import Iterable, Mapping

from ...catalogue import Item, Printed
from .quoted_friction import friction
from .scaling import PrintedFriction, Scaled, scaled


def known(items: Iterable[Item]) -> dict[str, tuple[PrintedFriction, str]]:
    """{drive: what is printed of its friction, and by whom} of those whose starting torque is printed."""
    found = {}
    for item in items:
        printed = {name: number for name, number in item.numbers.items() if number.kind == "catalogue"}
        if "starting_torque" in printed:
            maker = printed["starting_torque"].source.partition(": ")[2].partition(",")[0]
            found[item.name] = _known(item.name, item.numbers["ratio"].value, printed), maker
    return found


def _known(name: str, ratio: float, printed: Mapping[str, Printed]) -> PrintedFriction:
    """The losses are those that `friction` makes of the columns."""
    losses = friction({"ratio": Printed(ratio, "catalogue", ""), **printed})
    running = printed.get("running_torque")
    return PrintedFriction(
        size(name),
        ratio,
        printed["starting_torque"].value,
        running.value if running else None,
        losses["load_loss"].value if "efficiency" in printed else None,
        losses["load_loss_back"].value if "back_driving_torque" in printed else None,
    )


def size(name: str) -> float:
    """Size [1] of a drive SERIES-SIZE-RATIO: the number of 14A too."""
    match = re.search(r"-(\d+)[A-Z]?-\d+$", name)
    assert match, name
    return float(match[1])


def with_friction(item: Item, drives: Mapping[str, tuple[PrintedFriction, str]]) -> Item:
    """The drive with estimates of the friction that is not printed of it.

    drives : as `known` gives them

    The efficiency is left out where no rated torque is known.
    """
    own, ratio = dict(item.numbers), item.numbers["ratio"].value
    law = scaled(size(item.name), ratio, [each for each, _ in drives.values()])
    makers: dict[str, list[str]] = {}
    for name, (_, maker) in drives.items():
        makers.setdefault(maker, []).append(name)
    text = " and ".join(f"{maker} ({', '.join(names)})" for maker, names in makers.items())
    text += ", scaled by size and ratio"

    def estimate(column: str, value: float, *ends: float) -> None:
        """Unless it is printed."""
        interval = min(ends), max(ends)
        own.setdefault(column, Printed(value, "estimate", text, interval=interval))

    estimate("starting_torque", *_three(law.starting))
    start = own["starting_torque"].value
    estimate("running_torque", *(start + x for x in _three(law.rise)))
    estimate("back_driving_torque", *(ratio * start / (1.0 - x) for x in _three(law.load_loss_back)))
    if rated := own.get("rated_torque"):
        idle = 1.0 + own["running_torque"].value * ratio / rated.value
        estimate("efficiency", *(1.0 / (idle + x) for x in _three(law.load_loss)))
    return Item(item.name, own)


def _three(number: Scaled) -> tuple[float, float, float]:
    return number.value, number.low, number.high
