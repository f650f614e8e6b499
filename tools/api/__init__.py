"""Public interface of `import jointfmu`: joints, laws, fits and FMU runs. `jointfmu.__all__` lists it."""

from jointfmu.joints import KINDS

from .frame import Frame as Frame
from .frame import Table as Table
from .frame import run as run
from .joint import Joint as Joint
from .law import Law as Law
from .law import law as law
from .make import Fit as Fit
from .make import create_joint_function
from .make import fit as fit
from .make import load as load
from .system_fit import SystemFit as SystemFit
from .system_fit import fit_system as fit_system

drive = create_joint_function(
    "drive",
    KINDS["harmonic_drive"],
    'jointfmu.drive("CSG-25-100").values["T2"]  # N.m\n48.0',
    first_option="catalogue",
)
bolted_joint = create_joint_function(
    "bolted_joint",
    KINDS["bolted_joint"],
    "plate = jointfmu.bolted_joint(\n"
    '...     plate=(200, 100), bolts="4xM12", at=(160, 60), grip=40, material="steel", Ra=0.8\n'
    "... )\n"
    ">>> f\"{plate.values['inputs.preload']:.0f} N\"\n'43110 N'",
)
gear_contact = create_joint_function(
    "gear_contact",
    KINDS["gear_contact"],
    "flanks = jointfmu.gear_contact(\n"
    '...     width=20, radii=[12, 30], load=2000, material="hardened steel", finish="ground"\n'
    "... )\n"
    '>>> bool(flanks.evaluate(f=2000.0)["K_N"][0] > 1e9)\nTrue',
)
gear_mesh = create_joint_function(
    "gear_mesh",
    KINDS["gear_mesh"],
    "mesh = jointfmu.gear_mesh(\n"
    '...     module=3, teeth=[20, 40], width=25, torque=50, material="steel", finish="ground"\n'
    "... )\n"
    '>>> mesh.values["teeth1"]\n20.0',
)
