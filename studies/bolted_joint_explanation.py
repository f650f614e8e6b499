"""Figures of docs/bolted_joint_explanation.md: contact pressure of two plates, stiffness by attachment.

    python studies/bolted_joint_explanation.py [SECTION ...]

pressure    : share of the force inside circles around the bolts, radius of gyration and stiffness, by cones
              of VDI 2230 and by finite elements of the plates
attachments : stiffness of the README's joint with plates and bolts, for each attachment, and stiffness of its
              interface alone
opening     : moments that open the bracket, by hand and of the complete joint
bed         : stiffness of a bracket on a bed: thickness of plate 2, attachment, bed larger than the plate
"""

import tempfile
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
from common import print_table_head, print_table_row, run_study
from jointfmu_tools import cli
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate, TappedPlate
from jointfmu_tools.fem.whole_joint import JointFiniteElements
from jointfmu_tools.inputs.drawing.tables import read_threads
from jointfmu_tools.inputs.fields.joint_parameters import normalise_pressure_field
from jointfmu_tools.joints.bolted_joint.external_load import ExternalLoad, compute_opening_moment
from jointfmu_tools.joints.bolted_joint.new import NEW_JOINT_COMMAND, plate_finite_elements
from jointfmu_tools.joints.bolted_joint.new.plate import read_drawing
from oracles.joint_elements import EXAMPLE

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
"""{name: options of `jointfmu new`} of steel plates, Ra 0.8 um."""
RADII = (0.010, 0.0125, 0.015, 0.02, 0.025)
"""Radii of the circles [m]."""
OUTPUTS = ("K_zz", "K_rx", "K_ry", "K_rz", "p_max")
FINE_CELLS = 20
"""Number of cells from the bolt axis to the end of the pressure; more than in a joint, to resolve the
circles."""


def make_joint(options: str, folder: Path) -> ParameterFile:
    """Joint of a drawing whose bolts have zero stiffness."""
    path = folder / "plate.toml"
    words = f"new bolted-joint {options} --embedding 0 --material steel --Ra 0.8 --out {path}"
    with redirect_stdout(StringIO()):
        if cli.main(words.split()):
            raise SystemExit(f"{words} failed")
    return load_parameter_file(path).with_values({"bolt_stiffness": 0.0}, "user", "the interface alone")


def compute_pressure(file: ParameterFile, options: str) -> PressureDistribution:
    """Contact pressure of two elastic plates by finite elements."""
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
            TappedPlate(**flatten_parameters(side) | {"thickness": second, "depth": thread.nominal_diameter}),
        ]
    bolts = BoltList(
        x=pattern.x,
        y=pattern.y,
        hole_diameter=pattern.hole_diameter,
        head_diameter=thread.hexagon_bearing_diameter,
    )
    contact = BoltedContact.from_assembly(Assembly(file.name, *sides, bolts))
    preload = file.start_value("preload")
    field = contact.solve_equilibrium(tabulate_approach(file.values), preload).contact_field
    return normalise_pressure_field(replace(file.values, A_0=float(field.nodal_area.sum())), field, preload)


def format_pressure(file: ParameterFile, shape: PressureDistribution, fine: PressureDistribution) -> str:
    """Format two lines: force inside the circles, and stiffness of the joint."""
    bolts = file.values.pattern.bolt_positions
    apart = np.hypot(*np.moveaxis(fine.position[:, None, :] - bolts, -1, 0)).min(axis=1)
    force, rest = fine.area_share * fine.preload_pressure_ratio, (0.0, 0.0, 0.0)
    shares = "  ".join(f"{force[apart < r].sum():.3f} in {r * 1e3:g} mm" for r in RADII)
    shares += f"  radius of gyration {1e3 * np.sqrt(force @ apart**2):.4g} mm"
    spring = BoltedJointSpring.from_interface_nodes(file.values, shape)
    state = spring.evaluate(file.start_value("preload"), 0.0, rest, rest)
    return f"{shares}\n  {'':9} " + "  ".join(f"{name} {float(state[name]):.4g}" for name in OUTPUTS)


def print_pressures() -> None:
    """Print the contact pressure by pressure cones and by finite elements."""
    usual = plate.MIN_CELLS_PER_PRESSURE_RADIUS
    for name, options in PLATES.items():
        print(name)
        with tempfile.TemporaryDirectory() as folder:
            file = make_joint(options, Path(folder))
        cones = file.values.pattern.pressure_distribution()
        plate.MIN_CELLS_PER_PRESSURE_RADIUS = FINE_CELLS
        fine = file.values.pattern.pressure_distribution()
        plate.MIN_CELLS_PER_PRESSURE_RADIUS = usual
        elastic = compute_pressure(file, options)
        for what, shape, finer in (("cones", cones, fine), ("computed", elastic, elastic)):
            print(f"  {what:9} {format_pressure(file, shape, finer)}")


# attachments

STIFFNESSES = ("xx", "yy", "zz", "rx", "ry", "rz")


def compute_joint_results(attached: str, example: dict[str, object]) -> dict[str, float]:
    """Results {name: value} that `jointfmu new bolted-joint` prints for an attached or clamped joint."""
    options = (
        dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options)
        | example
        | {"attached": attached}
    )
    return {name: value for name, (value, _, _) in dict(NEW_JOINT_COMMAND.make_joint(options).facts).items()}


def print_attachments() -> None:
    """Print stiffness and load factor for each attachment, and of a joint with one bolt compared with VDI
    2230."""
    print_table_head("", "attached", *(f"K_{name}" for name in STIFFNESSES), "load factor", "interface")
    for attached in ("faces", "edge", "heads"):
        found = compute_joint_results(attached, EXAMPLE)
        cells = [f"{found[f'joint_K_{name}']:.3g}" for name in STIFFNESSES]
        print_table_row(
            f"`{attached}`", *cells, f"{found['joint_load_factor']:.3f}", f"{found['interface_share']:.1%}"
        )
    found = compute_joint_results(
        "heads", EXAMPLE | {"plate": "80x80", "bolts": "M16", "at": None, "preload": "60e3"}
    )
    members = found["joint_K_zz"] - found["bolt_stiffness"]
    print(f"\none M16, heads: members with interface {members:.4g} N/m, ", end="")
    print(f"VDI 2230 {found['member_stiffness']:.4g};")
    print(f"load factor {found['joint_load_factor']:.4f}, VDI 2230 {found['load_factor']:.4f}")


# bed

BRACKET = {
    "plate": "180x120",
    "bolts": "6xM10",
    "at": ["140x80"],
    "grid": "3x2",
    "grip": ["30"],
    "tapped": True,
    "material": ["cast iron", "steel"],
    "Ra": ["0.8", "3.2"],
    "torque": "45",
}
"""Options of a cast bracket with a foot 30 mm thick on a steel bed."""
BEDS = (
    *(("faces", thickness, None) for thickness in (20, 40, 60, 100, 200)),
    ("heads", 60, None),
    *(("faces", thickness, (0.54, 0.36)) for thickness in (100, 150)),
)
"""Attachment, thickness of side 2 [mm], and its length and width [m]; None: those of the foot."""


def print_beds() -> None:
    """Print the stiffness of a bracket on a bed by finite elements, by thickness and size of the bed."""
    print_table_head("", "attached", "T2 [mm]", "bed", *(f"K_{name}" for name in STIFFNESSES), "interface")
    for attached, thickness, size in BEDS:
        options = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | BRACKET
        drawn = read_drawing(options | {"thickness": ["30", str(thickness)]})
        assembly = drawn.bolted_plates.make_assembly(drawn.parameter_file)
        if size:
            length, width = size
            assembly = replace(assembly, side2=replace(assembly.side2, length=length, width=width))
        model = JointFiniteElements.from_assembly(assembly, attached)
        preload, values = drawn.bolted_plates.preload, drawn.parameter_file.values
        springs = plate_finite_elements._interface_stiffness(drawn.parameter_file, preload, model, None)
        found = model.linearise_joint(springs, values.bolt_stiffness).compliances()
        bed = "x".join(f"{1e3 * each:g}" for each in size) if size else "as the foot"
        cells = [f"{stiffness:.3g}" for stiffness in 1.0 / found.total_compliance]
        print_table_row(f"`{attached}`", thickness, bed, *cells, f"{found.compliance_shares[0, 2]:.0%}")


# opening


def print_opening_moments() -> None:
    """Print the moments that open the bracket: by hand, of the complete joint, and of the outer bolts."""
    options = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options)
    file = NEW_JOINT_COMMAND.make_joint(options | BRACKET | {"thickness": ["30", "60"]}).parameter_file
    spring, preload = BoltedJointSpring.from_joint(file.values), file.start_value("preload")
    force, pattern = preload - file.values.embedding, file.values.pattern
    bolts = pattern.bolt_positions_from_middle
    names, still = ("K_rx", "K_ry"), (0.0, 0.0, 0.0)
    tightened = spring.evaluate(preload, 0.0, still, still)
    print_table_head("", "about", "uniform pressure", "complete joint", "outer bolts", "K, change")
    for axis, size in enumerate((pattern.width, pattern.length)):
        lever = bolts[:, 1 - axis]
        found = compute_opening_moment(spring, preload, 0.0, axis)
        load = ExternalLoad(spring, preload, 0.0, direction=3 + axis)
        state = load.unloaded_state
        for part in np.linspace(0.1, 1.0, 10):
            state = load.solve_equilibrium(part * found, state)
        opened = spring.evaluate(preload, 0.0, tuple(state[:3]), still, tuple(state[3:6]))
        moments = (len(bolts) * force * size / 6.0, found, force * (lever @ lever) / lever.max())
        change = opened[names[axis]] / tightened[names[axis]] - 1.0
        print_table_row("xy"[axis], *(f"{1e-3 * moment:.2f} kN m" for moment in moments), f"{change:+.0%}")


if __name__ == "__main__":
    sections = {"pressure": print_pressures, "attachments": print_attachments}
    run_study(__doc__, sections | {"bed": print_beds, "opening": print_opening_moments})
