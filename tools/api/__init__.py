"""Public interface of `import jointfmu`: joints, laws, fits and FMU runs. `jointfmu.__all__` lists it."""

from ..joints.bolted_joint.new import NEW_JOINT_COMMAND as NEW_BOLTED_JOINT
from ..joints.gear_contact.new import NEW_JOINT_COMMAND as NEW_GEAR_CONTACT
from ..joints.gear_mesh.new import NEW_JOINT_COMMAND as NEW_GEAR_MESH
from ..joints.harmonic_drive.new import NEW_JOINT_COMMAND as NEW_DRIVE
from ..joints.harmonic_drive.new_cycloidal import NEW_CYCLOIDAL_DRIVE_COMMAND
from .frame import Frame as Frame
from .frame import Table as Table
from .frame import run as run
from .joint import Joint as Joint
from .law import Law as Law
from .law import law as law
from .make import Fit as Fit
from .make import create_drawing_function
from .make import fit as fit
from .make import load as load
from .system_fit import SystemFit as SystemFit
from .system_fit import fit_system as fit_system

drive = create_drawing_function(
    "drive",
    NEW_DRIVE,
    'jointfmu.drive("CSG-25-100").values["T2"]  # N.m\n48.0',
    positional_option="catalogue",
)
"""Make a harmonic drive: `jointfmu.drive`."""
cycloidal_drive = create_drawing_function(
    "cycloidal_drive",
    NEW_CYCLOIDAL_DRIVE_COMMAND,
    "drive = jointfmu.cycloidal_drive(ratio=121, rated_torque=412, rigidity=108, lost_motion=1)\n"
    '>>> drive.values["T2"]  # N.m\n412.0',
)
"""Make a cycloidal or RV drive: `jointfmu.cycloidal_drive`."""
bolted_joint = create_drawing_function(
    "bolted_joint",
    NEW_BOLTED_JOINT,
    "plate = jointfmu.bolted_joint(\n"
    '...     plate=(200, 100), bolts="4xM12", at=(160, 60), grip=40, material="steel", Ra=0.8\n'
    "... )\n"
    ">>> f\"{plate.values['inputs.preload']:.0f} N\"\n'43110 N'",
)
"""Make a bolted joint: `jointfmu.bolted_joint`."""
gear_contact = create_drawing_function(
    "gear_contact",
    NEW_GEAR_CONTACT,
    "flanks = jointfmu.gear_contact(\n"
    '...     width=20, radii=[12, 30], load=2000, material="hardened steel", finish="ground"\n'
    "... )\n"
    '>>> bool(flanks.evaluate(f=2000.0)["K_N"][0] > 1e9)\nTrue',
)
"""Make a contact of two tooth flanks: `jointfmu.gear_contact`."""
gear_mesh = create_drawing_function(
    "gear_mesh",
    NEW_GEAR_MESH,
    "mesh = jointfmu.gear_mesh(\n"
    '...     module=3, teeth=[20, 40], width=25, torque=50, material="steel", finish="ground"\n'
    "... )\n"
    '>>> mesh.values["teeth1"]\n20.0',
)
"""Make a gear mesh: `jointfmu.gear_mesh`."""
