# %% [markdown]
"""
# A drive by its name

The resonance of an axis increases with the torque on its drive.
"""

# %%
import matplotlib.pyplot as plt
import numpy as np

import jointfmu

INERTIA = 1.2  # kg.m2, what the axis turns

drive = jointfmu.drive("CSG-25-100")
print(drive)  # every number with its unit and source

# %%
tau = np.linspace(0.0, drive.values["rated_torque"], 200)  # N.m
frequency = np.sqrt(drive.stiffness(tau) / INERTIA) / (2.0 * np.pi)

figure, axes = plt.subplots(layout="constrained")
axes.plot(tau, frequency, label=drive.name)
for name in ("K1", "K2", "K3"):
    constant = np.sqrt(drive.values[name] / INERTIA) / (2.0 * np.pi)
    axes.axhline(constant, color="0.6", linestyle=":")
    axes.text(tau[-1], constant - 0.05, f"constant spring {name}", ha="right", va="top", color="0.4")
axes.set(xlabel="torque [N m]", ylabel="resonance [Hz]")
axes.set_ylim(bottom=frequency[0] - 0.6)
axes.legend(frameon=False)
figure.savefig("drive_resonance.png")
