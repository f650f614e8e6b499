"""`jointfmu new` for a gear contact: two tooth flanks of equal width, from curvatures and surface finish."""

from ...drawing.faces import OPTIONS
from ...drawing.part import Drawing, Given, NewJoint
from ...joint_parts import Option


def _flanks(given: Given) -> NewJoint:
    from jointfmu.contact.surface import Elastic, contact_modulus
    from jointfmu.joints.gear_contact import KIND
    from jointfmu.joints.gear_contact.spring import GearContactSpring

    from ...drawing import faces
    from ...drawing.faces import patch
    from ...drawing.part import Sheet
    from ...drawing.reading import number

    sheet = Sheet(KIND.name, "roughness")
    faces.put(sheet, given)
    load = number("load", given["load"], "N", "N")
    width = number("width", given["width"], "mm", "m")
    if len(given["radii"]) != 2:
        raise ValueError(f"--radii has {len(given['radii'])} values, expected one of each flank")
    curvature = sum(_curvature(text) for text in given["radii"])
    if not curvature > 0.0:
        raise ValueError(f"--radii = {' '.join(given['radii'])}: the flanks do not bulge towards each other")
    sides = [Elastic(E=sheet.value(f"side{i}.E"), nu=sheet.value(f"side{i}.nu")) for i in (1, 2)]
    hertz = patch(load, width, curvature, contact_modulus(*sides))
    text = f"Hertz's line contact under {load:g} N, {width * 1e3:g} mm wide, 1/R = {curvature:.4g} 1/m"
    sheet.put("A_0", float(hertz.area), "derived", text)
    sheet.stated("inputs.f", load)
    file = sheet.file(f"flanks {given['width']} wide")
    state = GearContactSpring.of(file.values).approach(load)
    facts = {
        "load": (load, "N", "normal load"),
        "half_width": (float(hertz.half_width), "m", "half width of the patch (Hertz)"),
        "p_hertz": (float(hertz.pressure), "Pa", "largest pressure of smooth flanks (Hertz)"),
        "h": (file.flat["h"], "m", "combined rms height of both flanks"),
        "K_N": (float(state["K_N"]), "N/m", "stiffness of the rough interface at this load"),
        "s_rel": (float(state["s_rel"]), "m", "approach of the rough interface at this load"),
    }
    return NewJoint(file, facts, faces.beyond(float(hertz.pressure), file.flat["H"]))


def _curvature(text: str) -> float:
    from ...drawing.reading import number

    if text.strip().lower() in ("inf", "flat"):
        return 0.0
    radius = number("radii", text, "mm", "m", least=None)
    if radius == 0.0:
        raise ValueError("--radii = 0 mm is no radius; expected one, negative where hollow, or flat")
    return 1.0 / radius


NEW = Drawing(
    text="the contact of two tooth flanks under a load",
    example="--width 20 --radii 12 30 --load 2000 --material 'hardened steel' --finish ground",
    options=(
        Option("width", "of the flanks along the line of contact [mm]", "B", required=True),
        Option(
            "radii",
            "of curvature of the two flanks at the contact [mm]; negative where hollow, or flat",
            "R",
            many=True,
            required=True,
        ),
        Option("load", "normal load, which determines the contact patch [N]", "F", required=True),
        *OPTIONS,
    ),
    run=_flanks,
)
