"""Friction of drives by name: how well it is scaled, and beside the base joint of a measured robot.

    python benchmarks/drive_friction.py

The tables of docs/harmonic_drive.md. Left out: a drive's friction from that of all others.
"""

from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.named_friction import known
from jointfmu_tools.joints.harmonic_drive.scaling import scaled

DRIVES = {name: each for name, (each, _) in known(catalogue.items()).items()}


def table(head, rows):
    """Print a table in Markdown."""
    print(f"\n| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(map(str, row))} |")


def left_out():
    """Yields (drive, quantity, printed, Scaled from the others [N.m or 1])."""
    for name, drive in DRIVES.items():
        law = scaled(drive.size, drive.ratio, [other for other in DRIVES.values() if other is not drive])
        yield name, "starting torque", drive.starting, law.starting
        if drive.running is not None:
            yield name, "rise to running torque", drive.running - drive.starting, law.rise
        if drive.load_loss is not None:
            yield name, "`load_loss`", drive.load_loss, law.load_loss
        if drive.load_loss_back is not None:
            yield name, "`load_loss_back`", drive.load_loss_back, law.load_loss_back


def scaling():
    """Every printed number from those of the other drives."""
    rows = []
    for name, quantity, printed, found in left_out():
        unit, digits = ("[mN m]", 0) if "torque" in quantity else ("[1]", 3)
        size = 1e3 if digits == 0 else 1.0
        numbers = [f"{size * x:.{digits}f}" for x in (printed, found.value, found.low, found.high)]
        mark = "" if found.low <= printed <= found.high else ", outside"
        rows.append((name, f"{quantity} {unit}", *numbers[:2], f"{numbers[2]} to {numbers[3]}{mark}"))
    table(("drive", "of it", "printed", "from the others", "95 % interval"), rows)


if __name__ == "__main__":
    scaling()
