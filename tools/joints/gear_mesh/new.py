"""`jointfmu new` for a gear mesh: two external gear wheels, from their geometry and surface finish."""

from dataclasses import dataclass

import numpy as np

from jointfmu.contact.surface import ElasticConstants, contact_modulus
from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import GearMeshSpring

from ...common.options import Option, option_flag
from ...inputs.drawing import faces
from ...inputs.drawing.faces import FACE_OPTIONS, hertz_line_contact
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand, ParameterSheet
from ...inputs.drawing.quantities import parse_quantity, parse_value

E_STEEL = 206e9
"""Young's modulus [Pa] of steel wheels for which ISO 6336-1 states the stiffness."""
STIFFNESS_CORRECTION = 0.8
"""Factor C_M of ISO 6336-1: measured over theoretical single stiffness [1]."""
REFERENCE_LINE_LOAD = 100e3
"""Tangential load per face width [N/m] below which ISO 6336-1 reduces the tooth stiffness."""
DAMPING_RATIO = 0.06
"""Damping ratio [1] of the oscillation of both wheels, as solid discs, on the mesh stiffness."""


@dataclass(frozen=True, slots=True)
class InvoluteGearPair:
    """Two external involute gear wheels without profile shift, with an addendum of one module.

    normal_module  : [m] normal module
    tooth_counts   : number of teeth of both wheels
    face_width     : [m] common face width
    pressure_angle : [rad] normal pressure angle
    helix_angle    : [rad] at the reference circle
    """

    normal_module: float
    tooth_counts: tuple[float, float]
    face_width: float
    pressure_angle: float
    helix_angle: float

    @property
    def transverse_angle(self) -> float:
        """Transverse pressure angle alpha_t [rad]: tan(alpha_t) = tan(alpha_n)/cos(beta)."""
        return float(np.arctan(np.tan(self.pressure_angle) / np.cos(self.helix_angle)))

    @property
    def reference_radii(self) -> tuple[float, float]:
        """Radii of both reference circles [m]."""
        first, second = (0.5 * self.normal_module * z / np.cos(self.helix_angle) for z in self.tooth_counts)
        return float(first), float(second)

    @property
    def base_radii(self) -> tuple[float, float]:
        """Radii of both base circles [m]: r cos(alpha_t)."""
        first, second = (r * np.cos(self.transverse_angle) for r in self.reference_radii)
        return float(first), float(second)

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio epsilon_alpha [1] (ISO 21771).

        The mean total length of the contact lines is epsilon_alpha width/cos(beta_b), for any overlap ratio.
        """
        (r1, r2), base = self.reference_radii, self.base_radii
        path = sum(
            np.sqrt((r + self.normal_module) ** 2 - b**2) for r, b in zip((r1, r2), base, strict=True)
        ) - (r1 + r2) * np.sin(self.transverse_angle)
        return float(path / (2.0 * np.pi * base[0] / self.tooth_counts[0]))

    @property
    def overlap_ratio(self) -> float:
        """Overlap ratio epsilon_beta [1] (ISO 21771): phase shift over the face width, in mesh cycles."""
        return float(self.face_width * np.sin(self.helix_angle) / (np.pi * self.normal_module))

    @property
    def relative_curvature(self) -> float:
        """Relative curvature 1/R_1 + 1/R_2 [1/m] at the pitch point, in the section normal to the flanks."""
        base_helix = np.arcsin(np.sin(self.helix_angle) * np.cos(self.pressure_angle))
        curvatures = (np.cos(base_helix) / (r * np.sin(self.transverse_angle)) for r in self.reference_radii)
        return float(sum(curvatures))

    def tooth_stiffness(self, young_moduli: tuple[float, float], torque: float) -> float:
        """Single stiffness c' times width [N/m] of one tooth pair in contact over the full width.

        young_moduli : Young's moduli [Pa] of both wheels
        torque       : [N.m] of wheel 1; below REFERENCE_LINE_LOAD the stiffness is reduced

        ISO 6336-1, method B: solid wheels, no profile shift, K_A = 1, basic rack with a dedendum of 1.2
        modules (C_B is 1 at 20 degrees).
        """
        virtual = [z / np.cos(self.helix_angle) ** 3 for z in self.tooth_counts]
        q = 0.04723 + 0.15551 / virtual[0] + 0.25791 / virtual[1]  # mm um/N
        material = 2.0 / (1.0 / young_moduli[0] + 1.0 / young_moduli[1]) / E_STEEL
        rack = 1.0 - 0.02 * (20.0 - np.degrees(self.pressure_angle))  # C_B
        loaded = min(torque / self.reference_radii[0] / self.face_width / REFERENCE_LINE_LOAD, 1.0) ** 0.25
        theory = 1e9 / q * np.cos(self.helix_angle) * material * self.face_width
        return float(STIFFNESS_CORRECTION * rack * loaded * theory)

    def mesh_stiffness(self, tooth_stiffness: float) -> float:
        """Mesh stiffness c_gamma times width [N/m] of ISO 6336-1.

        tooth_stiffness : [N/m] of one tooth pair
        """
        return tooth_stiffness * (0.75 * self.contact_ratio + 0.25)

    def mesh_damping(self, mesh_stiffness: float, densities: tuple[float, float]) -> float:
        """Damping [N.s/m] along the line of action: 2 DAMPING_RATIO sqrt(stiffness mass).

        mesh_stiffness : [N/m] of the mesh
        densities      : [kg/m3] of both wheels; mass is that of both wheels in series, as solid discs,
                         reduced to the line of action
        """
        masses = [
            0.5 * np.pi * rho * self.face_width * r**4 / b**2
            for rho, r, b in zip(densities, self.reference_radii, self.base_radii, strict=True)
        ]
        return float(2.0 * DAMPING_RATIO * np.sqrt(mesh_stiffness / (1.0 / masses[0] + 1.0 / masses[1])))


def make_joint(options: DrawingOptions) -> NewJoint:
    """Make the parameters of a gear mesh from the options of a drawing.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    wheels, torque = _parse_wheels(options), parse_value("torque", options["torque"])
    sheet = ParameterSheet(KIND.name, "roughness")
    faces.add_faces(sheet, options)
    moduli = (sheet.value_of("side1.E"), sheet.value_of("side2.E"))
    load = torque / wheels.base_radii[0]
    sides = [ElasticConstants(E=E, nu=sheet.value_of(f"side{i + 1}.nu")) for i, E in enumerate(moduli)]
    hertz = hertz_line_contact(load, wheels.face_width, wheels.relative_curvature, contact_modulus(*sides))
    _add_parameters(sheet, wheels, options, wheels.tooth_stiffness(moduli, torque))
    text = f"Hertz's line contact at the pitch point, one pair under {torque:g} N.m of wheel 1"
    sheet.add("A_0", float(hertz.area), "derived", text)
    file = sheet.build_file(
        f"wheels of module {options['module']}, {wheels.tooth_counts[0]:g} to "
        f"{wheels.tooth_counts[1]:g} teeth"
    )
    spring = GearMeshSpring.tabulate(file.values)
    deflection = float(spring.curve.inverse(load / wheels.contact_ratio))
    stiffness = wheels.contact_ratio * float(spring.curve.derivatives(np.array([deflection]), 1)[1][0])
    facts = {
        "load": (load, "N", "normal force of the mesh at the torque"),
        "p_hertz": (
            float(hertz.peak_pressure),
            "Pa",
            "largest pressure of smooth flanks, one pair in contact",
        ),
        "contact_ratio": (wheels.contact_ratio, "1", "mean number of pairs in contact over the full width"),
        "overlap_ratio": (wheels.overlap_ratio, "1", "mesh cycles over which a helix spreads the contact"),
        "K_tooth": (file.values_by_name["K_tooth"], "N/m", "bending of one pair (ISO 6336-1)"),
        "h": (file.values_by_name["h"], "m", "combined rms height of both flanks"),
        "K": (stiffness, "N/m", "mean stiffness of the mesh at this load"),
        "c_gamma": (
            wheels.mesh_stiffness(file.values_by_name["K_tooth"]),
            "N/m",
            "the same by ISO 6336-1, to compare",
        ),
        "deflection": (deflection, "m", "deflection of a tooth pair at this load"),
    }
    return NewJoint(file, facts, faces.warn_hardness(float(hertz.peak_pressure), file.values_by_name["H"]))


def _parse_wheels(options: DrawingOptions) -> InvoluteGearPair:
    if len(options["teeth"]) != 2:
        raise ValueError(f"--teeth has {len(options['teeth'])} values, expected one of each wheel")
    teeth = [parse_value("teeth", text) for text in options["teeth"]]
    if any(z % 1.0 for z in teeth):
        raise ValueError(f"--teeth = {' '.join(options['teeth'])}: expected whole numbers")
    angles = []
    for name, default, lowest, highest in (
        ("pressure_angle", "20", 0.0, 45.0),
        ("helix_angle", "0", -1.0, 60.0),
    ):
        angle = parse_value(name, options[name] or default)
        if not max(lowest, 0.0) <= np.degrees(angle) < highest or (lowest == 0.0 and angle == 0.0):
            lower_end = "(0" if lowest == 0.0 else "[0"
            raise ValueError(
                f"{option_flag(name)} = {options[name]} deg is outside {lower_end}, {highest:g})"
            )
        angles.append(angle)
    width, module = (parse_value(name, options[name]) for name in ("width", "module"))
    return InvoluteGearPair(module, (teeth[0], teeth[1]), width, angles[0], angles[1])


def _add_parameters(
    parameter_sheet: ParameterSheet,
    gear_pair: InvoluteGearPair,
    options: DrawingOptions,
    tooth_stiffness: float,
) -> None:
    """Add the parameters that follow from the gear geometry to the sheet.

    tooth_stiffness : [N/m] of one tooth pair
    """
    for i, radius in enumerate(gear_pair.base_radii):
        parameter_sheet.add(
            f"r_b{i + 1}", radius, "derived", "m_n z cos(alpha_t)/(2 cos(beta)) of the drawing"
        )
    parameter_sheet.add_drawing_value("teeth1", gear_pair.tooth_counts[0])
    if options["backlash"] is None:
        distance = sum(gear_pair.reference_radii) * 1e3
        min_backlash = 2.0 / 3.0 * (0.06 + 0.0005 * distance + 0.03 * gear_pair.normal_module * 1e3) * 1e-3
        text = f"least backlash of ISO/TR 10064-2, Annex A, at {distance:.4g} mm of centre distance"
        parameter_sheet.add("backlash", min_backlash, "estimate", text)
    else:
        parameter_sheet.add_drawing_number("backlash", parse_quantity("backlash", options["backlash"]))
    parameter_sheet.add(
        "K_tooth", tooth_stiffness, "derived", "single stiffness c' of ISO 6336-1, method B, times the width"
    )
    text = "ISO 21771, addendum of one module, transverse"
    parameter_sheet.add("contact_ratio", gear_pair.contact_ratio, "derived", text)
    parameter_sheet.add(
        "overlap_ratio", gear_pair.overlap_ratio, "derived", "b sin(beta)/(pi m_n) of ISO 21771"
    )
    parameter_sheet.add("engagement", 0.3, "estimate", "see docs/gear_mesh.md")
    density = tuple(material.numbers["density"].value for material in faces.read_materials(options))
    d = gear_pair.mesh_damping(tooth_stiffness * gear_pair.contact_ratio, (density[0], density[1]))
    parameter_sheet.add(
        "d", d, "estimate", f"a damping ratio of {DAMPING_RATIO:g} for the wheels as solid discs"
    )
    for name in ("phi1", "phi2"):
        parameter_sheet.add(f"inputs.{name}", 0.0, "user", "default choice: the middle of the backlash")


NEW_JOINT_COMMAND = NewJointCommand(
    description="the mesh of two external involute wheels without profile shift",
    example="--module 4 --teeth 29 45 --width 20 --torque 150 --material 'hardened steel' --Ra 0.4",
    options=(
        Option("module", "normal module [mm]", "M", is_required=True),
        Option("teeth", "numbers of teeth of wheel 1 and wheel 2", "Z", is_list=True, is_required=True),
        Option("width", "common face width [mm]", "B", is_required=True),
        Option(
            "torque",
            "working torque of wheel 1 [N.m]; it determines the contact patch",
            "T",
            is_required=True,
        ),
        Option("pressure_angle", "normal pressure angle [deg] (default: 20)", "A"),
        Option("helix_angle", "helix angle at the reference circle [deg] (default: 0)", "A"),
        Option(
            "backlash", "backlash along the line of action [um] (default: minimum of ISO/TR 10064-2)", "J"
        ),
        *FACE_OPTIONS,
    ),
    make_joint=make_joint,
)
