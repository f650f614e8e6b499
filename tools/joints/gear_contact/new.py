"""`jointfmu new` for a gear contact: two tooth flanks of equal width, from curvatures and surface finish."""

from ...common.options import Option
from ...inputs.drawing.faces import FACE_OPTIONS
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand


def _make_joint(drawing_options: DrawingOptions) -> NewJoint:
    """Make a gear contact from the options of a drawing."""
    from jointfmu.contact.surface import ElasticConstants, contact_modulus
    from jointfmu.joints.gear_contact import KIND
    from jointfmu.joints.gear_contact.spring import GearContactSpring

    from ...inputs.drawing import faces
    from ...inputs.drawing.faces import hertz_line_contact
    from ...inputs.drawing.part import ParameterSheet
    from ...inputs.drawing.quantities import parse_quantity_value

    sheet = ParameterSheet(KIND.name, faces.choose_interface_law(drawing_options))
    faces.add_face_parameters(sheet, drawing_options)
    load = parse_quantity_value("load", drawing_options["load"])
    width = parse_quantity_value("width", drawing_options["width"])
    if len(drawing_options["radii"]) != 2:
        raise ValueError(
            f"--radii has {len(drawing_options['radii'])} values, expected 2: one for each flank"
        )
    curvature = sum(_parse_curvature(text) for text in drawing_options["radii"])
    if not curvature > 0.0:
        raise ValueError(
            f"--radii = {' '.join(drawing_options['radii'])}: expected 1/R1 + 1/R2 above 0; a concave flank "
            "needs the larger radius"
        )
    sides = [
        ElasticConstants(
            E=sheet.get_parameter_value(f"side{i}.E"), nu=sheet.get_parameter_value(f"side{i}.nu")
        )
        for i in (1, 2)
    ]
    hertz = hertz_line_contact(load, width, curvature, contact_modulus(*sides))
    text = f"Hertz's line contact under {load:g} N, {width * 1e3:g} mm wide, 1/R = {curvature:.4g} 1/m"
    sheet.add_parameter("A_0", float(hertz.area), "derived", text)
    sheet.add_drawing_value("inputs.f", load)
    file = sheet.build_parameter_file(f"flanks {drawing_options['width']} wide")
    state = GearContactSpring.tabulate(file.values).evaluate(load)
    facts = {
        "load": (load, "N", "normal load"),
        "half_width": (float(hertz.half_width), "m", "half width of the patch (Hertz)"),
        "p_hertz": (float(hertz.peak_pressure), "Pa", "largest pressure of smooth flanks (Hertz)"),
        **faces.derive_rms_height(file),
        "K_N": (float(state["K_N"]), "N/m", "stiffness of the rough interface at this load"),
        "s_rel": (float(state["s_rel"]), "m", "approach of the rough interface at this load"),
    }
    return NewJoint(
        file,
        facts,
        faces.warn_pressure_above_hardness(float(hertz.peak_pressure), sheet.get_parameter_value("H")),
    )


def _parse_curvature(radius_text: str) -> float:
    """Curvature [1/m] of a flank from its radius, positive if convex."""
    from ...inputs.drawing.quantities import parse_quantity_value

    if radius_text.strip().lower() in ("inf", "flat"):
        return 0.0
    radius = parse_quantity_value("radii", radius_text)
    if radius == 0.0:
        raise ValueError("--radii = 0 mm is not a radius; expected a radius (negative: concave) or flat")
    return 1.0 / radius


NEW_JOINT_COMMAND = NewJointCommand(
    joint_description="the contact of two tooth flanks under a load",
    example_options="--width 20 --radii 12 30 --load 2000 --material 'hardened steel' --finish ground",
    command_options=(
        Option("width", "width of the flanks along the line of contact [mm]", "B", is_required=True),
        Option(
            "radii",
            "radius of curvature of each flank at the contact [mm]: positive convex, negative concave, "
            "flat for a plane",
            "R",
            is_list=True,
            is_required=True,
        ),
        Option(
            "load",
            "normal force between the flanks [N]; it determines the size of the contact patch",
            "F",
            is_required=True,
        ),
        *FACE_OPTIONS,
    ),
    make_joint=_make_joint,
)
"""Drawing of a gear contact: its options, and the function that makes the joint."""
