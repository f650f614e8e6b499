"""Friction of drives by name: how well it is scaled, and beside the base joint of a measured robot.

    python benchmarks/drive_friction.py

The tables of docs/harmonic_drive_explanation.md. Left out: a drive's friction from that of all others. The
decisions on the joints of the robot, and their sources, are in that page.
"""

import csv
from importlib.resources import files

import numpy as np
from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.friction import collect_published, scale_friction
from jointfmu_tools.joints.harmonic_drive.new import NEW
from scipy.optimize import minimize_scalar

from jointfmu.joints.harmonic_drive.friction import dry_friction_factor, friction_limits, viscous_torque

DRIVES = {name: each for name, (each, _) in collect_published(catalogue.list_drives()).items()}


def table(head, rows):
    """Print a table in Markdown."""
    print(f"\n| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(map(str, row))} |")


def left_out():
    """Yields (drive, quantity, printed, Scaled from the others [N.m or 1])."""
    for name, drive in DRIVES.items():
        law = scale_friction(
            drive.drive_size, drive.ratio, tuple(other for other in DRIVES.values() if other is not drive)
        )
        yield name, "starting torque", drive.starting_torque, law.starting_torque
        if drive.running_torque is not None:
            yield (
                name,
                "rise to running torque",
                drive.running_torque - drive.starting_torque,
                law.viscous_torque,
            )
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


WARM = 318.15
"""[K] of the robot's joints."""
SPEEDS = (0.0, 0.5, 1.5, 3.2)
"""[rad/s] of the joint; 0: at rest."""
JOINTS = {"CSG-25-100": ("0.019", 150.0), "CSG-14-100": ("0.006", 28.0)}
"""{drive: motor drag at 20 degrees C [N.m], torque of the joint by the robot's data sheet [N.m]}."""


def joint(name, drag):
    """Parameters of a drive of the robot by name, its flexspline fixed."""
    options = dict.fromkeys(option.name for option in NEW.options)
    options |= {"catalogue": name, "fixed": "flexspline", "temperature": f"{WARM}K", "motor_drag": drag}
    return NEW.make_joint(options).file.values


def friction(drive):
    """Friction [N.m] at the motor at SPEEDS, without load."""
    speed = abs(drive.ratio) * np.array(SPEEDS)
    return friction_limits(drive, speed, 0.0, WARM)[0] + viscous_torque(drive, speed, WARM)


def reference(name):
    """Rows of a file of reference numbers."""
    text = (files("jointfmu_models") / "reference" / name).read_text(encoding="utf-8")
    return csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))


def measured():
    """Friction [N.m] at the motor of the base joint at SPEEDS: the mean of both senses."""
    torque = {}
    for row in reference("ur5e_base_joint_friction.csv"):
        speed = abs(float(row["joint_speed_rad_per_s"]))
        torque.setdefault(speed if speed >= 0.5 else 0.0, []).append(abs(float(row["motor_torque_Nm"])))
    return np.array([np.mean(torque[speed]) for speed in SPEEDS])


def drag(name="CSG-25-100"):
    """Drag [N.m] at 20 degrees C that fits the base joint best: least squares in logarithms."""
    drive, base = joint(name, "0"), measured()
    bare, part = friction(drive), float(dry_friction_factor(drive, WARM))

    def cost(more):
        return np.sum(np.log((bare + more * part) / base) ** 2)

    return minimize_scalar(cost, bounds=(0.0, 0.1), method="bounded").x


def robot():
    """The base joint beside its drive by name, and what is predicted of the robot's other joints."""
    base, rows = measured(), []
    print(f"\nDrag that fits the base joint best: {drag():.4f} N m at 20 degrees C.")
    rows.append(("base joint, measured", *(f"{1e3 * x:.0f}" for x in base)))
    for name, (given, torque) in JOINTS.items():
        for what, text in ((f"{name}, without drag", "0"), (f"{name}, drag {given} N m: prediction", given)):
            rows.append((what, *(f"{1e3 * x:.0f}" for x in friction(joint(name, text)))))
        if name == "CSG-25-100":
            part = friction(joint(name, given)) / base - 1.0
            rows.append(("its miss of the base joint", *(f"{100.0 * x:+.0f} %" for x in part)))
        guess = base * torque / 150.0
        rows.append((f"guess: base joint by {torque:g}/150 N m", *(f"{1e3 * x:.0f}" for x in guess)))
    head = ("friction at the motor [mN m], 45 degrees C", "at rest")
    table((*head, *(f"{speed:g} rad/s" for speed in SPEEDS[1:])), rows)


def shape():
    """Friction a + b speed^p for some powers: what is left of the base joint, and of efficiencies over speed.

    Two numbers decide the line: least squares for the joint, the slowest and fastest point of an efficiency.
    """
    base, rows = measured(), []
    curves = {}
    for row in reference("harmonic_drive_catalogue_efficiency.csv"):
        if row["share"] == "1" and row["efficiency"] and row["drive"] in ("ATRIAS", "M2"):
            curves.setdefault(row["drive"], []).append((float(row["rpm"]), float(row["efficiency"])))
    for power in (1.0, 2.0 / 3.0, 0.5):
        line = np.stack([np.ones(len(SPEEDS)), np.array(SPEEDS) ** power], axis=1)
        left = base - line @ np.linalg.lstsq(line, base, rcond=None)[0]
        cells = [f"{power:.2g}", f"{1e3 * np.sqrt(np.mean(left**2)):.1f}"]
        for points in curves.values():
            speed, efficiency = np.array(points).T
            loss, speed = 1.0 / efficiency, speed**power
            between = np.interp(speed, speed[[0, -1]], loss[[0, -1]])
            cells.append(f"{100.0 * np.max(np.abs(1.0 / between - efficiency)):.1f}")
        rows.append(cells)
    off = (f"efficiency of {name}, largest miss [points]" for name in curves)
    table(("power of the speed", "base joint, root mean square [mN m]", *off), rows)


if __name__ == "__main__":
    scaling()
    robot()
    shape()
