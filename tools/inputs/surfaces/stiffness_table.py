"""Points of the interface law `table` from a scan: by boundary elements, or from the tail of the heights."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointfmu.contact.laws import TABLE_LAW
from jointfmu.contact.laws.table import TableLaw
from jointfmu.contact.surface import ElasticConstants, contact_modulus, contact_shear_modulus
from jointfmu.files.outputs import PROGRAM_MARK, FileKind
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array

from .bearing_curve import TABLE_FACTOR_RANGE, BearingCurve
from .heights import ArealMap

INTERFACE_TABLE_FILE = FileKind("table of an interface", (".csv",))
"""Kind of the file with points that `surface --table` writes."""


@dataclass(frozen=True, slots=True)
class InterfacePoints:
    """Points of the interface law `table`: normal stiffness per area over pressure, with its range.

    pressure, stiffness   : (n) [Pa], [Pa/m]
    shear_stiffness_ratio : K_T/K_N of elastic contact spots [1]
    factor_range          : smallest and largest stiffness over the stiffness of the points [1]
    source                : text on the origin
    plastic_area_share    : (n) share of the real contact area at the hardness [1]; empty: not computed
    """

    pressure: Array
    stiffness: Array
    shear_stiffness_ratio: float
    factor_range: tuple[float, float]
    source: str
    plastic_area_share: Array = field(default_factory=lambda: np.zeros(0))

    def to_csv(self) -> str:
        """Format the points as the CSV file that `new --interface-table` reads."""
        low, high = self.factor_range
        rows = [
            f"{p:.6g},{k:.6g},{low * k:.6g},{high * k:.6g},{self.shear_stiffness_ratio:.6g}"
            for p, k in zip(self.pressure, self.stiffness, strict=True)
        ]
        heads = "pressure [Pa],stiffness [Pa/m],stiffness_low [Pa/m],stiffness_high [Pa/m],ratio [1]"
        return "\n".join([f"# {self.source} ({PROGRAM_MARK})", heads, *rows]) + "\n"


@dataclass(frozen=True, slots=True)
class MaterialPair:
    """Contact of two materials: contact modulus E* [Pa], K_T/K_N [1], hardness of the softer one [Pa]."""

    modulus: float
    shear_stiffness_ratio: float
    hardness: float
    names: str

    @classmethod
    def from_sides(
        cls, sides: Sequence[ElasticConstants], hardness: float, names: Sequence[str]
    ) -> "MaterialPair":
        """Material pair of two bodies, from the hardness of the softer one [Pa] and the material names."""
        modulus = float(contact_modulus(*sides))
        ratio = 4.0 * float(contact_shear_modulus(*sides)) / modulus
        return cls(modulus, ratio, hardness, " and ".join(dict.fromkeys(names)))


def points_from_tail(curve: BearingCurve, materials: MaterialPair, files: str) -> InterfacePoints:
    """Points of the interface law `table` from the upper tail of the heights: pressure over decay length."""
    pressure, stiffness = curve.stiffness_table(materials.modulus)
    source = (
        f"upper tail of the heights of {files}: pressure over decay length, E* = {materials.modulus:.4g} Pa "
        f"of {materials.names}; range: from boundary elements of single surfaces (docs/validity_stiffness.md)"
    )
    return InterfacePoints(pressure, stiffness, materials.shear_stiffness_ratio, TABLE_FACTOR_RANGE, source)


def points_from_solution(
    scans: Sequence[ArealMap], both_sides: bool, materials: MaterialPair, files: str
) -> InterfacePoints:
    """Points of the interface law `table` from a solution by boundary elements.

    scans      : heights without form, of one side or of both
    both_sides : whether the single scan describes both sides; the gap is then between the scan and its copy,
                 mirrored in y
    """
    from .solve import gap_of_scans, solve_stiffness

    if both_sides:
        scans = [scans[0], scans[0].with_heights(scans[0].z[::-1])]
    found = solve_stiffness(gap_of_scans(scans), materials.modulus, materials.hardness)
    source = (
        f"boundary elements on {files}, {1e6 * found.spacing:.3g} um between points: small motions, E* = "
        f"{materials.modulus:.4g} Pa, hardness {materials.hardness:.4g} Pa of {materials.names}; range: "
        "scatter of four sub-areas"
    )
    limits = found.low, found.high
    return InterfacePoints(
        found.pressure,
        found.stiffness,
        materials.shear_stiffness_ratio,
        limits,
        source,
        plastic_area_share=found.plastic_area_share,
    )


def has_table_law(joint: str) -> bool:
    """Whether an interface of this kind of joint can have the law `table`."""
    kind = KINDS[joint]
    return TABLE_LAW in kind.laws and isinstance(
        kind.extract_law(load_default(joint, TABLE_LAW).values), TableLaw
    )


def with_points(parameter_file: ParameterFile, interface_points: InterfacePoints) -> ParameterFile:
    """Copy of a parameter file of the law `table` with new points of the stiffness."""
    values = {
        "table.pressure": tuple(float(f"{p:.6g}") for p in interface_points.pressure),
        "table.stiffness": tuple(float(f"{k:.6g}") for k in interface_points.stiffness),
        "table.factor": 1.0,
    }
    parameter_file = parameter_file.with_values(values, "derived", interface_points.source)
    text = "4 G'/E* of elastic contact spots (Mindlin 1949), not measured"
    parameter_file = parameter_file.with_values(
        {"table.ratio": interface_points.shear_stiffness_ratio}, "estimate", text
    )
    return replace(
        parameter_file, ranges={**parameter_file.ranges, "table.factor": interface_points.factor_range}
    )
