# %% [markdown]
"""
# Bands of uncertain parameters

Uncertain parameters of a joint give a band: an FMU over many samples. Needs the extra `uncertainty`.
"""

# %%
import csv
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np

import jointfmu

# %%
fmu = jointfmu.load("BoltedJoint").build("dist", "fmi2")[0]
words = "--set surface.D=1.38..1.46 H=+-10% --input preload --to 30e3 --step 1e3 --samples 64 --out study"
subprocess.run([sys.executable, "-m", "jointfmu", "uncertainty", str(fmu), *words.split()], check=True)

with open("study/bands.csv", newline="") as file:
    heads, *rows = csv.reader(file)
bands = dict(zip(heads, np.array(rows, dtype=float).T, strict=True))
preload = 1e-3 * bands["preload [N]"]

figure, axes = plt.subplots(layout="constrained")
for low, high, shade in ((1, 99, 0.2), (5, 95, 0.3), (25, 75, 0.4)):
    edges = [1e-9 * bands[f"K_zz {p} % [N/m]"] for p in (low, high)]
    axes.fill_between(preload, *edges, color="tab:blue", alpha=shade, lw=0, label=f"{low} to {high} %")
axes.plot(preload, 1e-9 * bands["K_zz 50 % [N/m]"], color="tab:blue", label="median")
axes.set(xlabel="preload of each bolt [kN]", ylabel="normal stiffness [N/nm]")
axes.legend(frameon=False)
figure.savefig("sweep.png")
