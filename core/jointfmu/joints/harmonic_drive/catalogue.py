"""Harmonic drives of the maker's catalogues: models/reference/harmonic_drive_catalogue_*.csv.

A row of stiffness holds for the series that it names, and from ratio 80 on for all ratios. Torques are
printed for some series and ratios; where a series lacks them, those of the same size and ratio in another
one are an estimate.
"""

import csv
import re
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from typing import TypeAlias

from ...units import factor
from ..catalogue import Catalogue, Column, Item, Printed

COLUMNS = (
    Column("ratio", "1", "speed ratio", "1"),
    Column("K1", "N.m/rad", "stiffness below T1", "N.m/rad"),
    Column("K2", "N.m/rad", "stiffness between T1 and T2", "N.m/rad"),
    Column("K3", "N.m/rad", "stiffness above T2", "N.m/rad"),
    Column("T1", "N.m", "torque at the first corner", "N.m"),
    Column("T2", "N.m", "torque at the second corner", "N.m"),
    Column("rated_torque", "N.m", "rated torque", "N.m"),
    Column("peak_torque", "N.m", "repeated peak torque", "N.m"),
    Column("hysteresis_loss", "rad", "angle between the branches at zero torque", "arcmin"),
)
RATIOS = ("80", "100", "120", "160")
"""What a row for ratio 80 and more stands for, where any series has a torque at that size."""
STRONG = ("CSG", "SHG")
"""Series of higher torque, by STRONGER."""
STRONGER = 1.3
"""Torque of a CSG over that of a CSF of the same size and ratio [1]."""
ALIKE = ("CSG", "SHG", "HFUC", "HFUS")
"""Series with torques, in the order in which others take them from."""
BOUNDS = ((30.0, 3.0), (50.0, 2.0), (80.0, 1.0))
"""Least ratio [1] and hysteresis loss [arcmin] that catalogues give as a bound."""
Torques: TypeAlias = Mapping[tuple[str, str, str], Mapping[str, str]]
"""{(series, size, ratio): row}."""
_NAMES = 3
"""Nearest names that a refusal tells."""


def find(name: str) -> Item:
    """A drive by its name, SERIES-SIZE-RATIO, whatever its case and signs; what follows is passed over.

    Raises ValueError with the nearest names if there is none.
    """
    known = {_key(item.name): item for item in items()}
    wanted = _key(name)
    begun = [item for key, item in known.items() if wanted == key or wanted.startswith(f"{key}-")]
    if begun:
        return max(begun, key=lambda item: len(item.name))
    near = get_close_matches(wanted, known, _NAMES, 0.0)
    raise ValueError(
        f"catalogue {name!r} is unknown; nearest are {', '.join(known[key].name for key in near)} "
        "(jointfmu catalogue)"
    )


@cache
def items() -> tuple[Item, ...]:
    """All drives with a row of stiffness."""
    torques = _torques()
    return tuple(item for row in _table("stiffness") for item in _of_row(row, torques))


def _of_row(row: Mapping[str, str], torques: Torques) -> Iterator[Item]:
    """The drives for which a row of stiffness holds."""
    group = row["series"].removeprefix("HD ")
    ratios = [row["ratio"]]
    if row["ratio"].endswith("+"):
        ratios = [r for r in RATIOS if any((s, row["size"], r) in torques for s in ALIKE)]
    what = f"{group}, size {row['size']}, ratio {row['ratio']}"
    source = f"{what} of the Harmonic Drive catalogue ({row['source']})"
    printed = {name: row[column] for name, column in _STIFFNESS.items()}
    lines = {name: Printed(float(text), "catalogue", source) for name, text in printed.items() if text}
    if "K3" not in lines:
        lines["K3"] = Printed(lines["K2"].value, "estimate", f"not printed; K2 of {source}")
    for series in group.split("/"):
        own = series if group == series else f"{series}-{row['size']}"
        for ratio in ratios:
            numbers = {
                "ratio": Printed(float(ratio), "catalogue", source),
                **lines,
                **_torque(torques, series, row["size"], ratio),
                "hysteresis_loss": _hysteresis(float(ratio)),
            }
            yield Item(f"{own}-{ratio}", numbers)


_STIFFNESS = {"K1": "K1_Nm_per_rad", "K2": "K2", "K3": "K3", "T1": "T1_Nm", "T2": "T2_Nm"}
"""{column: its heading in the file}."""
_TORQUE = {"rated_torque": "rated_Nm", "peak_torque": "repeated_peak_Nm"}


def _torque(torques: Torques, series: str, size: str, ratio: str) -> dict[str, Printed]:
    """Rated and repeated peak torque of a drive: as printed, else of a series alike; none if none has it."""
    if series.startswith("RSF"):
        return {}
    for other in (series, *ALIKE):
        if row := torques.get((other, size, ratio)):
            name = f"{other}-{size}-{ratio}"
            if other == series:
                kind, part = "catalogue", 1.0
                text = f"{name} of the Harmonic Drive catalogue ({row['source']})"
            elif other in STRONG and series not in STRONG:
                kind, part = "estimate", 1.0 / STRONGER
                text = f"that of {name} over {STRONGER:g}: the catalogue gives the CSG 30 % more than the CSF"
            else:
                kind, text, part = "estimate", f"that of {name}", 1.0
            return {column: Printed(part * float(row[head]), kind, text) for column, head in _TORQUE.items()}
    return {}


def _hysteresis(ratio: float) -> Printed:
    """The bound of catalogues for a ratio."""
    bound = max((b for b in BOUNDS if b[0] <= ratio), default=BOUNDS[0])[1]
    text = f"not of this drive: catalogues state below {bound:g} arcmin at such a ratio"
    return Printed(bound * factor("arcmin", "rad"), "estimate", text)


def _torques() -> Torques:
    return {(row["series"], row["size"], row["ratio"]): row for row in _table("torque")}


def _table(name: str) -> list[dict[str, str]]:
    path = files("jointfmu_models") / "reference" / f"harmonic_drive_catalogue_{name}.csv"
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def _key(name: str) -> str:
    return re.sub(r"[\s_/-]+", "-", name.strip().lower())


CATALOGUE = Catalogue(columns=COLUMNS, items=items)
