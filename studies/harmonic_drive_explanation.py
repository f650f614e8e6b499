"""Figures of docs/harmonic_drive_explanation.md: catalogues, a measured robot, and the heat of large steps.

    python studies/harmonic_drive_explanation.py [SECTION ...]

all-drives      : wind-up, hysteresis and lost motion of all catalogue drives
single-drives   : starting, running and back-driving torque, efficiency, where they are printed
load            : efficiency over the torque
speed           : efficiency over the speed
load-and-speed  : efficiency over the torque, at other speeds
examples        : worked examples of catalogues
friction        : friction of each drive, scaled from the other drives
robot           : friction of the joints of a UR5e
speed-exponents : friction with other powers of the speed
heat            : error of E_loss over the number of steps

"Set by it" in a table: the model takes a parameter from the published number.
"""

import csv
import math
from dataclasses import replace
from importlib.resources import files

import numpy as np
from common import print_table, print_table_head, print_table_row, run_study
from jointfmu_tools.inputs.catalogue import CatalogueEntry
from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.efficiency import (
    compute_hysteresis_loss,
    compute_lost_motion,
    drives_with_friction,
    make_test_rig,
    ratio_and_friction_parameters,
)
from jointfmu_tools.joints.harmonic_drive.fit.drive import CatalogueRow
from jointfmu_tools.joints.harmonic_drive.friction import CATALOGUE_MOTOR_SPEED
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND
from oracles.drive_friction import (
    JOINTS,
    SPEEDS,
    fit_drag,
    leave_one_out,
    measured_friction,
    motor_friction,
    read_reference,
    robot_drive,
)

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

MODEL = MODELS["HarmonicDriveSpring"]
ARCMIN = math.pi / 10800.0
RPM = math.pi / 30.0
USUAL_LOAD_LOSS = 0.05
"""Usual parameter load_loss [1]: from four drives, by starting and back-driving torque."""
LINES = ("K1", "K2", "K3", "T1", "T2")


def catalogue_drive(name):
    """Parameter file of a catalogue drive."""
    return NEW_JOINT_COMMAND.make_joint(
        dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | {"catalogue": name}
    ).parameter_file


def compare_drives():
    """Compare each drive with its catalogue entry.

    Yields the entry, relative errors of the wind-up [1], lost motion [rad], and for the largest hysteresis of
    the catalogue the lost motion and the hysteresis loss [rad].
    """
    for item in catalogue.list_drives():
        if "rated_torque" not in item.known_numbers:
            continue
        file, printed = catalogue_drive(item.joint_name), item.known_numbers
        spring = HarmonicDriveSpring.tabulate(file.values)
        catalogue_row = CatalogueRow(
            **{n: printed[n].si_value for n in LINES}, rated_torque=printed["rated_torque"].si_value
        )
        torques = [printed[n].si_value for n in ("T1", "T2", "rated_torque", "peak_torque") if n in printed]
        miss = [float(spring.curve.inverse(T) / catalogue_row.wind_up(T)) - 1.0 for T in torques]
        most = {"hysteresis_loss": printed["hysteresis_loss"].si_value}
        opened = HarmonicDriveSpring.tabulate(file.with_values(most, "user", "limit").values)
        yield (
            item,
            miss,
            compute_lost_motion(spring),
            compute_lost_motion(opened),
            compute_hysteresis_loss(opened),
        )


def all_drives():
    """Print wind-up, hysteresis and lost motion of all drives."""
    found = list(compare_drives())
    loops = [loop / item.known_numbers["hysteresis_loss"].si_value - 1.0 for item, *_, loop in found]
    lost = [play / item.known_numbers["lost_motion"].si_value for item, _, play, _, _ in found]
    held = [play / item.known_numbers["lost_motion"].si_value for item, _, _, play, _ in found]
    size = f"{len(found)} drives"
    rows = [
        ("wind-up at T1, T2, rated and peak torque", size, "K1 to T2, set from it", "up to "
         f"{100.0 * max(abs(m) for _, miss, *_ in found for m in miss):.2f} % off, in the corners"),
        ("hysteresis loss, at its limit", size, "`hysteresis_loss`, set from it", "the loop through rated "
         f"torque opens by it within {max(map(abs, loops)):.0e}"),
        ("lost motion < 1 arcmin", size, "predicted", f"{min(lost):.2f} to {max(lost):.2f} arcmin"),
        ("the same, with hysteresis at its limit", size, "predicted", f"{min(held):.2f} to {max(held):.2f} "
         "arcmin"),
    ]  # fmt: skip
    other = [
        compute_lost_motion(HarmonicDriveSpring.tabulate(catalogue_drive(name).values)) / limit
        for name, limit in other_maker()
    ]
    text = f"{min(other):.2f} to {max(other):.2f} of it"
    rows.append(("lost motion 2 or 1 arcmin, another maker", f"{len(other)} drives", "predicted", text))
    print_table(("published", "of", "parameters", "model"), rows)


def other_maker():
    """Drives of another maker: (CSF drive of the same size and ratio, published lost motion [rad])."""
    path = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_zd.csv"
    for drive in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
        yield f"CSF-{drive['size']}-{drive['ratio']}", float(drive["lost_motion_arcmin"]) * ARCMIN


def single_drives():
    """Drives with published friction: default parameters, and parameters without the published efficiency."""
    rows, both = [], [(item, catalogue_drive(item.joint_name)) for item in drives_with_friction()]
    for item, file in both:
        n, drive = item.known_numbers, make_test_rig(MODEL, file)
        back, rated = n["back_driving_torque"].si_value, n["rated_torque"].si_value
        found = drive.back_driving_torque(10.0 * back)
        guess = abs(n["ratio"].si_value) * n["starting_torque"].si_value
        cells = [
            item.joint_name,
            f"{1e3 * drive.starting_torque():.0f}",
            f"{1e3 * drive.motor_torque(CATALOGUE_MOTOR_SPEED, 0.0):.0f}",
        ]
        cells += [f"{back:.3g}", f"{found:.3g}", f"{guess:.3g}"]
        if n["efficiency"].value_origin == "catalogue":
            other = CatalogueEntry(item.joint_name, {k: v for k, v in n.items() if k != "efficiency"})
            freed = file.with_values(ratio_and_friction_parameters(other), "user", "without efficiency")
            free = file.with_values({"load_loss": 0.0}, "user", "guess")
            values = [n["efficiency"].si_value, drive.efficiency(CATALOGUE_MOTOR_SPEED, rated)]
            values += [
                make_test_rig(MODEL, f).efficiency(CATALOGUE_MOTOR_SPEED, rated) for f in (freed, free)
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
    head += (
        "model",
        "guess: ratio times starting torque",
        "efficiency, published [%]",
        "model, calibrated to it",
    )
    print_table((*head, "predicted from back-driving torque", "guess: no `load_loss`"), rows)


def published_points(drive, column):
    """Published efficiency or factor [1] of a drive.

    {(speed [rev/min], torque over rated torque [1]): value}
    """
    path = files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_efficiency.csv"
    rows = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    return {
        (float(test_row["rpm"] or 0.0), float(test_row["share"])): float(test_row[column])
        for test_row in rows
        if test_row["drive"] == drive and test_row[column]
    }


def test_rig(**friction):
    """Test rig with a drive 1:50 of 172 N.m; its stiffness has no influence."""
    given = {"ratio": 50.0, "rated_torque": 172.0, **friction}
    return make_test_rig(MODEL, load_default("harmonic_drive").with_values(given, "user", "read"))


def over_load():
    """Print the efficiency factor below rated torque; the published point at half of it sets the model."""
    rows, carried = [], 172.0 / 50.0
    for name in ("ATRIAS", "M2"):
        full = published_points(name, "efficiency")[2000.0, 1.0]
        factors = {share: factor for (_, share), factor in published_points(name, "factor").items()}
        no_load = (1.0 / factors[0.5] - 1.0) / full
        drive = test_rig(friction_coulomb=no_load * carried, load_loss=1.0 / full - 1.0 - no_load)
        for share, factor in sorted(factors.items()):
            role = "calibrated" if share in (0.5, 1.0) else "predicted"
            computed = drive.efficiency(CATALOGUE_MOTOR_SPEED, share * 172.0) / full
            rows.append((name, share, f"{factor:.3f}", f"{computed:.3f}", role))
    print_table(("curve", "torque over rated", "efficiency over that at rated torque", "model", ""), rows)


def over_speed():
    """Print the efficiency at rated torque over speed; the slowest and the fastest published point set the
    model."""
    rows, carried = [], 172.0 / 50.0
    for name in ("ATRIAS", "M2"):
        known = {rpm: e for (rpm, _), e in published_points(name, "efficiency").items()}
        slow, fast = min(known), max(known)
        slope = (1.0 / known[fast] - 1.0 / known[slow]) * carried / ((fast - slow) * RPM)
        dry = (1.0 / known[slow] - 1.0) * carried - slope * slow * RPM
        drive = test_rig(friction_coulomb=dry, friction_viscous=slope)
        for rpm, efficiency in sorted(known.items()):
            computed = drive.efficiency(rpm * RPM, 172.0)
            role = "calibrated" if rpm in (slow, fast) else "predicted"
            rows.append((name, f"{rpm:.0f}", f"{100.0 * efficiency:.1f}", f"{100.0 * computed:.1f}", role))
    print_table(("curve", "rev/min", "efficiency [%]", "model [%]", ""), rows)


def over_both():
    """Print the efficiency factor over torque at several speeds; catalogues have one curve for all speeds."""
    known = {rpm: e for (rpm, _), e in published_points("ATRIAS", "efficiency").items()}
    factors, carried = (
        {share: k for (_, share), k in published_points("ATRIAS", "factor").items()},
        172.0 / 50.0,
    )
    no_load = (1.0 / factors[0.5] - 1.0) / known[2000.0]
    slope = (1.0 / known[3500.0] - 1.0 / known[500.0]) * carried / (3000.0 * RPM)
    dry = no_load * carried - slope * CATALOGUE_MOTOR_SPEED
    loss = 1.0 / known[2000.0] - 1.0 - no_load
    drive = test_rig(friction_coulomb=dry, friction_viscous=slope, load_loss=loss)
    rows = []
    for share in (0.1, 0.2, 0.5, 0.8):
        full = {rpm: drive.efficiency(rpm * RPM, 172.0) for rpm in known}
        cells = [f"{drive.efficiency(rpm * RPM, share * 172.0) / full[rpm]:.2f}" for rpm in known]
        rows.append((share, f"{factors[share]:.2f}", *cells))
    head = ("torque over rated", "factor, all speeds", *(f"model, {rpm:.0f} rev/min" for rpm in known))
    print_table(head, rows)


def worked_examples():
    """Print worked examples: efficiency at part load, from efficiency at rated torque and usual load loss."""
    rows = []
    for name in ("FR-40-160", "HFUC-20-80", "SHG-20-80"):
        ((_, full),) = published_points(name, "efficiency").items()
        (((_, share), factor),) = published_points(name, "factor").items()
        drive = test_rig(
            load_loss=USUAL_LOAD_LOSS, friction_coulomb=(1.0 / full - 1.0 - USUAL_LOAD_LOSS) * 172.0 / 50.0
        )
        computed = drive.efficiency(CATALOGUE_MOTOR_SPEED, share * 172.0) / full
        rows.append((name, f"{100.0 * full:.1f}", f"{share:.2f}", f"{factor:.2f}", f"{computed:.2f}"))
    head = ("example", "efficiency at rated torque [%]", "torque over rated", "factor", "model, predicted")
    print_table(head, rows)


# friction, robot, speed-exponents


def scaling():
    """Print the published friction of each drive, and the friction scaled from the other drives."""
    rows = []
    for name, quantity, printed, found in leave_one_out():
        unit, digits = ("[mN m]", 0) if "torque" in quantity else ("[1]", 3)
        size = 1e3 if digits == 0 else 1.0
        numbers = [
            f"{size * x:.{digits}f}"
            for x in (
                printed,
                found.central_value,
                found.prediction_interval_low,
                found.prediction_interval_high,
            )
        ]
        mark = (
            "" if found.prediction_interval_low <= printed <= found.prediction_interval_high else ", outside"
        )
        rows.append((name, f"{quantity} {unit}", *numbers[:2], f"{numbers[2]} to {numbers[3]}{mark}"))
    print_table(("drive", "of it", "printed", "from the others", "95 % interval"), rows)


def robot():
    """Print the friction of a robot's base joint, measured and by catalogue; predict the other joints."""
    base, rows = measured_friction(), []
    print(f"\nDrag that fits the base joint best: {fit_drag():.4f} N m at 20 degrees C.")
    rows.append(("base joint, measured", *(f"{1e3 * x:.0f}" for x in base)))
    for name, (given, torque) in JOINTS.items():
        for what, text in ((f"{name}, without drag", "0"), (f"{name}, drag {given} N m: prediction", given)):
            rows.append((what, *(f"{1e3 * x:.0f}" for x in motor_friction(robot_drive(name, text)))))
        if name == "CSG-25-100":
            part = motor_friction(robot_drive(name, given)) / base - 1.0
            rows.append(("its miss of the base joint", *(f"{100.0 * x:+.0f} %" for x in part)))
        guess = base * torque / 150.0
        rows.append((f"guess: base joint by {torque:g}/150 N m", *(f"{1e3 * x:.0f}" for x in guess)))
    head = ("friction at the motor [mN m], 45 degrees C", "at rest")
    print_table((*head, *(f"{speed:g} rad/s" for speed in SPEEDS[1:])), rows)


def speed_exponents():
    """Print the residuals of friction laws a + b speed^p for some exponents p.

    a and b come from least squares for the joint, from the slowest and the fastest point for an efficiency.
    """
    base, rows = measured_friction(), []
    curves = {}
    for point in read_reference("harmonic_drive_catalogue_efficiency.csv"):
        if point["share"] == "1" and point["efficiency"] and point["drive"] in ("ATRIAS", "M2"):
            curves.setdefault(point["drive"], []).append((float(point["rpm"]), float(point["efficiency"])))
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
    print_table(("power of the speed", "base joint, root mean square [mN m]", *off), rows)


# heat

FRICTION = {
    "friction_coulomb": 0.03,
    "friction_stribeck": 0.02,
    "stribeck_speed": 10.0,
    "friction_viscous": 2e-4,
}
STRIBECK_ALONE = FRICTION | {"friction_coulomb": 0.0, "friction_viscous": 0.0}
"""Parameters of the worst case: all friction decreases with the speed."""
DURATION = 0.2
"""Duration of two periods [s]."""
REFERENCE_STEPS = 20_000


def friction_heat(steps, speed, friction):
    """Dissipated energy E_loss [J] and work [J] of a motor without load, for two periods of an oscillating
    speed [rad/s]."""
    law = HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **friction))
    angle = 4.0 * np.pi * np.linspace(0.0, 1.0, steps + 1)
    w1, phi1 = speed * np.sin(angle), speed * DURATION / (4.0 * np.pi) * (1.0 - np.cos(angle))
    ratio = law.joint.ratio
    history, first_loss, work, before = law.initial_history(), 0.0, 0.0, None
    for k in range(steps + 1):
        motion = phi1[k], w1[k], phi1[k] / ratio, w1[k] / ratio
        out, history = law.advance_motion(motion, history)
        if before is None:
            first_loss = float(out["E_loss"])
        else:
            work += abs(0.5 * (float(out["tau1"]) + before) * (phi1[k] - phi1[k - 1]))
        before = float(out["tau1"])
    return float(out["E_loss"]) - first_loss, work


def heat():
    """Print the error of E_loss over the work, against REFERENCE_STEPS steps, without load."""
    speeds = (10.0, 50.0, 200.0, 1000.0)
    for title, friction in (("all friction", FRICTION), ("Stribeck friction alone", STRIBECK_ALONE)):
        exact = {speed: friction_heat(REFERENCE_STEPS, speed, friction) for speed in speeds}
        print_table_head(
            f"E_loss of a swinging motor, error over the work through the drive: {title}",
            "steps of two periods",
            *(f"amplitude {speed:g} rad/s" for speed in speeds),
        )
        for steps in (50, 100, 200, 400, 1000):
            found = (friction_heat(steps, speed, friction)[0] - exact[speed][0] for speed in speeds)
            print_table_row(steps, *(f"{e / exact[s][1]:+.2%}" for e, s in zip(found, speeds, strict=True)))
    print_table_head(
        "load_loss under an oscillating load: work that the balance misses", "steps per period", "error"
    )
    for steps in (4, 8, 16, 32):
        errors = (missing_work(steps, phase) for phase in np.linspace(0.0, np.pi, 6, endpoint=False))
        print_table_row(steps, f"{max(map(abs, errors)):.2%}")


def missing_work(steps_per_period, phase):
    """Work at the flanges minus E_loss and stored energy, over the work; 24 periods of the load.

    The motor turns at 10 rad/s; the load oscillates by 3 N m with a period of 0.1 s.
    """
    values = {"load_loss": 0.15, "friction_coulomb": 0.004, "d": 0.0}
    law = HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **values))
    history, ratio, w1, frequency = law.initial_history(), law.joint.ratio, 10.0, 20.0 * np.pi
    work, rows = 0.0, []
    for time in np.linspace(0.0, 2.4, 24 * steps_per_period + 1):
        torque = 3.0 * np.sin(frequency * time + phase)
        wind_up = np.copysign(law.curve.inverse(abs(torque)), torque)
        rate = 3.0 * frequency * np.cos(frequency * time + phase) / law.curve.derivatives(abs(wind_up))[1]
        motion = w1 * time, w1, w1 * time / ratio + wind_up, w1 / ratio + rate
        out, history = law.advance_motion(motion, history)
        stored = law.curve.energy(abs(wind_up)) + out["E_loss"]
        rows.append((motion[0], motion[2], out["tau1"], out["tau2"], stored))
        if len(rows) > 1:
            (x1, x2, a1, a2, _), (y1, y2, b1, b2, _) = rows[-2:]
            work -= 0.5 * ((a1 + b1) * (y1 - x1) + (a2 + b2) * (y2 - x2))
    return float((work - rows[-1][-1] + rows[0][-1]) / work)


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "all-drives": all_drives,
            "single-drives": single_drives,
            "load": over_load,
            "speed": over_speed,
            "load-and-speed": over_both,
            "examples": worked_examples,
            "friction": scaling,
            "robot": robot,
            "speed-exponents": speed_exponents,
            "heat": heat,
        },
    )
