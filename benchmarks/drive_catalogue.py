"""What catalogues publish of harmonic drives beside what the model does, over all drives of the catalogue.

    python benchmarks/drive_catalogue.py

The tables of docs/harmonic_drive_explanation.md. Set by it: a parameter comes from the published number.
"""

import csv
import math
from importlib.resources import files

from jointfmu_tools.inputs.catalogue import CatalogueEntry
from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.efficiency import (
    drives_with_friction,
    friction_and_ratio,
    hysteresis_loss,
    lost_motion,
    make_python_test_rig,
)
from jointfmu_tools.joints.harmonic_drive.fit.drive import CatalogueRow
from jointfmu_tools.joints.harmonic_drive.friction import CATALOGUE_SPEED
from jointfmu_tools.joints.harmonic_drive.new import NEW

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

MODEL = MODELS["HarmonicDriveSpring"]
ARCMIN = math.pi / 10800.0
RPM = math.pi / 30.0
WITHOUT = 0.05
"""load_loss [1] of four drives by starting and back-driving torque."""
LINES = ("K1", "K2", "K3", "T1", "T2")


def made(name):
    """The parameter file of a drive of the catalogue."""
    return NEW.make_joint(dict.fromkeys(option.name for option in NEW.options) | {"catalogue": name}).file


def table(head, rows):
    """Print a table in Markdown."""
    print(f"\n| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(map(str, row))} |")


def over_drives():
    """(drive, angles' errors [1], its lost motion [rad], with hysteresis at its limit, that loop [rad])."""
    for item in catalogue.list_drives():
        if "rated_torque" not in item.numbers:
            continue
        file, printed = made(item.name), item.numbers
        spring = HarmonicDriveSpring.tabulate(file.values)
        row = CatalogueRow(**{n: printed[n].value for n in LINES}, rated=printed["rated_torque"].value)
        torques = [printed[n].value for n in ("T1", "T2", "rated_torque", "peak_torque") if n in printed]
        miss = [float(spring.curve.inverse(T) / row.wind_up(T)) - 1.0 for T in torques]
        most = {"hysteresis_loss": printed["hysteresis_loss"].value}
        opened = HarmonicDriveSpring.tabulate(file.with_values(most, "user", "limit").values)
        yield item, miss, lost_motion(spring), lost_motion(opened), hysteresis_loss(opened)


def all_drives():
    """Wind-up, hysteresis and lost motion of all drives, by series and size."""
    found = list(over_drives())
    loops = [loop / item.numbers["hysteresis_loss"].value - 1.0 for item, *_, loop in found]
    lost = [play / item.numbers["lost_motion"].value for item, _, play, _, _ in found]
    held = [play / item.numbers["lost_motion"].value for item, _, _, play, _ in found]
    size = f"{len(found)} drives"
    rows = [
        ("wind-up at T1, T2, rated and peak torque", size, "K1 to T2: set by it", "up to "
         f"{100.0 * max(abs(m) for _, miss, *_ in found for m in miss):.2f} % off, in the corners"),
        ("hysteresis loss, at its limit", size, "`hysteresis_loss`: set by it", "the loop through rated "
         f"torque opens by it within {max(map(abs, loops)):.0e}"),
        ("lost motion < 1 arcmin", size, "predicted", f"{min(lost):.2f} to {max(lost):.2f} arcmin"),
        ("the same, with hysteresis at its limit", size, "predicted", f"{min(held):.2f} to {max(held):.2f} "
         "arcmin"),
    ]  # fmt: skip
    other = [
        lost_motion(HarmonicDriveSpring.tabulate(made(name).values)) / limit
        for name, limit in another_maker()
    ]
    text = f"{min(other):.2f} to {max(other):.2f} of it"
    rows.append(("lost motion 2 or 1 arcmin, another maker", f"{len(other)} drives", "predicted", text))
    table(("published", "of", "parameters", "model"), rows)


def another_maker():
    """(CSF of the same size and ratio, printed lost motion [rad]) of the drives of another maker."""
    path = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_zd.csv"
    for row in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
        yield f"CSF-{row['size']}-{row['ratio']}", float(row["lost_motion_arcmin"]) * ARCMIN


def single_drives():
    """Friction of the drives of which it is printed: as they are made, and without their efficiency."""
    rows, both = [], [(item, made(item.name)) for item in drives_with_friction()]
    for item, file in both:
        n, drive = item.numbers, make_python_test_rig(MODEL, file)
        back, rated = n["back_driving_torque"].value, n["rated_torque"].value
        found = drive.back_driving_torque(10.0 * back)
        guess = abs(n["ratio"].value) * n["starting_torque"].value
        cells = [
            item.name,
            f"{1e3 * drive.starting_torque():.0f}",
            f"{1e3 * drive.motor_torque(CATALOGUE_SPEED, 0.0):.0f}",
        ]
        cells += [f"{back:.3g}", f"{found:.3g}", f"{guess:.3g}"]
        if n["efficiency"].kind == "catalogue":
            other = CatalogueEntry(item.name, {k: v for k, v in n.items() if k != "efficiency"})
            freed = file.with_values(friction_and_ratio(other), "user", "without efficiency")
            free = file.with_values({"load_loss": 0.0}, "user", "guess")
            values = [n["efficiency"].value, drive.efficiency(CATALOGUE_SPEED, rated)]
            values += [
                make_python_test_rig(MODEL, f).efficiency(CATALOGUE_SPEED, rated) for f in (freed, free)
            ]
            cells += [f"{100.0 * value:.1f}" for value in values]
        else:
            cells += ["-"] * 4
        rows.append(cells)
    head = (
        "drive",
        "starting torque [mN m]",
        "running torque [mN m]",
        "back-driving torque, published [N m]",
    )
    head += ("model", "guess: ratio times starting torque", "efficiency, published [%]", "model: set by it")
    table((*head, "predicted from back-driving torque", "guess: no `load_loss`"), rows)


def points(drive, column):
    """{(speed [rev/min], share of rated torque [1]): efficiency or factor [1]} of a drive."""
    path = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_efficiency.csv"
    rows = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    return {
        (float(row["rpm"] or 0.0), float(row["share"])): float(row[column])
        for row in rows
        if row["drive"] == drive and row[column]
    }


def turned(**friction):
    """A drive 1:50 of 172 N.m on the bench; its stiffness plays no part."""
    given = {"ratio": 50.0, "rated_torque": 172.0, **friction}
    return make_python_test_rig(MODEL, load_default("harmonic_drive").with_values(given, "user", "read"))


def over_load():
    """The published factor of the efficiency below rated torque; the point at half of it fixes the model."""
    rows, carried = [], 172.0 / 50.0
    for name in ("ATRIAS", "M2"):
        full = points(name, "efficiency")[2000.0, 1.0]
        factors = {share: factor for (_, share), factor in points(name, "factor").items()}
        no_load = (1.0 / factors[0.5] - 1.0) / full
        drive = turned(friction_coulomb=no_load * carried, load_loss=1.0 / full - 1.0 - no_load)
        for share, factor in sorted(factors.items()):
            role = "set by it" if share in (0.5, 1.0) else "predicted"
            computed = drive.efficiency(CATALOGUE_SPEED, share * 172.0) / full
            rows.append((name, share, f"{factor:.3f}", f"{computed:.3f}", role))
    table(("curve", "torque over rated", "efficiency over that at rated torque", "model", ""), rows)


def over_speed():
    """The published efficiency at rated torque; the slowest and the fastest point fix the model."""
    rows, carried = [], 172.0 / 50.0
    for name in ("ATRIAS", "M2"):
        known = {rpm: e for (rpm, _), e in points(name, "efficiency").items()}
        slow, fast = min(known), max(known)
        slope = (1.0 / known[fast] - 1.0 / known[slow]) * carried / ((fast - slow) * RPM)
        dry = (1.0 / known[slow] - 1.0) * carried - slope * slow * RPM
        drive = turned(friction_coulomb=dry, friction_viscous=slope)
        for rpm, efficiency in sorted(known.items()):
            computed = drive.efficiency(rpm * RPM, 172.0)
            role = "set by it" if rpm in (slow, fast) else "predicted"
            rows.append((name, f"{rpm:.0f}", f"{100.0 * efficiency:.1f}", f"{100.0 * computed:.1f}", role))
    table(("curve", "rev/min", "efficiency [%]", "model [%]", ""), rows)


def over_both():
    """The factor at other speeds than the one that fixes it; catalogues print one curve for all speeds."""
    known = {rpm: e for (rpm, _), e in points("ATRIAS", "efficiency").items()}
    factors, carried = {share: k for (_, share), k in points("ATRIAS", "factor").items()}, 172.0 / 50.0
    no_load = (1.0 / factors[0.5] - 1.0) / known[2000.0]
    slope = (1.0 / known[3500.0] - 1.0 / known[500.0]) * carried / (3000.0 * RPM)
    dry = no_load * carried - slope * CATALOGUE_SPEED
    loss = 1.0 / known[2000.0] - 1.0 - no_load
    drive = turned(friction_coulomb=dry, friction_viscous=slope, load_loss=loss)
    rows = []
    for share in (0.1, 0.2, 0.5, 0.8):
        full = {rpm: drive.efficiency(rpm * RPM, 172.0) for rpm in known}
        cells = [f"{drive.efficiency(rpm * RPM, share * 172.0) / full[rpm]:.2f}" for rpm in known]
        rows.append((share, f"{factors[share]:.2f}", *cells))
    head = ("torque over rated", "factor, all speeds", *(f"model, {rpm:.0f} rev/min" for rpm in known))
    table(head, rows)


def worked_examples():
    """Examples of catalogues: part load from the efficiency at rated torque, with load_loss = WITHOUT."""
    rows = []
    for name in ("FR-40-160", "HFUC-20-80", "SHG-20-80"):
        ((_, full),) = points(name, "efficiency").items()
        (((_, share), factor),) = points(name, "factor").items()
        drive = turned(load_loss=WITHOUT, friction_coulomb=(1.0 / full - 1.0 - WITHOUT) * 172.0 / 50.0)
        computed = drive.efficiency(CATALOGUE_SPEED, share * 172.0) / full
        rows.append((name, f"{100.0 * full:.1f}", f"{share:.2f}", f"{factor:.2f}", f"{computed:.2f}"))
    head = ("example", "efficiency at rated torque [%]", "torque over rated", "factor", "model, predicted")
    table(head, rows)


if __name__ == "__main__":
    for part in (all_drives, single_drives, over_load, over_speed, over_both, worked_examples):
        part()
