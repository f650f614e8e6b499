"""Pressure of two bolted plates: the cones of VDI 2230 beside finite elements of the same plates.

    python benchmarks/plate_pressure.py

For every plate the share of the force inside circles around the bolts, its radius of gyration, and the
stiffness of the joint.
"""

import tempfile
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
from jointfmu_tools import cli
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate, TappedPlate
from jointfmu_tools.inputs.drawing.tables import read_threads
from jointfmu_tools.inputs.fields.joint_parameters import pressure_shape

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.mechanics.footprint import plate
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.parameters import ParameterFile, load_parameter_file
from jointfmu.quantity import flatten_parameters

PLATES = {
    "four M12, 2 x 20 mm": "--plate 200x100 --bolts 4xM12 --at 160x60 --grip 40 --preload 30e3",
    "four M12, 2 x 10 mm": "--plate 200x100 --bolts 4xM12 --at 160x60 --grip 20 --preload 30e3",
    "one M16, 2 x 20 mm": "--plate 100x100 --bolts M16 --grip 40 --preload 60e3",
    "one M16 tapped, 20 and 60 mm": "--plate 100x100 --bolts M16 --grip 20 --preload 60e3 --tapped "
    "--thickness 20 60",
    "one M16 tapped, 30 and 60 mm": "--plate 80x80 --bolts M16 --grip 30 --preload 60e3 --tapped "
    "--thickness 30 60",
    "one M12 tapped, 15 and 40 mm": "--plate 100x100 --bolts M12 --grip 15 --preload 30e3 --tapped "
    "--thickness 15 40",
}
"""{name: drawing} of steel plates, Ra 0.8 um."""
RADII = (0.010, 0.0125, 0.015, 0.02, 0.025)
"""Of the circles [m]."""
OUTPUTS = ("K_zz", "K_rx", "K_ry", "K_rz", "p_max")
FINE = 20
"""Cells from a bolt's axis to the edge of its pressure, finer than in a joint, to tell the circles apart."""


def made(options: str, folder: Path) -> ParameterFile:
    """The joint of a drawing, its bolts without stiffness."""
    path = folder / "plate.toml"
    words = f"new bolted-joint {options} --embedding 0 --material steel --Ra 0.8 --out {path}"
    with redirect_stdout(StringIO()):
        if cli.main(words.split()):
            raise SystemExit(f"{words} failed")
    return load_parameter_file(path).with_values({"bolt_stiffness": 0.0}, "user", "the interface alone")


def computed(file: ParameterFile, options: str) -> PressureDistribution:
    """The pressure of two elastic plates."""
    pattern, words = file.values.pattern, options.split()
    thread = read_threads()[words[words.index("--bolts") + 1].rpartition("x")[2]]
    thickness = 0.5e-3 * float(words[words.index("--grip") + 1])
    side = Plate(
        length=pattern.length, width=pattern.width, thickness=thickness, E=210e9, nu=0.3, density=7850.0
    )
    sides = [side, side]
    if "--tapped" in words:
        first, second = (1e-3 * float(word) for word in words[words.index("--thickness") + 1 :][:2])
        sides = [
            replace(side, thickness=first),
            TappedPlate(**flatten_parameters(side) | {"thickness": second, "depth": thread.d}),
        ]
    bolts = BoltList(
        x=pattern.x, y=pattern.y, hole_diameter=pattern.hole_diameter, head_diameter=thread.hexagon
    )
    contact = BoltedContact.from_assembly(Assembly(file.name, *sides, bolts))
    preload = file.start_value("preload")
    field = contact.solve(tabulate_approach(file.values), preload).field
    return pressure_shape(replace(file.values, A_0=float(field.area.sum())), field, preload)


def shown(file: ParameterFile, shape: PressureDistribution, fine: PressureDistribution) -> str:
    """Two lines: the shares inside the circles, and the joint's stiffness."""
    bolts = file.values.pattern.bolts
    apart = np.hypot(*np.moveaxis(fine.position[:, None, :] - bolts, -1, 0)).min(axis=1)
    force, rest = fine.area_share * fine.preload_shape, (0.0, 0.0, 0.0)
    shares = "  ".join(f"{force[apart < r].sum():.3f} in {r * 1e3:g} mm" for r in RADII)
    shares += f"  radius of gyration {1e3 * np.sqrt(force @ apart**2):.4g} mm"
    spring = BoltedJointSpring.of_nodes(file.values, shape)
    state = spring.evaluate(file.start_value("preload"), 0.0, rest, rest)
    return f"{shares}\n  {'':9} " + "  ".join(f"{name} {float(state[name]):.4g}" for name in OUTPUTS)


def main() -> None:
    """Print both."""
    usual = plate.MIN_CELLS_PER_RADIUS
    for name, options in PLATES.items():
        print(name)
        with tempfile.TemporaryDirectory() as folder:
            file = made(options, Path(folder))
        cones = file.values.pattern.pressure_distribution()
        plate.MIN_CELLS_PER_RADIUS = FINE
        fine = file.values.pattern.pressure_distribution()
        plate.MIN_CELLS_PER_RADIUS = usual
        elastic = computed(file, options)
        for what, shape, finer in (("cones", cones, fine), ("computed", elastic, elastic)):
            print(f"  {what:9} {shown(file, shape, finer)}")


if __name__ == "__main__":
    main()
