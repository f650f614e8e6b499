# %% [markdown]
"""
# A drive in MuJoCo

A drive between motor and link of an arm in MuJoCo. Needs the extra `mujoco`.
"""

# %%
import matplotlib.pyplot as plt
import mujoco
import numpy as np
from jointfmu_tools.exchange.mujoco import plugin

import jointfmu

ARM = """
<mujoco>
  <option timestep="0.0005"/>
  <extension><plugin plugin="jointfmu.HarmonicDriveSpring"><instance name="drive">
    <config key="phi1" value="motor"/> <config key="phi2" value="elbow"/>
  </instance></plugin></extension>
  <worldbody>
    <body><joint name="motor" type="hinge" axis="0 1 0" armature="3e-5"/>
      <inertial pos="0 0 0" mass="0.1" diaginertia="1e-6 1e-6 1e-6"/></body>
    <body><joint name="elbow" type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="2"/></body>
  </worldbody>
  <actuator><position joint="motor" kp="0.5" kv="0.01"/></actuator>
  <sensor><plugin name="drive" plugin="jointfmu.HarmonicDriveSpring" instance="drive"/></sensor>
</mujoco>
"""

# %%
fmu = jointfmu.drive("CSG-14-100").build("dist", "fmi3", fmu="HarmonicDriveSpring")[0]
mujoco.mj_loadPluginLibrary(str(plugin(fmu, "dist/mujoco")))

# %%
model = mujoco.MjModel.from_xml_string(ARM)
data, rows = mujoco.MjData(model), []
while data.time < 2.0:
    data.ctrl[0] = -100.0 * np.deg2rad(30.0) * min(data.time, 1.0)  # turns the link by 30 degrees, against it
    mujoco.mj_step(model, data)
    rows.append((data.time, data.joint("elbow").qpos[0], data.sensor("drive").data[2]))
time, elbow, wind_up = np.transpose(rows)

# %%
figure, axes = plt.subplots(2, sharex=True, layout="constrained")
axes[0].plot(time, np.rad2deg(elbow))
axes[0].set(ylabel="elbow [deg]")
axes[1].plot(time, 1e3 * wind_up)
axes[1].set(xlabel="time [s]", ylabel="wind-up [mrad]")
figure.savefig("mujoco_arm.png")
