# %% [markdown]
"""
# A robot with six drives

A robot with six drives of the catalogue and coupled links: load, wind-up, and the error of the tip, with the
drives and with constant springs.
"""

# %%
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial.transform import Rotation

import jointfmu

ARM = {  # joint: (axis, length of its link [m], drive); as models/systems/six_axis_robot.toml has it
    "base": ("z", 0.3, "CSG-32-100"),
    "shoulder": ("y", 0.45, "CSG-40-100"),
    "elbow": ("y", 0.2, "CSG-25-100"),
    "forearm": ("z", 0.22, "CSG-20-100"),
    "wrist": ("y", 0.1, "CSG-17-100"),
    "hand": ("z", 0.12, "CSG-14-100"),
}


def tip(angles):
    """Tip position (n, 3) [m] at axis angles (n) [rad]."""
    turn, place = Rotation.identity(), 0.0
    for (axis, length, _), angle in zip(ARM.values(), angles, strict=True):
        turn = turn * Rotation.from_euler(axis, angle[:, None])
        place = place + turn.apply([0.0, 0.0, length])
    return place


# %%
subprocess.run([sys.executable, "-m", "jointfmu", "system", "six_axis_robot", "--csv=robot.csv"], check=True)
run = np.genfromtxt("robot.csv", delimiter=",", names=True, deletechars="")[::20]
motors = [-run[f"{name}_motor.phi_[rad]"] / 100.0 for name in ARM]  # against the links
links = {"drives as in the FMU": [run[f"{name}_link.phi_[rad]"] for name in ARM]}
for K in ("K1", "K3"):
    springs = {name: jointfmu.drive(drive).values[K] for name, (*_, drive) in ARM.items()}  # N.m/rad
    wound = [-run[f"{name}_drive.tau2_[N.m]"] / k for name, k in springs.items()]
    links[f"constant springs {K}"] = [q + w for q, w in zip(motors, wound, strict=True)]

# %%
figure, (load, wind_up, error) = plt.subplots(1, 3, figsize=(12.0, 4.2), layout="constrained")
for name, motor, link in zip(ARM, motors, links["drives as in the FMU"], strict=True):
    load.plot(run["time_[s]"], run[f"{name}_drive.tau2_[N.m]"], label=name)
    wind_up.plot(run["time_[s]"], 1e3 * (link - motor), label=name)
for label, angles in links.items():
    error.plot(run["time_[s]"], 1e3 * np.linalg.norm(tip(angles) - tip(motors), axis=1), label=label)
for axes, label in ((load, "load [N.m]"), (wind_up, "wind-up [mrad]"), (error, "error of the tip [mm]")):
    axes.set(xlabel="time [s]", ylabel=label)
load.legend(frameon=False)
error.legend(frameon=False)
figure.savefig("robot.png")
