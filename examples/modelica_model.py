# %% [markdown]
"""
# A drive in Modelica

A drive as a Modelica component, without an FMU, run by rumoca. Any Modelica tool opens the same files.

Set JOINTFMU_MSL to a folder that holds the Modelica Standard Library. By default the script takes the
replacement that the tests use.
"""

# %%
import os
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import rumoca

import jointfmu

MODEL = """
model Link
  extends Modelica.Icons.Example;
  Modelica.Mechanics.Rotational.Components.Fixed motor;
  JointStiffness.Components.HarmonicDriveSpring drive;
  Modelica.Mechanics.Rotational.Components.Inertia link(J=0.05, phi(fixed=true, start=2e-3), w(fixed=true));
equation
  connect(motor.flange, drive.flange_a);
  connect(drive.flange_b, link.flange_a);
end Link;
"""

# %%
jointfmu.drive("CSG-14-100").save("drive.toml")
words = ["modelica", "--params", "drive.toml", "--out", "modelica"]
subprocess.run([sys.executable, "-m", "jointfmu", *words], check=True)

library = os.environ.get("JOINTFMU_MSL", Path(jointfmu.__file__).parents[2] / "tests" / "modelica")
session = rumoca.Session(roots=[str(library), "modelica"])
link = session.loads(MODEL, model="Link", filename="Link.mo").simulate(t=(0.0, 0.5), dt=2e-4)

# %%
figure, axes = plt.subplots(layout="constrained")
axes.plot(link.time, 1e3 * link["link.phi"])
axes.set(xlabel="time [s]", ylabel="link, let go from 2 mrad [mrad]")
figure.savefig("modelica_model.png")
