"""Robots of the tests: files, and the same robots in MuJoCo with rotors as bodies and springs as tendons."""

from importlib import metadata
from pathlib import Path

import numpy as np

ROBOT = Path(__file__).parents[2] / "models/robots/six_axis.xml"
OTHERS = {"ur5e": ("airo-models", "ur5e/ur5e.urdf"), "openarm": ("openarm-mujoco", "v2/openarm_bimanual.xml")}
"""{robot: (wheel, end of the path of its file)}."""


def robot_file(name):
    wheel, end = OTHERS[name]
    (file,) = (f.locate() for f in metadata.files(wheel) if f.as_posix().endswith(end))
    return file


def add_rotors(spec, inertias, ratios=None, stiffness=None):
    """Model of the shipped robot with a rotor on the link before each joint, whose inertia includes it, and
    linear springs between rotors and joints. Returns the model, and its degrees of freedom: joints, rotors.
    """
    names = [joint.name for joint in spec.joints]
    for k, (name, J) in enumerate(zip(names, inertias, strict=True)):
        joint = spec.joint(name)
        body, joint.armature = joint.parent, 0.0
        half = np.sqrt(0.5)
        turned = [half, -half, 0.0, 0.0] if joint.axis[1] else [1.0, 0.0, 0.0, 0.0]
        rotor = body.parent.add_body(name=f"{name}_rotor", pos=body.pos, quat=turned)
        rotor.mass, rotor.inertia, rotor.explicitinertial = 1e-13, [J / 2, J / 2, J], True
        rotor.ipos, rotor.iquat = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
        rotor.add_joint(name=f"{name}_rotor", axis=[0.0, 0.0, 1.0])
        if body.parent.name != "world":
            own = J / 2 * (1.0 + np.abs(joint.axis))
            body.parent.inertia = np.asarray(body.parent.inertia) - own
        if stiffness is not None:
            tendon = spec.add_tendon(name=name, stiffness=[stiffness[k], 0.0, 0.0], springlength=[0.0, 0.0])
            tendon.wrap_joint(name, 1.0)
            tendon.wrap_joint(f"{name}_rotor", -1.0 / ratios[k])
    for actuator in [*spec.actuators]:
        spec.delete(actuator)
    model = spec.compile()
    return model, [model.joint(name).dofadr[0] for name in (*names, *(f"{name}_rotor" for name in names))]
