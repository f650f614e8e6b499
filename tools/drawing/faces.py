"""The two faces of a contact on a drawing: material, and roughness from finish, Ra, Rq or a scan.

Also the Hertzian line contact of curved faces.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from jointfmu.contact import roughness
from jointfmu.quantity import Number

from .. import fractal
from ..catalogue import Printed
from ..command_line.common import flag
from ..joint_parts import Option
from ..surfaces import form, reading
from .part import Given, Sheet
from .reading import both, number
from .tables import TableRow, row

OPTIONS = (
    Option(
        "material",
        "material of both sides, or of each side (jointfmu new materials)",
        "NAME",
        many=True,
        required=True,
    ),
    Option(
        "finish",
        "finish of both sides, or of each side (jointfmu new finishes); with --Ra or --Rq it gives the slope "
        "only",
        "NAME",
        many=True,
    ),
    Option("Ra", "Ra of both sides, or of each side [um]", "RA", many=True),
    Option("Rq", "Rq or Sq of both sides, or of each side [um]", "RQ", many=True),
    Option("surface", "scan of both sides, or of each side", "SCAN", many=True),
    Option("unit", "length unit of scans that state none: m, mm, um, nm", "UNIT"),
    Option("longest_wave", "longest wavelength of the roughness [mm] (default: the cut-off of its Ra)"),
    Option("hardness", "hardness of the softer side [MPa] (default: of the material)"),
    Option("mu", "coefficient of friction [1] (default: 0.15)"),
)
"""Options of every joint with rough faces."""
MU, MU_RANGE = 0.15, (0.1, 0.3)
"""Coefficient of friction if the drawing states none, and its range [1]."""
MU_MOST = 2.0
"""Largest allowed coefficient of friction [1]: clean pairs of the same metal in air have 0.8 to 1.5."""
MU_SOURCE = "dry machined metal: a table of usual values, no measurement; VDI 2230, Table A6 has 0.1 to 0.3"
SLOPE = 0.1
"""Rms slope [1] of a surface if only its height is known."""
HURST = 0.8
"""Hurst exponent [1] of a surface if only its height is known."""
GAMMA_WM = 1.5
"""Frequency ratio of the Weierstrass-Mandelbrot function [1]."""
RZ = 6.3
"""Ratio Rz/Ra of typical machined faces [1], 4 to 10: Rz 10 um for Ra 1.6 um, Rz 40 um for Ra 6.3 um."""
CUT_OFFS = ((0.02e-6, 0.08e-3), (0.1e-6, 0.25e-3), (2e-6, 0.8e-3), (10e-6, 2.5e-3), (np.inf, 8e-3))
"""(largest Ra [m], cut-off wavelength [m]) (ISO 4288, Table 1; ISO 21920-3)."""


class Face(NamedTuple):
    """Roughness of one face.

    Rq             : rms height [m]
    Rq_min, Rq_max : lower and upper limit of the rms height [m]
    slope, hurst   : rms slope [1], Hurst exponent [1]
    longest_wave   : longest wavelength [m] that the height includes
    text           : source of the height
    stated_heights : {key of the section [roughness] without the number of the side: height [m]}
    """

    Rq: float
    low: float
    high: float
    slope: Printed
    hurst: Printed
    wave: Printed
    text: str
    stated: dict[str, float]


def materials(given: Given) -> tuple[TableRow, TableRow]:
    """Read the materials of the two sides. Raises ValueError for a name that the table does not have."""
    names = both("material", given["material"])
    assert names is not None  # the option is required
    return row("materials", names[0]), row("materials", names[1])


class Heights(NamedTuple):
    """Range of the rms height h of both faces together, and Rz of the rougher face.

    h_min, h_max : lower and upper limit [m]
    Rz           : maximum height [m], estimated as RZ_OVER_RA times Ra
    """

    low: float
    high: float
    Rz: float


def put(sheet: Sheet, given: Given) -> Heights:
    """Add the parameters of materials, friction and roughness of the two faces to a parameter sheet.

    Raises ValueError, one line: unknown names, roughness not stated or stated twice, a bad number or scan.
    """
    pair = materials(given)
    for prefix, material in zip(("side1", "side2"), pair, strict=True):
        for name in ("E", "nu"):
            known = material.numbers[name]
            sheet.put(f"{prefix}.{name}", known.value, known.kind, f"{material.title}: {known.source}")
    soft = min(pair, key=lambda material: material.numbers["H"].value)
    if given["hardness"] is None:
        known = soft.numbers["H"]
        sheet.put("H", known.value, known.kind, f"{soft.title}: {known.source}")
    else:
        sheet.stated("H", number("hardness", given["hardness"], "MPa", "Pa"))
    if given["mu"] is None:
        sheet.put("mu", MU, "estimate", MU_SOURCE)
        sheet.between("mu", *MU_RANGE)
    else:
        mu = number("mu", given["mu"], "1", "1")
        if mu > MU_MOST:
            raise ValueError(f"--mu = {given['mu']!r} is outside (0, {MU_MOST:g}]: no metals rub as much")
        sheet.stated("mu", mu)
    sheet.put("traction_ratio", 0.1, "estimate", "vibration far below slip")
    return _heights(sheet, faces(given), given["longest_wave"])


def _heights(sheet: Sheet, pair: tuple[Face, Face], wave: str | None) -> Heights:
    """Add the roughness of both faces together: height, slope, Hurst exponent, longest wave."""
    h, low, high = (
        float(roughness.together(*(getattr(face, name) for face in pair))) for name in ("Rq", "low", "high")
    )
    texts = "; ".join(f"side {i + 1}: {face.text}" for i, face in enumerate(pair))
    spread = f"; {low * 1e6:.3g} to {high * 1e6:.3g} um with the range of the finish" if high > low else ""
    sheet.put(
        "h", h, "estimate" if high > low else "derived", f"sqrt(Rq1^2 + Rq2^2), Rq = 1.25 Ra; {texts}{spread}"
    )
    sheet.put("gamma", roughness.GAMMA, "derived", "boundary elements: 0.40 to 0.48 (docs/validity.md)")
    longest = max((face.wave for face in pair), key=lambda known: known.value)
    if wave is None:
        sheet.take("longest_wave", longest)
    else:
        sheet.stated("longest_wave", number("longest_wave", wave, "mm", "m"))
    rough = max(pair, key=lambda face: face.Rq)
    sheet.take("hurst", rough.hurst)
    slopes = [face.slope for face in pair]
    value = float(roughness.together(*(known.value for known in slopes)))
    sheet.put(
        "slope", value, "estimate", "both sides together; " + "; ".join({known.source for known in slopes})
    )
    _fractal(sheet)
    for i, face in enumerate(pair):
        kind = "estimate" if face.high > face.low else "user"
        sheet.roughness |= {f"{name}{i + 1}": (v, kind, face.text) for name, v in face.stated.items()}
    return Heights(low, high, RZ * rough.Rq / roughness.FACTOR)


def _fractal(sheet: Sheet) -> None:
    """Add D and G of profiles of an isotropic surface with the same rms height, for laws that need them."""
    h, wave, hurst = (sheet.value(name) for name in ("h", "longest_wave", "hurst"))
    D, text = 2.0 - hurst, f"rms height {h:.3g} m of all waves up to {wave:g} m"
    sheet.put("surface.D", D, "estimate", f"2 - H with the Hurst exponent {hurst:g}")
    sheet.put("surface.G", roughness_length(D, h, wave), "derived", text)
    sheet.put("surface.gamma", GAMMA_WM, "estimate", "the usual value")


def roughness_length(D: float, h: float, longest: float) -> float:
    """Fractal roughness G [m] of profiles with dimension D [1], from the rms height of the surface.

    h            : rms height [m] of all waves up to `longest_wave` [m]
    """

    def height(G: Number) -> Number:
        return fractal.height(D, G, longest)

    # h grows as G^(D - 1)
    return float((h / height(1.0)) ** (1.0 / (D - 1.0)))


def faces(given: Given) -> tuple[Face, Face]:
    """Read the roughness of the two faces.

    Raises ValueError if the roughness is not stated or is stated twice, or for a bad number or scan.
    """
    heights = [name for name in ("Ra", "Rq", "surface") if given[name]]
    finishes = both("finish", given["finish"])
    if len(heights) > 1:
        raise ValueError(f"{' beside '.join(map(flag, heights))}: expected one statement of the roughness")
    if heights == ["surface"] and finishes:
        raise ValueError("--surface beside --finish: expected one of them, the scan has its own slope")
    if not heights:
        if finishes is None:
            raise ValueError("the roughness is missing; expected --finish, --Ra, --Rq or --surface")
        return _of_finish(finishes[0]), _of_finish(finishes[1])
    name = heights[0]
    texts = both(name, given[name])
    assert texts is not None  # `heights` has set options only
    if name == "surface":
        first = _of_scan(texts[0], given["unit"])
        return first, first if texts[1] == texts[0] else _of_scan(texts[1], given["unit"])
    rows = (row("finishes", finishes[0]), row("finishes", finishes[1])) if finishes else (None, None)
    pair = [_of_number(name, text, finish) for text, finish in zip(texts, rows, strict=True)]
    return pair[0], pair[1]


def _cut_off(Ra: float) -> Printed:
    wave = next(cut_off for up_to, cut_off in CUT_OFFS if Ra <= up_to)
    return Printed(wave, "estimate", f"cut-off of Ra {Ra * 1e6:.3g} um (ISO 4288): Ra counts no longer waves")


def _of_finish(name: str) -> Face:
    known = row("finishes", name)
    Ra, low, high = (known.numbers[key].value for key in ("Ra", "Ra_low", "Ra_high"))
    text = (
        f"{known.title}, Ra {low * 1e6:.3g} to {high * 1e6:.3g} um, taken as {Ra * 1e6:.3g} um "
        f"({known.numbers['Ra_low'].source})"
    )
    Rq, Rq_low, Rq_high = (float(roughness.rms_of_mean(value)) for value in (Ra, low, high))
    slope, hurst = known.numbers["slope"], known.numbers["hurst"]
    return Face(Rq, Rq_low, Rq_high, slope, hurst, _cut_off(Ra), text, {"Ra": Ra})


def _of_number(name: str, text: str, finish: TableRow | None) -> Face:
    value = number(name, text, "um", "m")
    if value > roughness.ROUGHEST:
        limit = roughness.ROUGHEST * 1e6
        raise ValueError(f"--{name} = {text!r} is outside (0, {limit:g}] um: no roughness is as high")
    Rq = value if name == "Rq" else float(roughness.rms_of_mean(value))
    slope = Printed(SLOPE, "estimate", "usual of machined surfaces")
    hurst = Printed(HURST, "estimate", "usual of machined surfaces, 0.7 to 0.9")
    if finish:
        slope, hurst = finish.numbers["slope"], finish.numbers["hurst"]
    wave = _cut_off(Rq / roughness.FACTOR)
    return Face(Rq, Rq, Rq, slope, hurst, wave, f"{name} {value * 1e6:.4g} um of the drawing", {name: value})


def _of_scan(path: str, unit: str | None) -> Face:
    prepared = form.prepare(reading.read(Path(path), unit))
    longest = form.default_wave(prepared.whole)
    scan = form.of_scan(prepared.gappy, prepared.whole, longest)
    source = f"scan {Path(path).name}"
    return Face(
        scan.h,
        scan.h,
        scan.h,
        Printed(scan.slope, "user", f"{source}, waves down to {scan.shortest_wave:.3g} m"),
        Printed(HURST, "estimate", "usual of machined surfaces, 0.7 to 0.9"),
        Printed(longest, "user", f"length of the {source}"),
        f"{source}, waves up to {longest:.3g} m",
        {"Rq": scan.h},
    )


def beyond(peak: float, hardness: float) -> list[str]:
    """Warning if the greatest pressure [Pa] is above the hardness [Pa], the limit of the law; else empty."""
    if peak <= hardness:
        return []
    return [
        f"the greatest pressure, {peak:.4g} Pa, is above the hardness, {hardness:.4g} Pa: the law ends there"
    ]


class Patch(NamedTuple):
    """Hertzian line contact: half width [m], area [m2] and greatest pressure [Pa]."""

    half_width: Number
    area: Number
    pressure: Number


def patch(load: Number, width: Number, curvature: Number, modulus: Number) -> Patch:
    """Hertzian line contact of two cylinders under a load [N] (Johnson, Contact Mechanics, Eqs. 4.43-4.45).

    width     : length of the contact line [m]
    curvature : relative curvature 1/R_1 + 1/R_2 [1/m], above 0
    modulus   : contact modulus E* [Pa]
    """
    half = np.sqrt(4.0 * load / (np.pi * width * modulus * curvature))
    return Patch(half, 2.0 * half * width, 2.0 * load / (np.pi * half * width))
