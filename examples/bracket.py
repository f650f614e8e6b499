# %% [markdown]
"""
# A bracket from its drawing

A bolted bracket from its drawing: shear loops over the preload, and an FMU of the bracket.
Needs the extra `fem`.
"""

# %%
import matplotlib.pyplot as plt
import numpy as np

import jointfmu

bracket = jointfmu.bolted_joint(
    plate=(200, 100), bolts="4xM12", at=(160, 60), grip=40, material="steel", Ra=0.8
)
print(bracket)

# %%
tightened = bracket.values["inputs.preload"]  # N of each bolt

figure, axes = plt.subplots(layout="constrained")
for share in (0.1, 0.5, 1.0):
    motion = 3e-6 * np.sin(np.linspace(0.0, 2.5 * np.pi, 112))  # m
    loop = bracket.follow(s_rel_x=motion, preload=share * tightened)
    axes.plot(1e6 * loop["s_rel_x"], -1e-3 * loop["f_x"], label=f"{1e-3 * share * tightened:.0f} kN each")
    print(f"{share:4.0%} of the preload: {loop['E_loss'][-1]:.3g} J lost")
axes.set(xlabel="shear motion [um]", ylabel="shear force [kN]")
axes.legend(title="bolts", frameon=False)
figure.savefig("bracket.png")

# %%
bracket.save("bracket.toml")
print(*bracket.build("dist", "fmi2"))
