"""`jointfmu new` for a gear mesh: two external gear wheels, from their geometry and surface finish."""

from collections.abc import Sequence

import numpy as np

from jointfmu.contact.surface import ElasticConstants, contact_modulus
from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import GearMeshSpring

from ...common.options import Option, format_option_flag
from ...inputs.drawing import faces
from ...inputs.drawing.faces import FACE_OPTIONS, hertz_line_contact
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand, ParameterSheet
from ...inputs.drawing.quantities import parse_quantity, parse_quantity_value
from .involute import (
    MESH_DAMPING_RATIO,
    STANDARD_DEDENDUM_OVER_MODULE,
    TOOTH_STIFFNESS_SPREAD,
    InvoluteGearPair,
    describe_patch_load,
)


def make_joint(drawing_options: DrawingOptions) -> NewJoint:
    """Make the parameters of a gear mesh from the options of a drawing.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    wheels, torque = (
        _parse_gear_pair(drawing_options),
        parse_quantity_value("torque", drawing_options["torque"]),
    )
    wheels.check_geometry()
    sheet = ParameterSheet(KIND.name, faces.choose_interface_law(drawing_options))
    faces.add_face_parameters(sheet, drawing_options)
    moduli = (sheet.get_parameter_value("side1.E"), sheet.get_parameter_value("side2.E"))
    load = torque / wheels.base_radii[0]
    sides = [
        ElasticConstants(E=E, nu=sheet.get_parameter_value(f"side{i + 1}.nu")) for i, E in enumerate(moduli)
    ]
    hertz = hertz_line_contact(load, wheels.face_width, wheels.relative_curvature, contact_modulus(*sides))
    tooth_stiffness = wheels.tooth_stiffness(moduli, torque)
    _add_mesh_parameters(sheet, wheels, drawing_options, tooth_stiffness)
    sheet.add_parameter("A_0", float(hertz.area), "derived", describe_patch_load(f"{torque:g}"))
    file = sheet.build_parameter_file(
        f"wheels of module {drawing_options['module']}, {wheels.tooth_counts[0]:g} to "
        f"{wheels.tooth_counts[1]:g} teeth"
    )
    spring = GearMeshSpring.tabulate(file.values)
    deflection = float(spring.curve.inverse(load / wheels.contact_ratio))
    stiffness = wheels.contact_ratio * float(spring.curve.derivatives(np.array([deflection]), 1)[1][0])
    c_prime = tooth_stiffness / wheels.face_width
    c_gamma_alpha = wheels.mesh_stiffness(c_prime)
    facts = {
        "load": (load, "N", "normal force of the mesh at the torque"),
        "p_hertz": (
            float(hertz.peak_pressure),
            "Pa",
            "largest pressure of smooth flanks, one pair in contact",
        ),
        "contact_ratio": (wheels.contact_ratio, "1", "mean number of pairs in contact over the full width"),
        "overlap_ratio": (wheels.overlap_ratio, "1", "mesh cycles over which a helix spreads the contact"),
        "K_tooth": (
            file.values_by_name["K_tooth"],
            "N/m",
            "one pair with smooth flanks: bending and flattening (ISO 6336-1)",
        ),
        **faces.derive_rms_height(file),
        "K": (stiffness, "N/m", "mean stiffness of the mesh at this load"),
        "c_gamma": (
            wheels.mesh_stiffness(file.values_by_name["K_tooth"]),
            "N/m",
            "mean stiffness of ISO 6336-1, with another definition (docs/gear_mesh.md)",
        ),
        "c_prime": (
            c_prime,
            "Pa",
            f"single stiffness c' of ISO 6336-1: {c_prime * 1e-9:.4g} N/(mm um)",
        ),
        "c_gamma_alpha": (
            c_gamma_alpha,
            "Pa",
            f"mean mesh stiffness of ISO 6336-1 per width: {c_gamma_alpha * 1e-9:.4g} N/(mm um)",
        ),
        "centre_distance": (wheels.centre_distance, "m", "centre distance without backlash"),
        "working_angle": (wheels.working_angle, "rad", "transverse working pressure angle"),
        "tip_diameter1": (2.0 * wheels.tip_radii[0], "m", "tip diameter of wheel 1"),
        "tip_diameter2": (2.0 * wheels.tip_radii[1], "m", "tip diameter of wheel 2"),
        "deflection": (deflection, "m", "deflection of a tooth pair at this load"),
    }
    hardness_warnings = faces.warn_pressure_above_hardness(
        float(hertz.peak_pressure), sheet.get_parameter_value("H")
    )
    return NewJoint(file, facts, [*wheels.find_geometry_warnings(), *hardness_warnings])


def _parse_gear_pair(drawing_options: DrawingOptions) -> InvoluteGearPair:
    """Gear pair of both wheels, from the options of their geometry."""
    teeth = _parse_two_values("teeth", drawing_options["teeth"])
    if any(z % 1.0 for z in teeth):
        raise ValueError(f"--teeth = {' '.join(drawing_options['teeth'])}: expected whole numbers")
    angles = []
    for name, default, lowest, highest in (
        ("pressure_angle", "20", 0.0, 45.0),
        ("helix_angle", "0", -1.0, 60.0),
    ):
        angle = parse_quantity_value(name, drawing_options[name] or default)
        if not max(lowest, 0.0) <= np.degrees(angle) < highest or (lowest == 0.0 and angle == 0.0):
            lower_end = "(0" if lowest == 0.0 else "[0"
            raise ValueError(
                f"{format_option_flag(name)} = {drawing_options[name]} deg is outside {lower_end}, "
                f"{highest:g})"
            )
        angles.append(angle)
    width, module = (parse_quantity_value(name, drawing_options[name]) for name in ("width", "module"))
    shifts, tips = drawing_options["profile_shift"], drawing_options["tip_diameter"]
    tip_diameters = _parse_two_values("tip_diameter", tips) if tips is not None else None
    gear_pair = InvoluteGearPair(
        module,
        teeth,
        width,
        angles[0],
        angles[1],
        profile_shifts=(0.0, 0.0) if shifts is None else _parse_two_values("profile_shift", shifts),
        stated_tip_radii=(0.5 * tip_diameters[0], 0.5 * tip_diameters[1]) if tip_diameters else None,
        dedendum_over_module=parse_quantity_value(
            "dedendum", drawing_options["dedendum"] or f"{STANDARD_DEDENDUM_OVER_MODULE:g}"
        ),
    )
    if drawing_options["centre_distance"] is not None:
        gear_pair.check_centre_distance(
            parse_quantity_value("centre_distance", drawing_options["centre_distance"])
        )
    return gear_pair


def _parse_two_values(option_name: str, option_texts: Sequence[str]) -> tuple[float, float]:
    """Parse the two numbers of an option for wheel 1 and wheel 2.

    Raises ValueError for another count of numbers, and for a bad number or unit.
    """
    if len(option_texts) != 2:
        raise ValueError(
            f"{format_option_flag(option_name)} has {len(option_texts)} values, expected 2: one for each "
            "wheel"
        )
    return parse_quantity_value(option_name, option_texts[0]), parse_quantity_value(
        option_name, option_texts[1]
    )


def _add_mesh_parameters(
    parameter_sheet: ParameterSheet,
    gear_pair: InvoluteGearPair,
    drawing_options: DrawingOptions,
    tooth_stiffness: float,
) -> None:
    """Add the parameters that follow from the gear geometry to the parameter sheet.

    tooth_stiffness : [N/m] of one tooth pair
    """
    for i, radius in enumerate(gear_pair.base_radii):
        parameter_sheet.add_parameter(
            f"r_b{i + 1}", radius, "derived", "m_n z cos(alpha_t)/(2 cos(beta)) of the drawing"
        )
    parameter_sheet.add_drawing_value("teeth1", gear_pair.tooth_counts[0])
    if drawing_options["backlash"] is None:
        distance = gear_pair.centre_distance * 1e3
        min_backlash = 2.0 / 3.0 * (0.06 + 0.0005 * distance + 0.03 * gear_pair.normal_module * 1e3) * 1e-3
        text = f"least backlash of ISO/TR 10064-2, Annex A, at {distance:.4g} mm of centre distance"
        parameter_sheet.add_parameter("backlash", min_backlash, "estimate", text)
    else:
        parameter_sheet.add_drawing_number(
            "backlash", parse_quantity("backlash", drawing_options["backlash"])
        )
    text = (
        "single stiffness c' of ISO 6336-1, method B, times the width; range: published formulas differ by "
        f"{100 * TOOTH_STIFFNESS_SPREAD:g} % (docs/gear_mesh.md)"
    )
    parameter_sheet.add_parameter("K_tooth", tooth_stiffness, "derived", text)
    parameter_sheet.set_parameter_range(
        "K_tooth",
        (1.0 - TOOTH_STIFFNESS_SPREAD) * tooth_stiffness,
        (1.0 + TOOTH_STIFFNESS_SPREAD) * tooth_stiffness,
    )
    tips = "addendum of one module" if gear_pair.stated_tip_radii is None else "stated tip diameters"
    text = f"ISO 21771, {tips}, transverse"
    parameter_sheet.add_parameter("contact_ratio", gear_pair.contact_ratio, "derived", text)
    parameter_sheet.add_parameter(
        "overlap_ratio", gear_pair.overlap_ratio, "derived", "b sin(beta)/(pi m_n) of ISO 21771"
    )
    parameter_sheet.add_parameter("engagement", 0.3, "estimate", "see docs/gear_mesh.md")
    density = tuple(
        material.sourced_numbers["density"].si_value for material in faces.read_materials(drawing_options)
    )
    d = gear_pair.mesh_damping(tooth_stiffness * gear_pair.contact_ratio, (density[0], density[1]))
    parameter_sheet.add_parameter(
        "d", d, "estimate", f"a damping ratio of {MESH_DAMPING_RATIO:g} for the wheels as solid discs"
    )
    for name in ("phi1", "phi2"):
        parameter_sheet.add_parameter(
            f"inputs.{name}", 0.0, "user", "default choice: the middle of the backlash"
        )


NEW_JOINT_COMMAND = NewJointCommand(
    joint_description="the mesh of two external involute gear wheels",
    example_options="--module 4 --teeth 29 45 --width 20 --torque 150 --material 'hardened steel' --Ra 0.4",
    command_options=(
        Option("module", "normal module [mm]", "M", is_required=True),
        Option("teeth", "number of teeth of wheel 1 and of wheel 2", "Z", is_list=True, is_required=True),
        Option("width", "common face width [mm]", "B", is_required=True),
        Option(
            "torque",
            "working torque on wheel 1 [N.m]; it determines the size of the contact patch",
            "T",
            is_required=True,
        ),
        Option("pressure_angle", "normal pressure angle [deg] (default: 20)", "A"),
        Option("helix_angle", "helix angle at the reference circle [deg] (default: 0)", "A"),
        Option(
            "profile_shift",
            "profile shift coefficients of wheel 1 (the pinion) and wheel 2 [1] (default: 0 0)",
            "X",
            is_list=True,
        ),
        Option(
            "centre_distance",
            "centre distance without backlash [mm], to check: it must agree with --profile-shift",
            "A",
        ),
        Option(
            "tip_diameter",
            "tip diameters of wheel 1 and wheel 2 [mm] (default: for an addendum of one module, with tip "
            "shortening)",
            "D",
            is_list=True,
        ),
        Option("dedendum", "dedendum of the basic rack divided by the module [1] (default: 1.2)", "H"),
        Option(
            "backlash",
            "backlash along the line of action [um] (default: minimum of ISO/TR 10064-2 for this centre "
            "distance)",
            "J",
        ),
        *FACE_OPTIONS,
    ),
    make_joint=make_joint,
)
"""Drawing of a gear mesh: its options, and the function that makes the joint."""
