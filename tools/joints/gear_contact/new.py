"""`jointfmu new` for a gear contact: two tooth flanks of equal width, from curvatures and surface finish."""

from ...common.options import Option
from ...inputs.drawing.faces import FACE_OPTIONS
from ...inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand


def _make_joint(options: DrawingOptions) -> NewJoint:
    """Make a gear contact from the options of a drawing."""
    from jointfmu.contact.surface import ElasticConstants, contact_modulus
    from jointfmu.joints.gear_contact import KIND
    from jointfmu.joints.gear_contact.spring import GearContactSpring

    from ...inputs.drawing import faces
    from ...inputs.drawing.faces import hertz_line_contact
    from ...inputs.drawing.part import ParameterSheet
    from ...inputs.drawing.quantities import parse_value

    sheet = ParameterSheet(KIND.name, faces.find_law(options))
    faces.add_faces(sheet, options)
    load = parse_value("load", options["load"])
    width = parse_value("width", options["width"])
    if len(options["radii"]) != 2:
        raise ValueError(f"--radii has {len(options['radii'])} values, expected one of each flank")
    curvature = sum(_parse_curvature(text) for text in options["radii"])
    if not curvature > 0.0:
        raise ValueError(
            f"--radii = {' '.join(options['radii'])}: the flanks do not bulge towards each other"
        )
    sides = [
        ElasticConstants(E=sheet.get_value(f"side{i}.E"), nu=sheet.get_value(f"side{i}.nu")) for i in (1, 2)
    ]
    hertz = hertz_line_contact(load, width, curvature, contact_modulus(*sides))
    text = f"Hertz's line contact under {load:g} N, {width * 1e3:g} mm wide, 1/R = {curvature:.4g} 1/m"
    sheet.add_parameter("A_0", float(hertz.area), "derived", text)
    sheet.add_drawing_value("inputs.f", load)
    file = sheet.build_file(f"flanks {options['width']} wide")
    state = GearContactSpring.tabulate(file.values).evaluate(load)
    facts = {
        "load": (load, "N", "normal load"),
        "half_width": (float(hertz.half_width), "m", "half width of the patch (Hertz)"),
        "p_hertz": (float(hertz.peak_pressure), "Pa", "largest pressure of smooth flanks (Hertz)"),
        **faces.height_fact(file),
        "K_N": (float(state["K_N"]), "N/m", "stiffness of the rough interface at this load"),
        "s_rel": (float(state["s_rel"]), "m", "approach of the rough interface at this load"),
    }
    return NewJoint(file, facts, faces.warn_hardness(float(hertz.peak_pressure), sheet.get_value("H")))


def _parse_curvature(radius_text: str) -> float:
    """Curvature [1/m] of a flank from its radius, positive if convex."""
    from ...inputs.drawing.quantities import parse_value

    if radius_text.strip().lower() in ("inf", "flat"):
        return 0.0
    radius = parse_value("radii", radius_text)
    if radius == 0.0:
        raise ValueError("--radii = 0 mm is not a radius; expected a radius (negative: concave) or flat")
    return 1.0 / radius


NEW_JOINT_COMMAND = NewJointCommand(
    description="the contact of two tooth flanks under a load",
    example="--width 20 --radii 12 30 --load 2000 --material 'hardened steel' --finish ground",
    options=(
        Option("width", "width of the flanks along the line of contact [mm]", "B", is_required=True),
        Option(
            "radii",
            "radius of curvature of each flank at the contact [mm]; negative: concave; flat: plane",
            "R",
            is_list=True,
            is_required=True,
        ),
        Option("load", "normal load, which determines the contact patch [N]", "F", is_required=True),
        *FACE_OPTIONS,
    ),
    make_joint=_make_joint,
)
"""Drawing of a gear contact: its options, and the function that makes the joint."""
