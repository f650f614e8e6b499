"""Points of the interface law `table` from a scan: by boundary elements, or from the tail of the heights."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointfmu.contact.laws import TABLE_LAW_NAME
from jointfmu.contact.laws.table import TableLaw
from jointfmu.contact.surface import ElasticConstants, contact_modulus, contact_shear_modulus
from jointfmu.files.outputs import PROGRAM_MARK, FileKind
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.quantity import Array

from .bearing_curve import SURFACE_OVER_LAW_STIFFNESS_RANGE, BearingCurve
from .heights import ArealMap

MAX_PLASTIC_AREA_SHARE = 0.3
"""Share of the real contact area at the hardness [1] from which the stiffness depends on the finest waves."""
PLASTIC_STIFFNESS_FACTOR = 3.0
"""Factor [1] by which the stiffness is then uncertain in both directions (docs/surfaces.md)."""
INTERFACE_TABLE_FILE_KIND = FileKind("table of an interface", (".csv",))
"""Kind of the file with points that `surface --table` writes."""


@dataclass(frozen=True, slots=True)
class InterfacePoints:
    """Points of the interface law `table`: normal stiffness per area over pressure, with its range.

    nominal_pressure, normal_stiffness : (n) [Pa], [Pa/m]
    shear_stiffness_ratio : K_T/K_N of elastic contact spots [1]
    stiffness_factor_range : smallest and largest stiffness over the stiffness of the points [1]
    points_source : text on the origin
    plastic_area_share : (n) share of the real contact area at the hardness [1]; empty: not computed
    """

    nominal_pressure: Array
    normal_stiffness: Array
    shear_stiffness_ratio: float
    stiffness_factor_range: tuple[float, float]
    points_source: str
    plastic_area_share: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def is_mostly_plastic(self) -> bool:
        """Whether so much of the contact yields, at any pressure, that the finest waves set the stiffness."""
        return bool(np.max(self.plastic_area_share, initial=0.0) >= MAX_PLASTIC_AREA_SHARE)

    def to_csv(self) -> str:
        """Format the points as the CSV file that `new --interface-table` reads."""
        low, high = self.stiffness_factor_range
        rows = [
            f"{p:.6g},{k:.6g},{low * k:.6g},{high * k:.6g},{self.shear_stiffness_ratio:.6g}"
            for p, k in zip(self.nominal_pressure, self.normal_stiffness, strict=True)
        ]
        heads = "pressure [Pa],stiffness [Pa/m],stiffness_low [Pa/m],stiffness_high [Pa/m],ratio [1]"
        return "\n".join([f"# {self.points_source} ({PROGRAM_MARK})", heads, *rows]) + "\n"


@dataclass(frozen=True, slots=True)
class MaterialPair:
    """Two materials in contact: contact modulus E* [Pa], K_T/K_N [1], hardness [Pa] of the softer one."""

    contact_modulus: float
    shear_stiffness_ratio: float
    softer_hardness: float
    material_names: str

    @classmethod
    def from_sides(
        cls,
        elastic_constants: Sequence[ElasticConstants],
        softer_hardness: float,
        material_names: Sequence[str],
    ) -> "MaterialPair":
        """Material pair of two bodies, from the hardness of the softer one [Pa] and the material names."""
        modulus = float(contact_modulus(*elastic_constants))
        ratio = 4.0 * float(contact_shear_modulus(*elastic_constants)) / modulus
        return cls(modulus, ratio, softer_hardness, " and ".join(dict.fromkeys(material_names)))


def interface_points_from_tail(
    bearing_curve: BearingCurve, material_pair: MaterialPair, scan_names: str
) -> InterfacePoints:
    """Points of the interface law `table` from the upper tail of the heights: stiffness k = p/l.

    p: pressure; l: decay length of the tail, with which the pressure grows as exp(approach/l).
    """
    pressure, stiffness = bearing_curve.stiffness_table(material_pair.contact_modulus)
    source = (
        f"upper tail of the heights of {scan_names}: pressure over decay length, E* = "
        f"{material_pair.contact_modulus:.4g} Pa of {material_pair.material_names}; range: from boundary "
        "elements of single surfaces (docs/validity_stiffness.md)"
    )
    return InterfacePoints(
        pressure, stiffness, material_pair.shear_stiffness_ratio, SURFACE_OVER_LAW_STIFFNESS_RANGE, source
    )


def interface_points_from_solution(
    scans: Sequence[ArealMap], represents_both_sides: bool, material_pair: MaterialPair, scan_names: str
) -> InterfacePoints:
    """Points of the interface law `table` from a solution by boundary elements.

    scans                 : heights without form, of one side or of both
    represents_both_sides : whether the single scan describes both sides; the gap is then between the scan and
                            its copy, mirrored in y
    """
    from .solve import compute_gap_heights, solve_stiffness

    if represents_both_sides:
        scans = [scans[0], scans[0].replace_heights(scans[0].z[::-1])]
    found = solve_stiffness(
        compute_gap_heights(scans), material_pair.contact_modulus, material_pair.softer_hardness
    )
    limits = found.min_sub_area_over_mean_stiffness, found.max_sub_area_over_mean_stiffness
    source = (
        f"boundary elements on {scan_names}, {1e6 * found.grid_spacing:.3g} um between points: small "
        f"motions, E* = {material_pair.contact_modulus:.4g} Pa, hardness "
        f"{material_pair.softer_hardness:.4g} Pa of {material_pair.material_names}; range: scatter of four "
        "sub-areas"
    )
    points = InterfacePoints(
        found.nominal_pressure,
        found.normal_stiffness,
        material_pair.shear_stiffness_ratio,
        limits,
        source,
        plastic_area_share=found.plastic_area_share,
    )
    if not points.is_mostly_plastic:
        return points
    factor = PLASTIC_STIFFNESS_FACTOR
    return replace(
        points,
        stiffness_factor_range=(limits[0] / factor, limits[1] * factor),
        points_source=f"{source}, times {factor:g} in both directions, because much of the contact yields",
    )


def has_table_law(joint_kind: str) -> bool:
    """Whether an interface of this kind of joint can have the law `table`."""
    kind = KINDS[joint_kind]
    return TABLE_LAW_NAME in kind.laws and isinstance(
        kind.extract_law(load_default(joint_kind, TABLE_LAW_NAME).values), TableLaw
    )


def set_interface_points(parameter_file: ParameterFile, interface_points: InterfacePoints) -> ParameterFile:
    """Copy of a parameter file of the law `table` with new points of the stiffness."""
    values = {
        "table.pressure": tuple(float(f"{p:.6g}") for p in interface_points.nominal_pressure),
        "table.stiffness": tuple(float(f"{k:.6g}") for k in interface_points.normal_stiffness),
        "table.factor": 1.0,
    }
    parameter_file = parameter_file.with_values(values, "derived", interface_points.points_source)
    text = "4 G'/E* of elastic contact spots (Mindlin 1949), not measured"
    parameter_file = parameter_file.with_values(
        {"table.ratio": interface_points.shear_stiffness_ratio}, "estimate", text
    )
    return replace(
        parameter_file,
        ranges={**parameter_file.ranges, "table.factor": interface_points.stiffness_factor_range},
    )
