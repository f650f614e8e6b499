# %% [markdown]
"""
# A scan to a joint

A surface scan becomes the stiffness of a bolted joint. Needs the extra `surface`.
"""

# %%
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np

import jointfmu


def shell(words: str) -> None:
    """Run the command `jointfmu WORDS`."""
    subprocess.run([sys.executable, "-m", "jointfmu", *words.split()], check=True)


# %%
# A stand-in for your own scan: 1 mm x 1 mm of a rough surface, heights in metres.
shell("surface synthesize --size 1e-3 --points 256 --D 2.4 --G 1e-8 --seed 1 --out scan.csv")
# Both sides are like the scan, whose roughness goes into the parameter file of the joint.
shell("surface scan.csv --side both --joint bolted_joint --out scanned.toml --plot scan.png")

# %%
scanned, shipped = jointfmu.load("scanned.toml"), jointfmu.load("BoltedJoint")
preload = np.linspace(1e3, 30e3, 30)  # N of each bolt
figure, axes = plt.subplots(layout="constrained")
for joint, label in ((scanned, "of the scan"), (shipped, "as shipped")):
    stiffness = joint.evaluate(preload=preload)["K_zz"]
    axes.plot(1e-3 * preload, 1e-9 * stiffness, label=label)
    print(f"{label}: {stiffness[-1]:.3g} N/m at {preload[-1]:.0f} N")
axes.set(xlabel="preload of each bolt [kN]", ylabel="normal stiffness [N/nm]")
axes.legend(frameon=False)
figure.savefig("scan_to_joint.png")
