# %% [markdown]
"""
# A loop to friction

A measured loop of force over motion becomes the friction of a bolted joint.
"""

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import jointfmu

PRELOAD = 9e3  # N of each bolt

# %%
# A stand-in for your own record: a joint whose friction the fit does not know, with noise in the force.
motion = np.concatenate([a * np.sin(np.linspace(0.0, 6.0 * np.pi, 241)) for a in (1e-6, 3e-6, 9e-6)])
joint = jointfmu.load("BoltedJoint").with_values(mu=0.17)
force = -joint.follow(s_rel_x=motion, preload=PRELOAD)["f_x"]  # on the joint, positive with the motion
force += np.random.default_rng(1).normal(0.0, 3e-3 * np.ptp(force), force.size)
rows = "\n".join(f"{s!r},{f!r}" for s, f in zip(motion.tolist(), force.tolist(), strict=True))
Path("loops.csv").write_text(f"displacement [m],force [N]\n{rows}\n")

fit = jointfmu.fit("loop", "loops.csv", joint="bolted_joint", preload=PRELOAD)
print(fit)  # each parameter with its spread
fit.joint.save("fitted.toml")

again = fit.joint.follow(s_rel_x=motion, preload=PRELOAD)
figure, axes = plt.subplots(layout="constrained")
axes.plot(1e6 * motion, 1e-3 * force, ".", color="0.7", markersize=3, label="measured")
axes.plot(1e6 * motion, -1e-3 * again["f_x"], linewidth=1, label=f"fitted, mu = {fit.joint.values['mu']:.3f}")
axes.set(xlabel="shear motion [um]", ylabel="shear force [kN]")
axes.legend(frameon=False)
figure.savefig("loop_to_friction.png")
