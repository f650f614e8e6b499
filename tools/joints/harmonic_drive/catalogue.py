"""Catalogue of harmonic drives, read from models/reference/harmonic_drive_catalogue_*.csv.

Stiffness: each row holds for the series that it names; a row for ratio 80 holds for all ratios above, too.
Torques: makers publish them for some series and ratios. For other series the torques of a drive of the same
size and ratio are used as an estimate. Hysteresis and lost motion: makers publish limits of actuators with
the same stiffness. Friction: makers publish starting and back-driving torques of some drives. Those of the
other drives are scaled from them.
"""

import csv
import re
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.resources import files
from typing import TypeAlias

from jointfmu.quantity.units import conversion_factor

from ...common.names import find_similar_names
from ...inputs.catalogue import CatalogueColumn, CatalogueEntry, SourcedNumber
from .friction import add_friction_estimates, collect_published_friction

STIFFNESS_COLUMNS = (
    CatalogueColumn("K1", "N.m/rad", "stiffness below T1", "N.m/rad"),
    CatalogueColumn("K2", "N.m/rad", "stiffness between T1 and T2", "N.m/rad"),
    CatalogueColumn("K3", "N.m/rad", "stiffness above T2", "N.m/rad"),
    CatalogueColumn("T1", "N.m", "torque up to which K1 holds", "N.m"),
    CatalogueColumn("T2", "N.m", "torque up to which K2 holds", "N.m"),
)
"""Columns of the torsional stiffness."""
STIFFNESS_COLUMN_NAMES = tuple(column.column_name for column in STIFFNESS_COLUMNS)
"""Names of the columns of the torsional stiffness."""
CATALOGUE_COLUMNS = (
    CatalogueColumn("ratio", "1", "speed ratio", "1"),
    *STIFFNESS_COLUMNS,
    CatalogueColumn("rated_torque", "N.m", "rated torque", "N.m"),
    CatalogueColumn("peak_torque", "N.m", "repeated peak torque", "N.m"),
    CatalogueColumn("hysteresis_loss", "rad", "angle between the branches at zero torque", "arcmin"),
    CatalogueColumn(
        "lost_motion", "rad", "angle between +4 % and -4 % of rated torque, midway in the loop", "arcmin"
    ),
    CatalogueColumn("starting_torque", "N.m", "at the wave generator, no load", "N.m"),
    CatalogueColumn("running_torque", "N.m", "at the wave generator, no load, 2000 rev/min", "N.m"),
    CatalogueColumn("back_driving_torque", "N.m", "at the output, no motor", "N.m"),
    CatalogueColumn("efficiency", "1", "at rated torque and 2000 rev/min", "1"),
)
"""All columns of the catalogue."""
SPEED_RATIOS_OF_80_AND_MORE = ("80", "100", "120", "160")
"""Ratios of the drives in a row for "ratio 80 and more", if any series has a torque for this size and
ratio."""
ACTUATOR_SERIES = ("CHA", "FHA", "RSF")
"""Series with a built-in motor; their published torques are not torques of the gear alone."""
HIGH_TORQUE_SERIES = ("CSG", "SHG")
"""Series with higher torques than the others, by the factor HIGH_OVER_STANDARD_SERIES_TORQUE."""
MAX_OVER_RATED_TORQUE = 4.0
"""Largest torque of the table (max_torque) over rated torque [1], if no repeated peak torque is known.

Catalogue drives have about this ratio."""
HIGH_OVER_STANDARD_SERIES_TORQUE = 1.3
"""Torque of a CSG drive over torque of a CSF drive of the same size and ratio [1]."""
SERIES_WITH_PUBLISHED_TORQUES = ("CSG", "SHG", "HFUC", "HFUS")
"""Series with published torques, in the order in which they serve as estimates for other series."""
TorqueTable: TypeAlias = Mapping[tuple[str, str, str], Mapping[str, str]]
"""Published torques: {(series, size, ratio): row of the file}."""


def find_drive(drive_name: str) -> CatalogueEntry:
    """Find a drive by its name, SERIES-SIZE-RATIO.

    Case and separators do not matter: csg32100 is CSG-32-100. Further parts of the name are ignored.

    Raises ValueError with similar names if there is no such drive.
    """
    known = {_normalise_name(item.joint_name): item for item in list_drives()}
    wanted = _normalise_name(drive_name)
    matches = [item for key, item in known.items() if wanted == key or wanted.startswith(f"{key}-")]
    if matches:
        return max(matches, key=lambda item: len(item.joint_name))
    joined = [
        item for key, item in known.items() if _remove_name_separators(key) == _remove_name_separators(wanted)
    ]
    if len(joined) == 1:
        return joined[0]
    similar = ", ".join(find_similar_names(drive_name, (item.joint_name for item in list_drives())))
    hint = f"nearest are {similar}" if similar else "allowed are the names of the catalogue"
    raise ValueError(f"catalogue {drive_name!r} is unknown; {hint} (jointfmu catalogue lists all)")


def find_drive_with_ratio(catalogue_entry: CatalogueEntry, wanted_ratio: float) -> CatalogueEntry:
    """Find the catalogue's drive with the series and size of a given drive, and with another speed ratio.

    Raises ValueError with the ratios of the catalogue if there is no such drive.
    """
    siblings = {
        item.known_numbers["ratio"].si_value: item
        for item in list_drives()
        if _name_without_ratio(item) == _name_without_ratio(catalogue_entry)
    }
    if wanted_ratio in siblings:
        return siblings[wanted_ratio]
    raise ValueError(
        f"--ratio = {wanted_ratio:g} is not in the catalogue for "
        f"{_name_without_ratio(catalogue_entry).strip('-')}, allowed are "
        f"{', '.join(f'{known:g}' for known in sorted(siblings))} (jointfmu catalogue); without --catalogue, "
        "state the numbers of the row"
    )


def _name_without_ratio(catalogue_entry: CatalogueEntry) -> str:
    """Catalogue name of a drive without its speed ratio, for example CSG-25 for CSG-25-100."""
    parts, ratio = (
        catalogue_entry.joint_name.split("-"),
        f"{catalogue_entry.known_numbers['ratio'].si_value:g}",
    )
    places = [place for place, part in enumerate(parts) if part == ratio]
    return "-".join(part for place, part in enumerate(parts) if place != (places or [len(parts)])[-1])


@cache
def list_drives() -> tuple[CatalogueEntry, ...]:
    """All drives of the catalogue, with a stiffness row of their own or one that several drives share."""
    torques = {(row["series"], row["size"], row["ratio"]): row for row in _read_catalogue_table("torque")}
    drives_by_name = {
        item.joint_name: item
        for row in _read_catalogue_table("stiffness")
        for item in _drives_of_row(row, torques)
    }
    for row in _read_catalogue_table("friction"):
        drives_by_name[row["drive"]] = _make_catalogue_entry_with_friction(row, drives_by_name[row["like"]])
    drives = collect_published_friction(drives_by_name.values())
    return tuple(add_friction_estimates(item, drives) for item in drives_by_name.values())


def _drives_of_row(stiffness_row: Mapping[str, str], torque_table: TorqueTable) -> Iterator[CatalogueEntry]:
    """Yield the drives for which a row of the table of stiffnesses holds."""
    group = stiffness_row["series"].removeprefix("HD ")
    ratios = [stiffness_row["ratio"]]
    if stiffness_row["ratio"].endswith("+"):
        ratios = [
            r
            for r in SPEED_RATIOS_OF_80_AND_MORE
            if any((s, stiffness_row["size"], r) in torque_table for s in SERIES_WITH_PUBLISHED_TORQUES)
        ]
    source = (
        f"{group}, size {stiffness_row['size']}, ratio {stiffness_row['ratio']}: {stiffness_row['source']}"
    )
    printed = {name: stiffness_row[column] for name, column in _STIFFNESS_HEADINGS.items()}
    lines = {name: SourcedNumber(float(text), "catalogue", source) for name, text in printed.items() if text}
    if "K3" not in lines:
        lines["K3"] = _estimate_K3(stiffness_row, source)
    for series in group.split("/"):
        stem = series if group == series else f"{series}-{stiffness_row['size']}"
        for ratio in ratios:
            name = f"{stem}-{ratio}"
            numbers = {
                "ratio": SourcedNumber(float(ratio), "catalogue", f"{name}: {source}"),
                **lines,
                **_rated_and_peak_torque(torque_table, series, stiffness_row["size"], ratio),
                **_hysteresis_limits(series, stiffness_row["size"], float(ratio)),
            }
            yield CatalogueEntry(name, numbers)


def _estimate_K3(stiffness_row: Mapping[str, str], row_source: str) -> SourcedNumber:
    """Estimate of the stiffness K3 above torque T2: K3 of a drive with equal T1, T2, K1 and K2, else K2."""
    known = [heading for column, heading in _STIFFNESS_HEADINGS.items() if column != "K3"]
    for other in _read_catalogue_table("stiffness"):
        if other["K3"] and all(float(other[h]) == float(stiffness_row[h]) for h in known):
            what = f"{other['series']}, size {other['size']}, ratio {other['ratio']}"
            text = f"not in the source; that of {what}, of the same T1, T2, K1 and K2 ({other['source']})"
            return SourcedNumber(float(other["K3"]), "estimate", text)
    return SourcedNumber(float(stiffness_row["K2"]), "estimate", f"not in the source; K2 of {row_source}")


_STIFFNESS_HEADINGS = {"K1": "K1_Nm_per_rad", "K2": "K2", "K3": "K3", "T1": "T1_Nm", "T2": "T2_Nm"}
"""{column: heading in the file of stiffnesses}."""
_TORQUE_HEADINGS = {"rated_torque": "rated_Nm", "peak_torque": "repeated_peak_Nm"}
"""{column: heading in the file of torques}."""
_HYSTERESIS_LIMIT_HEADINGS = {
    "hysteresis_loss": "hysteresis_below_arcmin",
    "lost_motion": "lost_motion_below_arcmin",
}
"""{column: heading in the file of actuators}; the file has arc minutes."""
_FRICTION_TABLE_HEADINGS = {
    "ratio": ("ratio", 1.0),
    "K1": ("K1_Nm_per_rad", 1.0),
    "K3": ("K3_Nm_per_rad", 1.0),
    "rated_torque": ("rated_Nm", 1.0),
    "peak_torque": ("repeated_peak_Nm", 1.0),
    "starting_torque": ("starting_mNm", 1e-3),
    "running_torque": ("running_mNm", 1e-3),
    "back_driving_torque": ("back_driving_Nm", 1.0),
    "efficiency": ("efficiency", 1.0),
}
"""{column: (heading in the file of single drives, factor to the SI unit)}."""


def _rated_and_peak_torque(
    torque_table: TorqueTable, drive_series: str, drive_size: str, speed_ratio: str
) -> dict[str, SourcedNumber]:
    """Rated and repeated peak torque of a drive: {column: number with source}.

    The torques are published, or else estimated from another series; empty if no series has them.
    """
    if drive_series.startswith(ACTUATOR_SERIES):
        return {}
    for other in (drive_series, *SERIES_WITH_PUBLISHED_TORQUES):
        if row := torque_table.get((other, drive_size, speed_ratio)):
            name = f"{other}-{drive_size}-{speed_ratio}"
            if other == drive_series:
                kind, ratio_to_series = "catalogue", 1.0
                text = f"{name}: {row['source']}"
            elif other in HIGH_TORQUE_SERIES and drive_series not in HIGH_TORQUE_SERIES:
                kind, ratio_to_series = "estimate", 1.0 / HIGH_OVER_STANDARD_SERIES_TORQUE
                text = (
                    f"that of {name} over {HIGH_OVER_STANDARD_SERIES_TORQUE:g}: the catalogue gives the CSG "
                    "30 % more than the CSF"
                )
            else:
                kind, text, ratio_to_series = "estimate", f"that of {name}", 1.0
            return {
                column: SourcedNumber(ratio_to_series * float(row[head]), kind, text)
                for column, head in _TORQUE_HEADINGS.items()
            }
    return {}


def _hysteresis_limits(drive_series: str, drive_size: str, speed_ratio: float) -> dict[str, SourcedNumber]:
    """Upper limits of hysteresis and lost motion of a drive: {column: number with source}.

    The limits are those of actuators of the same size, or else the largest of all actuators.
    """
    step = "30" if speed_ratio < 50.0 else "50" if speed_ratio == 50.0 else "50+"
    rows = [row for row in _read_catalogue_table("accuracy") if row["ratio"] == step]
    same_size = [row for row in rows if row["size"] == drive_size]
    limits = {}
    for column, head in _HYSTERESIS_LIMIT_HEADINGS.items():
        row = max(same_size or rows, key=lambda row: float(row[head]))
        actuator = f"{row['series']}-{row['size']}A"
        kind = "catalogue" if drive_series == actuator else "estimate"
        text = f"limit for the actuators {actuator}"
        if drive_series != actuator:
            text += ", whose stiffness is the same"
        if not same_size:
            text = f"limit for all actuators {row['series']}, none of which has this size"
        value = float(row[head]) * conversion_factor("arcmin", "rad")
        limits[column] = SourcedNumber(value, kind, f"{text} ({row['source']})", is_upper_limit=True)
    return limits


def _make_catalogue_entry_with_friction(
    friction_row: Mapping[str, str], same_stiffness_entry: CatalogueEntry
) -> CatalogueEntry:
    """Make the catalogue entry of a drive with published friction.

    same_stiffness_entry : drive of the same size, ratio and stiffness, which may be the drive itself; it
                           supplies the values that are not published
    """
    name, numbers = friction_row["drive"], dict(same_stiffness_entry.known_numbers)
    if name != same_stiffness_entry.joint_name:
        text = f"that of {same_stiffness_entry.joint_name}, of the same size, ratio and stiffness; "
        numbers = {
            c: SourcedNumber(n.si_value, "estimate", text + n.value_source, n.is_upper_limit)
            for c, n in numbers.items()
        }
    source = f"{name}: {friction_row['source']}"
    for column, (head, unit) in _FRICTION_TABLE_HEADINGS.items():
        if friction_row[head] and (
            name != same_stiffness_entry.joint_name or column not in ("ratio", "K1", "K3")
        ):
            numbers[column] = SourcedNumber(unit * float(friction_row[head]), "catalogue", source)
    return CatalogueEntry(name, numbers)


def _read_catalogue_table(table_name: str) -> list[dict[str, str]]:
    """Read the rows of a file of the catalogue: {heading: text} each."""
    path = files("jointfmu_models") / "reference" / f"harmonic_drive_catalogue_{table_name}.csv"
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def _remove_name_separators(drive_name: str) -> str:
    """Remove the separators between the parts of a drive's name, for comparisons."""
    return drive_name.replace("-", "")


def _normalise_name(drive_name: str) -> str:
    """Name of a drive in capital letters, with - between its parts."""
    return re.sub(r"[\s_/-]+", "-", drive_name.strip().lower())
