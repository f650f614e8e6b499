"""The two faces of a contact on a drawing: material, and roughness from finish, Ra, Rq, Rz or a scan.

This module also computes the Hertzian line contact of curved faces.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from jointfmu.contact import roughness
from jointfmu.contact.laws import ROUGHNESS_LAW_NAME, TABLE_LAW_NAME
from jointfmu.contact.surface import ElasticConstants, contact_modulus, contact_shear_modulus
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Number

from ...common.judgement import find_rms_height
from ...common.options import Option, format_option_flag
from .. import fractal
from ..catalogue import SourcedNumber
from ..surfaces import form, reading
from ..surfaces.bearing_curve import lognormal_tail_over_rms_height
from ..surfaces.scan_text import parse_spacing
from .interface_table import add_interface_table
from .part import DrawingOptions, ParameterSheet
from .quantities import StatedNumber, parse_quantity
from .reading import expand_to_sides, parse_number
from .tables import MaterialOrFinish, find_table_row, read_material_or_finish_table

FACE_OPTIONS = (
    Option(
        "material",
        "material of both sides, or of each side (list: jointfmu new materials)",
        "NAME",
        is_list=True,
        is_required=True,
    ),
    Option(
        "finish",
        "finish of both sides, or of each side (list: jointfmu new finishes): gives the roughness; with "
        "--Ra, --Rq or --Rz, it gives only slope, Hurst exponent and skewness of the heights",
        "NAME",
        is_list=True,
    ),
    Option(
        "Ra", "roughness Ra: one value that both sides have, or one for each side [um]", "RA", is_list=True
    ),
    Option(
        "Rq",
        "rms roughness Rq or Sq: one value that both sides have, or one for each side [um]",
        "RQ",
        is_list=True,
    ),
    Option(
        "Rz",
        "roughness Rz: one value that both sides have, or one for each side [um]; Ra is taken as Rz/6.25, "
        "with the range Rz/10 to Rz/4",
        "RZ",
        is_list=True,
    ),
    Option(
        "surface",
        "file of a measured surface (profile or map): one for both sides, or one for each",
        "SCAN",
        is_list=True,
    ),
    Option("unit", "length unit of --surface files that state none: m, mm, um, nm", "UNIT"),
    Option(
        "spacing",
        "spacing of the points of --surface files that state none, with its unit as in 5um; or two values, "
        "for x and y",
        "LENGTH",
        is_list=True,
    ),
    Option("missing", "number that marks missing points in --surface files, as in -99999.9999"),
    Option(
        "interface_table",
        "CSV table of measured or published stiffness of the interface, in place of the roughness: columns "
        "pressure and stiffness (per area), with units in the heading, for example MPa and N/mm3",
        "FILE",
    ),
    Option(
        "longest_wave",
        "longest wavelength that counts as roughness [mm] (default: cut-off of ISO 4288 for Ra, or the "
        "length of the scan)",
    ),
    Option(
        "hardness", "hardness of the softer side [MPa], or as in 160HB, 180HV (default: that of the material)"
    ),
    Option(
        "mu",
        "coefficient of friction [1], or its range as in 0.1..0.3, whose middle is then the value (default: "
        "0.15, with the range 0.1 to 0.3)",
    ),
)
"""Options of every joint with rough faces."""
_ROUGHNESS_OPTIONS = ("finish", "Ra", "Rq", "Rz", "surface")
"""Options that state the roughness."""
DEFAULT_MU, DEFAULT_MU_LIMITS = 0.15, (0.1, 0.3)
"""Coefficient of friction if the drawing states none, and its range [1]."""
DEFAULT_MU_SOURCE = "usual value of dry machined metal, not measured; VDI 2230, Table A6: 0.1 to 0.3"
"""Source text of the coefficient of friction, if none is stated."""
MAX_USUAL_MU = 0.8
"""Coefficient of friction [1] above which a stated value is doubtful: clean pairs of the same metal, without
oxide or oil, have 0.8 to 1.5."""
DEFAULT_RMS_SLOPE = 0.1
"""Rms slope [1] of a surface if only its height is known."""
DEFAULT_HURST_EXPONENT = 0.8
"""Hurst exponent [1] of a surface if only its height is known."""
DEFAULT_WAVE_FREQUENCY_RATIO = 1.5
"""Frequency ratio gamma of neighbouring waves of the Weierstrass-Mandelbrot function [1]."""
RZ_OVER_RA, RZ_OVER_RA_LIMITS = 6.25, (4.0, 10.0)
"""Ratio Rz/Ra of machined faces [1] and its range: Rz 10 um for Ra 1.6 um, as on drawings; turned faces have
4 to 5, ground and lapped ones 7 to 10."""
RZ_OVER_RA_SOURCE = (
    "usual of machined faces, turned 4 to 5, ground and lapped 7 to 10; nominal pairs of drawings"
)
"""Source text of the ratio Rz/Ra."""
CUT_OFF_WAVELENGTHS_BY_RA = (
    (0.02e-6, 0.08e-3),
    (0.1e-6, 0.25e-3),
    (2e-6, 0.8e-3),
    (10e-6, 2.5e-3),
    (np.inf, 8e-3),
)
"""(largest Ra [m], cut-off wavelength [m]) (ISO 4288, Table 1; ISO 21920-3)."""


class FaceRoughness(NamedTuple):
    """Roughness of one face of the contact.

    Rq                        : rms height [m]
    Rq_min, Rq_max            : lower and upper limit of the rms height [m]
    Rz                        : maximum height [m], as stated, or RZ_OVER_RA times Ra
    rms_slope, hurst_exponent : rms slope [1], Hurst exponent [1]
    longest_wave              : longest wavelength [m] that contributes to the rms height
    height_source             : source of the height
    stated_heights            : {key of the section [roughness] without the number of the side: height [m]}
    is_from_finish            : whether a finish alone gives the height
    skewness_range            : smallest and largest skewness [1] of the finish, or of all finishes if none is
                                stated; None: the heights are those of a scan
    """

    Rq: float
    Rq_min: float
    Rq_max: float
    Rz: float
    rms_slope: SourcedNumber
    hurst_exponent: SourcedNumber
    longest_wave: SourcedNumber
    height_source: str
    stated_heights: dict[str, float]
    is_from_finish: bool = False
    skewness_range: tuple[float, float] | None = None


def read_materials(drawing_options: DrawingOptions) -> tuple[MaterialOrFinish, MaterialOrFinish]:
    """Read the materials of the two sides. Raises ValueError for a name that the table does not have."""
    names = expand_to_sides("material", drawing_options["material"])
    assert names is not None  # the option is required
    return find_table_row("materials", names[0]), find_table_row("materials", names[1])


class HeightRange(NamedTuple):
    """Range of the combined rms height h = sqrt(Rq1^2 + Rq2^2) of both faces, and the larger of their Rz.

    h_min, h_max : lower and upper limit of h [m]
    Rz           : larger maximum height of the two faces [m]
    """

    h_min: float
    h_max: float
    Rz: float


def choose_interface_law(drawing_options: DrawingOptions) -> str:
    """Choose the interface law of a new joint (its name) by the options of `jointfmu new`.

    Raises ValueError if --law contradicts --interface-table.
    """
    stated = drawing_options.get("law")
    if drawing_options["interface_table"] and stated:
        raise ValueError(f"--law {stated} and --interface-table both state the law; state one of them")
    return TABLE_LAW_NAME if drawing_options["interface_table"] else stated or ROUGHNESS_LAW_NAME


def add_face_parameters(
    parameter_sheet: ParameterSheet, drawing_options: DrawingOptions
) -> HeightRange | None:
    """Add material, friction and roughness parameters of the two contact faces to a parameter sheet.

    Returns the range of the heights; None if the stiffness is a table and no roughness is stated.

    Raises ValueError, one line: unknown names, roughness not stated or stated twice, a bad number, scan or
    table.
    """
    pair = read_materials(drawing_options)
    for prefix, material in zip(("side1", "side2"), pair, strict=True):
        for name in ("E", "nu", "alpha"):
            known = material.sourced_numbers[name]
            parameter_sheet.add_parameter(
                f"{prefix}.{name}",
                known.si_value,
                known.value_origin,
                f"{material.display_title}: {known.value_source}",
            )
    soft = min(pair, key=lambda material: material.sourced_numbers["H"].si_value)
    if drawing_options["hardness"] is None:
        known = soft.sourced_numbers["H"]
        parameter_sheet.add_parameter(
            "H", known.si_value, known.value_origin, f"{soft.display_title}: {known.value_source}"
        )
    else:
        parameter_sheet.add_drawing_number("H", parse_quantity("hardness", drawing_options["hardness"]))
    if drawing_options["mu"] is None:
        parameter_sheet.add_parameter("mu", DEFAULT_MU, "estimate", DEFAULT_MU_SOURCE)
        if "mu" not in KINDS[parameter_sheet.joint_kind].models[0].fixed_parameters:  # gears have no shear
            parameter_sheet.set_parameter_range("mu", *DEFAULT_MU_LIMITS)
    else:
        parameter_sheet.add_drawing_number("mu", parse_quantity("mu", drawing_options["mu"]))
    parameter_sheet.add_parameter("traction_ratio", 0.1, "estimate", "vibration far below slip")
    if drawing_options["interface_table"]:
        sides = [ElasticConstants(**{n: m.sourced_numbers[n].si_value for n in ("E", "nu")}) for m in pair]
        ratio = 4.0 * contact_shear_modulus(*sides) / contact_modulus(*sides)
        add_interface_table(parameter_sheet, Path(drawing_options["interface_table"]), float(ratio))
        if not any(drawing_options[name] for name in _ROUGHNESS_OPTIONS):
            return None
    return _add_roughness(
        parameter_sheet, read_face_roughness(drawing_options), drawing_options["longest_wave"]
    )


def _add_roughness(
    parameter_sheet: ParameterSheet, faces: tuple[FaceRoughness, FaceRoughness], longest_wave: str | None
) -> HeightRange:
    """Add the combined roughness of both faces to a parameter sheet; return the range of its rms height."""
    h, low, high = (
        float(roughness.combine_heights(*(getattr(face, name) for face in faces)))
        for name in ("Rq", "Rq_min", "Rq_max")
    )
    texts = "; ".join(f"side {i + 1}: {face.height_source}" for i, face in enumerate(faces))
    spread = f"; {low * 1e6:.3g} to {high * 1e6:.3g} um with the ranges of the heights" if high > low else ""
    parameter_sheet.add_parameter(
        "h",
        h,
        "estimate" if high > low else "derived",
        f"sqrt(Rq1^2 + Rq2^2), Rq = {roughness.RQ_OVER_RA:.4g} Ra; {texts}{spread}",
    )
    if high > low and not any(face.is_from_finish for face in faces):
        parameter_sheet.set_parameter_range("h", low, high)
    _add_roughness_law_gamma(parameter_sheet, faces, h)
    longest = max((face.longest_wave for face in faces), key=lambda known: known.si_value)
    if longest_wave is None:
        parameter_sheet.add_sourced_number("longest_wave", longest)
    else:
        parameter_sheet.add_drawing_number("longest_wave", parse_quantity("longest_wave", longest_wave))
    rough = max(faces, key=lambda face: face.Rq)
    parameter_sheet.add_sourced_number("hurst", rough.hurst_exponent)
    slopes = [face.rms_slope for face in faces]
    value = float(roughness.combine_heights(*(known.si_value for known in slopes)))
    parameter_sheet.add_parameter(
        "slope",
        value,
        "estimate",
        "both sides together; " + "; ".join({known.value_source for known in slopes}),
    )
    _add_fractal_parameters(parameter_sheet)
    for i, face in enumerate(faces):
        kind = "estimate" if face.Rq_max > face.Rq_min else "user"
        parameter_sheet.roughness_heights |= {
            f"{name}{i + 1}": (v, kind, face.height_source) for name, v in face.stated_heights.items()
        }
    return HeightRange(low, high, max(face.Rz for face in faces))


def _add_roughness_law_gamma(
    parameter_sheet: ParameterSheet, faces: tuple[FaceRoughness, FaceRoughness], combined_rms_height: float
) -> None:
    """Add gamma [1] of the law stiffness = pressure/(gamma h) to a parameter sheet; h: combined rms height.

    The value holds for Gaussian heights. Its range follows from the skewness of the finishes, and contains
    the value: honed faces, for example, have negative skewness only.
    """
    text = "boundary elements: 0.40 to 0.48 (docs/validity.md)"
    ends = [face.skewness_range for face in faces if face.skewness_range]
    if len(ends) < len(faces):
        parameter_sheet.add_parameter("gamma", roughness.PERSSON_GAMMA, "derived", text)
        return
    low, high = (
        sum(end[i] * face.Rq**3 for end, face in zip(ends, faces, strict=True)) / combined_rms_height**3
        for i in (0, 1)
    )
    text += f"; range: skewness {low:.2g} to {high:.2g} of both sides together (docs/surfaces_explanation.md)"
    parameter_sheet.add_parameter("gamma", roughness.PERSSON_GAMMA, "estimate", text)
    limits = [
        roughness.PERSSON_GAMMA * lognormal_tail_over_rms_height(skewness)
        for skewness in (min(low, 0.0), max(high, 0.0))
    ]
    parameter_sheet.set_parameter_range("gamma", *limits)


def warn_unknown_height_distribution(drawing_options: DrawingOptions) -> list[str]:
    """List a warning if only Ra, Rq or Rz is stated: the distribution of the heights is then unknown."""
    stated = [name for name in ("Ra", "Rq", "Rz") if drawing_options.get(name)]
    if (
        not stated
        or drawing_options.get("finish")
        or choose_interface_law(drawing_options) != ROUGHNESS_LAW_NAME
    ):
        return []
    return [
        f"{stated[0]} alone does not state the height distribution: with plateaus (ground, honed or lapped "
        "faces) the interface is up to several times stiffer; the range of gamma in the file is that of all "
        "finishes; state --finish for a narrower range, or use measured heights (jointfmu surface)"
    ]


def warn_unusual_friction(drawing_options: DrawingOptions) -> list[str]:
    """List a warning if the stated coefficient of friction is larger than that of machined faces in air."""
    if drawing_options.get("mu") is None:
        return []
    mu = parse_quantity("mu", drawing_options["mu"]).upper_limit
    if mu <= MAX_USUAL_MU:
        return []
    low, high = DEFAULT_MU_LIMITS
    return [
        f"mu = {mu:g} is above {MAX_USUAL_MU:g}, which only clean pairs of the same metal exceed; dry "
        f"machined metal has {low:g} to {high:g} (VDI 2230, Table A6). The slip force is proportional to mu"
    ]


def _add_fractal_parameters(parameter_sheet: ParameterSheet) -> None:
    """Add fractal dimension D and fractal roughness G of surface profiles, for laws that need them.

    D and G follow from the rms height, the longest wave and the Hurst exponent in the parameter sheet.
    """
    h, wave, hurst = (parameter_sheet.get_parameter_value(name) for name in ("h", "longest_wave", "hurst"))
    D, text = 2.0 - hurst, f"rms height {h:.3g} m of all waves up to {wave:g} m"
    parameter_sheet.add_parameter("surface.D", D, "estimate", f"2 - H with the Hurst exponent {hurst:g}")
    parameter_sheet.add_parameter("surface.G", fractal_roughness(D, h, wave), "derived", text)
    parameter_sheet.add_parameter(
        "surface.gamma", DEFAULT_WAVE_FREQUENCY_RATIO, "estimate", "the usual value"
    )


def fractal_roughness(D: float, surface_rms_height: float, longest_wave: float) -> float:
    """Fractal roughness G [m] of profiles with dimension D [1], from the rms height of the surface.

    surface_rms_height : rms height [m] of all waves up to `longest_wave` [m]
    """

    def rms_height(G: Number) -> Number:
        """Rms height [m] of the surface with the fractal roughness G [m]."""
        return fractal.rms_height(D, G, longest_wave)

    # h grows as G^(D - 1)
    return float((surface_rms_height / rms_height(1.0)) ** (1.0 / (D - 1.0)))


def read_face_roughness(drawing_options: DrawingOptions) -> tuple[FaceRoughness, FaceRoughness]:
    """Read the roughness of the two faces.

    Raises ValueError if the roughness is not stated or is given twice, or for a bad number or scan.
    """
    heights = [name for name in ("Ra", "Rq", "Rz", "surface") if drawing_options[name]]
    finishes = expand_to_sides("finish", drawing_options["finish"])
    if len(heights) > 1:
        raise ValueError(
            f"{' and '.join(map(format_option_flag, heights))} are given together; state the roughness once"
        )
    if heights == ["surface"] and finishes:
        raise ValueError("--surface and --finish are both given; state one of them: a scan has its own slope")
    if not heights:
        if finishes is None:
            raise ValueError(
                "the roughness is missing; expected --finish, --Ra, --Rq, --Rz, --surface or "
                "--interface-table"
            )
        return _roughness_from_finish(finishes[0]), _roughness_from_finish(finishes[1])
    name = heights[0]
    texts = expand_to_sides(name, drawing_options[name])
    assert texts is not None  # `heights` has set options only
    if name == "surface":
        first = _roughness_from_scan(texts[0], drawing_options)
        return first, first if texts[1] == texts[0] else _roughness_from_scan(texts[1], drawing_options)
    rows = (
        (find_table_row("finishes", finishes[0]), find_table_row("finishes", finishes[1]))
        if finishes
        else (None, None)
    )
    pair = [
        _roughness_from_stated_height(name, text, finish) for text, finish in zip(texts, rows, strict=True)
    ]
    return pair[0], pair[1]


def _cut_off_wavelength(Ra: float) -> SourcedNumber:
    """Cut-off wavelength [m] of a roughness measurement, by the arithmetic mean height Ra [m]."""
    wave = next(cut_off for up_to, cut_off in CUT_OFF_WAVELENGTHS_BY_RA if Ra <= up_to)
    return SourcedNumber(
        wave, "estimate", f"cut-off of Ra {Ra * 1e6:.3g} um (ISO 4288): Ra contains no longer waves"
    )


def _roughness_from_finish(finish_name: str) -> FaceRoughness:
    """Roughness of a face with a finish of the table (turned, ground, ...)."""
    known = find_table_row("finishes", finish_name)
    Ra, low, high = (known.sourced_numbers[key].si_value for key in ("Ra", "Ra_low", "Ra_high"))
    text = (
        f"{known.display_title}, Ra {low * 1e6:.3g} to {high * 1e6:.3g} um, taken as {Ra * 1e6:.3g} um "
        f"({known.sourced_numbers['Ra_low'].value_source})"
    )
    Rq, Rq_low, Rq_high = (float(roughness.rms_height(value)) for value in (Ra, low, high))
    slope, hurst = known.sourced_numbers["slope"], known.sourced_numbers["hurst"]
    wave = _cut_off_wavelength(Ra)
    return FaceRoughness(
        Rq,
        Rq_low,
        Rq_high,
        RZ_OVER_RA * Ra,
        slope,
        hurst,
        wave,
        text,
        {"Ra": Ra},
        is_from_finish=True,
        skewness_range=_skewness_limits(known),
    )


def _skewness_limits(*surface_finishes: MaterialOrFinish) -> tuple[float, float]:
    """Smallest and largest skewness of the heights [1] that one of the finishes may have."""
    low, high = (
        [finish.sourced_numbers[column].si_value for finish in surface_finishes]
        for column in ("skewness_low", "skewness_high")
    )
    return min(low), max(high)


def _roughness_from_stated_height(
    roughness_name: str, height_text: str, surface_finish: MaterialOrFinish | None
) -> FaceRoughness:
    """Roughness of a face from one stated height: Ra, Rq or Rz."""
    stated = parse_quantity(roughness_name, height_text)
    text = f"{roughness_name} {stated.stated_value * 1e6:.4g} um of the drawing"
    if stated.is_range:
        text += f", {stated.lower_limit * 1e6:.4g} to {stated.upper_limit * 1e6:.4g} um"
    key, height = roughness_name, stated
    if roughness_name == "Rz":
        low, high = RZ_OVER_RA_LIMITS
        key = "Ra"
        height = StatedNumber(
            stated.stated_value / RZ_OVER_RA, stated.lower_limit / high, stated.upper_limit / low
        )
        text += f", Ra = Rz/{RZ_OVER_RA:g}, from Rz/{high:g} to Rz/{low:g} ({RZ_OVER_RA_SOURCE})"
    Rq, Rq_low, Rq_high = height if key == "Rq" else (float(roughness.rms_height(Ra)) for Ra in height)
    slope = SourcedNumber(DEFAULT_RMS_SLOPE, "estimate", "usual value of machined surfaces")
    hurst = SourcedNumber(DEFAULT_HURST_EXPONENT, "estimate", "usual value of machined surfaces, 0.7 to 0.9")
    if surface_finish:
        slope, hurst = surface_finish.sourced_numbers["slope"], surface_finish.sourced_numbers["hurst"]
    Ra = Rq / roughness.RQ_OVER_RA
    Rz = stated.stated_value if roughness_name == "Rz" else RZ_OVER_RA * Ra
    wave = _cut_off_wavelength(Ra)
    shape = _skewness_limits(
        *([surface_finish] if surface_finish else read_material_or_finish_table("finishes").values())
    )
    return FaceRoughness(
        Rq, Rq_low, Rq_high, Rz, slope, hurst, wave, text, {key: height.stated_value}, skewness_range=shape
    )


def _roughness_from_scan(scan_path: str, drawing_options: DrawingOptions) -> FaceRoughness:
    """Roughness of a face from a scan.

    drawing_options : unit, spacing and missing value of files that do not state them
    """
    spacing, missing = drawing_options["spacing"], drawing_options["missing"]
    heights = reading.read_heights(
        Path(scan_path),
        drawing_options["unit"],
        point_spacing=parse_spacing(spacing) if spacing else None,
        missing_value=None if missing is None else parse_number("missing", missing, "1", "1", None),
    )
    prepared = form.prepare_scan(heights)
    longest = form.default_longest_wave(prepared.filled_heights)
    scan = form.compute_scan_roughness(prepared.heights_with_gaps, prepared.filled_heights, longest)
    source = f"scan {Path(scan_path).name}"
    return FaceRoughness(
        scan.long_wave_rms_height,
        scan.long_wave_rms_height,
        scan.long_wave_rms_height,
        RZ_OVER_RA * scan.long_wave_rms_height / roughness.RQ_OVER_RA,
        SourcedNumber(scan.rms_slope, "measured", f"{source}, waves down to {scan.shortest_wave:.3g} m"),
        SourcedNumber(DEFAULT_HURST_EXPONENT, "estimate", "usual value of machined surfaces, 0.7 to 0.9"),
        SourcedNumber(longest, "measured", f"length of the {source}"),
        f"{source}, waves up to {longest:.3g} m, skewness {scan.height_sample.standardized_moment(3):.2f}",
        {"Rq": scan.long_wave_rms_height},
    )


def derive_rms_height(parameter_file: ParameterFile) -> dict[str, tuple[float, str, str]]:
    """Combined rms height of both faces of a joint: {"h": (value, unit, meaning)}; empty if unknown."""
    h = find_rms_height(parameter_file)
    return {} if h is None else {"h": (float(h), "m", "combined rms height of both faces")}


def warn_pressure_above_hardness(peak_pressure: float, hardness: float) -> list[str]:
    """Warning if the greatest pressure [Pa] exceeds the hardness [Pa], where the law ends; else empty."""
    if peak_pressure <= hardness:
        return []
    return [
        f"the largest contact pressure, {peak_pressure:.4g} Pa, is above the hardness, {hardness:.4g} Pa, "
        "where the interface law ends: results are an extrapolation"
    ]


class LineContact(NamedTuple):
    """Result for a Hertzian line contact: half width [m], area [m2] and greatest pressure [Pa]."""

    half_width: Number
    area: Number
    peak_pressure: Number


def hertz_line_contact(
    normal_load: Number, contact_length: Number, relative_curvature: Number, contact_modulus: Number
) -> LineContact:
    """Hertzian line contact of two cylinders under a load [N] (Johnson, Contact Mechanics, Eqs. 4.43-4.45).

    contact_length     : length of the contact line [m]
    relative_curvature : relative curvature 1/R_1 + 1/R_2 [1/m], above 0
    contact_modulus    : contact modulus E* [Pa]
    """
    half = np.sqrt(4.0 * normal_load / (np.pi * contact_length * contact_modulus * relative_curvature))
    return LineContact(half, 2.0 * half * contact_length, 2.0 * normal_load / (np.pi * half * contact_length))
