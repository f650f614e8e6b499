"""Involute gear pair: geometry with profile shift (ISO 21771) and tooth stiffness (ISO 6336-1, method B)."""

import re
from dataclasses import dataclass

import numpy as np

from jointfmu.parameters import ParameterFile

YOUNG_MODULUS_OF_STEEL = 206e9
"""Young's modulus [Pa] of steel wheels for which ISO 6336-1 states the stiffness."""
TOOTH_STIFFNESS_CORRECTION = 0.8
"""Factor C_M of ISO 6336-1 [1]: measured over theoretical stiffness of a tooth pair."""
REFERENCE_LINE_LOAD = 100e3
"""Tangential load per face width [N/m] below which ISO 6336-1 reduces the tooth stiffness."""
TOOTH_COMPLIANCE_COEFFICIENTS = (
    0.04723,
    0.15551,
    0.25791,
    -0.00635,
    -0.11654,
    -0.00193,
    -0.24188,
    0.00529,
    0.00182,
)
"""Coefficients C_1 to C_9 [mm um/N] of ISO 6336-1 for the compliance q' of a tooth pair."""
VALID_PROFILE_SHIFT_SUM_RANGE = -0.5, 2.0
"""Smallest and largest x_1 + x_2 [1] for which ISO 6336-1 states the tooth stiffness."""
STANDARD_DEDENDUM_OVER_MODULE = 1.2
"""Dedendum of the basic rack over the module [1] for which C_B of ISO 6336-1 is 1 at 20 degrees."""
MIN_TIP_THICKNESS_OVER_MODULE = 0.2
"""Usual least tooth thickness at the tip over the module [1]."""
MAX_CENTRE_DISTANCE_ERROR_OVER_MODULE = 0.01
"""Largest difference between a stated and the computed centre distance, over the module [1]."""
MESH_DAMPING_RATIO = 0.06
"""Damping ratio [1] of the oscillation of both wheels, as solid discs, on the mesh stiffness."""


TOOTH_STIFFNESS_SPREAD = 0.15
"""Relative difference [1] of published formulas for the stiffness of the teeth (docs/gear_mesh.md)."""


def describe_patch_load(wheel_1_torque: str) -> str:
    """Source text of the nominal area: Hertz's contact under a torque on wheel 1, a number in N.m as text."""
    return f"Hertz's line contact at the pitch point, one pair under {wheel_1_torque} N.m of wheel 1"


def working_force(parameter_file: ParameterFile) -> float:
    """Normal force of the mesh [N] at the torque that the source of `A_0` states; 0 if it states none."""
    stated = re.search(describe_patch_load(r"([\d.e+-]+)"), parameter_file.sources.get("A_0", ""))
    return float(stated[1]) / float(parameter_file.values_by_name["r_b1"]) if stated else 0.0


@dataclass(frozen=True, slots=True)
class InvoluteGearPair:
    """Two external involute gear wheels with profile shift, meshing without backlash.

    normal_module        : [m] normal module
    tooth_counts         : number of teeth of both wheels
    face_width           : [m] common face width
    pressure_angle       : [rad] normal pressure angle
    helix_angle          : [rad] at the reference circle
    profile_shifts       : profile shift coefficients x_1, x_2 [1]
    stated_tip_radii     : [m] of both wheels; None: addendum of one module, shortened for the tip clearance
    dedendum_over_module : dedendum of the basic rack over the module [1]
    """

    normal_module: float
    tooth_counts: tuple[float, float]
    face_width: float
    pressure_angle: float
    helix_angle: float
    profile_shifts: tuple[float, float] = (0.0, 0.0)
    stated_tip_radii: tuple[float, float] | None = None
    dedendum_over_module: float = STANDARD_DEDENDUM_OVER_MODULE

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
        """Radii of both base circles [m]: reference radius times cos(alpha_t), transverse pressure angle."""
        first, second = (r * np.cos(self.transverse_angle) for r in self.reference_radii)
        return float(first), float(second)

    @property
    def working_angle(self) -> float:
        """Transverse working pressure angle alpha_wt [rad].

        inv(alpha_wt) = inv(alpha_t) + 2 tan(alpha_n) (x_1 + x_2)/(z_1 + z_2). Raises ValueError if no angle
        has this involute.
        """
        if (total := sum(self.profile_shifts)) == 0.0:
            return self.transverse_angle
        shift = 2.0 * np.tan(self.pressure_angle) * total / sum(self.tooth_counts)
        target = float(involute_function(self.transverse_angle) + shift)
        if not 0.0 < target < involute_function(_MAX_WORKING_ANGLE):
            raise ValueError(
                f"--profile-shift: with the sum {total:g}, the wheels mesh at no centre distance; expected "
                "a sum nearer to 0"
            )
        from scipy.optimize import brentq  # here: the commands start without scipy

        return float(
            brentq(lambda angle: involute_function(angle) - target, 0.0, _MAX_WORKING_ANGLE, xtol=1e-15)
        )

    @property
    def working_radii(self) -> tuple[float, float]:
        """Radii of both working pitch circles [m]: base radius over cos(alpha_wt), working pressure angle."""
        ratio = np.cos(self.transverse_angle) / np.cos(self.working_angle)
        first, second = (r * ratio for r in self.reference_radii)
        return float(first), float(second)

    @property
    def centre_distance(self) -> float:
        """Centre distance a [m] without backlash."""
        return sum(self.working_radii)

    @property
    def tip_radii(self) -> tuple[float, float]:
        """Radii of both tip circles [m].

        Tip radii that are not stated are r + m_n (1 + x - k). Here k = x_1 + x_2 - (a - r_1 - r_2)/m_n
        shortens the tips, so that the tip clearance is that of the basic rack: r reference radii, m_n normal
        module, x profile shift coefficients, a centre distance.
        """
        if self.stated_tip_radii is not None:
            return self.stated_tip_radii
        m, total = self.normal_module, sum(self.profile_shifts)
        k = total - (self.centre_distance - sum(self.reference_radii)) / m
        first, second = (
            r + m * (1.0 + x - k) for r, x in zip(self.reference_radii, self.profile_shifts, strict=True)
        )
        return first, second

    @property
    def tip_clearances(self) -> tuple[float, float]:
        """Tip clearances [m]: between the tip of wheel 1 and the root of wheel 2, and vice versa."""
        root2, root1 = (
            r - self.normal_module * (self.dedendum_over_module - x)
            for r, x in zip(self.reference_radii[::-1], self.profile_shifts[::-1], strict=True)
        )
        tip1, tip2 = self.tip_radii
        return self.centre_distance - tip1 - root2, self.centre_distance - tip2 - root1

    @property
    def tip_thicknesses(self) -> tuple[float, float]:
        """Normal tooth thickness of both wheels at the tip [m]; negative: the flanks cross below the tip."""
        first, second = (
            2.0
            * r_a
            * (
                (0.5 * np.pi + 2.0 * x * np.tan(self.pressure_angle)) / z
                + involute_function(self.transverse_angle)
                - involute_function(np.arccos(r_b / r_a))
            )
            * np.cos(np.arctan(np.tan(self.helix_angle) * r_a / r))
            for r_a, r_b, r, z, x in zip(
                self.tip_radii,
                self.base_radii,
                self.reference_radii,
                self.tooth_counts,
                self.profile_shifts,
                strict=True,
            )
        )
        return float(first), float(second)

    @property
    def undercut_limits(self) -> tuple[float, float]:
        """Smallest profile shifts [1] without undercut: 1 - z sin(alpha_t)^2/(2 cos(beta)), z teeth.

        The straight flanks of the tool extend one module below its datum line.
        """
        first, second = (
            1.0 - 0.5 * z * np.sin(self.transverse_angle) ** 2 / np.cos(self.helix_angle)
            for z in self.tooth_counts
        )
        return float(first), float(second)

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio epsilon_alpha [1] (ISO 21771).

        The mean total length of the contact lines is epsilon_alpha times face width over cos(beta_b), for any
        overlap ratio; beta_b base helix angle.
        """
        base = self.base_radii
        path = sum(
            np.sqrt(r_a**2 - b**2) for r_a, b in zip(self.tip_radii, base, strict=True)
        ) - self.centre_distance * np.sin(self.working_angle)
        return float(path / (2.0 * np.pi * base[0] / self.tooth_counts[0]))

    @property
    def overlap_ratio(self) -> float:
        """Overlap ratio epsilon_beta [1] (ISO 21771): phase shift over the face width, in mesh cycles."""
        return float(self.face_width * np.sin(self.helix_angle) / (np.pi * self.normal_module))

    @property
    def relative_curvature(self) -> float:
        """Relative curvature 1/R_1 + 1/R_2 [1/m] at the pitch point, in the section normal to the flanks."""
        base_helix = np.arcsin(np.sin(self.helix_angle) * np.cos(self.pressure_angle))
        curvatures = (np.cos(base_helix) / (r * np.sin(self.working_angle)) for r in self.working_radii)
        return float(sum(curvatures))

    def tooth_stiffness(self, young_moduli: tuple[float, float], wheel_1_torque: float) -> float:
        """Stiffness [N/m] of one tooth pair in contact: the single stiffness c' times the face width.

        young_moduli   : Young's moduli [Pa] of both wheels
        wheel_1_torque : [N.m] of wheel 1; below REFERENCE_LINE_LOAD the stiffness is reduced

        ISO 6336-1, method B: solid wheels (C_R = 1), K_A = 1.
        """
        z1, z2 = (z / np.cos(self.helix_angle) ** 3 for z in self.tooth_counts)  # virtual
        x1, x2 = self.profile_shifts
        shifts = (1.0, 1.0, 1.0, x1, x1, x2, x2, x1**2, x2**2)
        teeth = (1.0, z1, z2, 1.0, z1, 1.0, z2, 1.0, 1.0)
        q = sum(
            C * x / z for C, x, z in zip(TOOTH_COMPLIANCE_COEFFICIENTS, shifts, teeth, strict=True)
        )  # mm um/N
        material = 2.0 / (1.0 / young_moduli[0] + 1.0 / young_moduli[1]) / YOUNG_MODULUS_OF_STEEL
        root = 1.0 + 0.5 * (STANDARD_DEDENDUM_OVER_MODULE - self.dedendum_over_module)
        rack = root * (1.0 - 0.02 * (20.0 - np.degrees(self.pressure_angle)))  # C_B
        loaded = (
            min(wheel_1_torque / self.reference_radii[0] / self.face_width / REFERENCE_LINE_LOAD, 1.0) ** 0.25
        )
        theory = 1e9 / q * np.cos(self.helix_angle) * material * self.face_width
        return float(TOOTH_STIFFNESS_CORRECTION * rack * loaded * theory)

    def mesh_stiffness(self, tooth_stiffness: float) -> float:
        """Mesh stiffness c_gamma times width [N/m] of ISO 6336-1.

        tooth_stiffness : [N/m] of one tooth pair
        """
        return tooth_stiffness * (0.75 * self.contact_ratio + 0.25)

    def mesh_damping(self, mesh_stiffness: float, densities: tuple[float, float]) -> float:
        """Damping [N.s/m] along the line of action: 2 MESH_DAMPING_RATIO sqrt(stiffness mass).

        mesh_stiffness : [N/m] of the mesh
        densities      : [kg/m3] of both wheels; the mass is of both wheels in series, as solid discs,
                         reduced to the line of action
        """
        masses = [
            0.5 * np.pi * rho * self.face_width * r**4 / b**2
            for rho, r, b in zip(densities, self.reference_radii, self.base_radii, strict=True)
        ]
        return float(2.0 * MESH_DAMPING_RATIO * np.sqrt(mesh_stiffness / (1.0 / masses[0] + 1.0 / masses[1])))

    def check_geometry(self) -> None:
        """Raise ValueError, one line, for wheels that cannot mesh.

        Refused are tips below the base circles or in the roots of the other wheel, pointed teeth, and a
        contact ratio below 1.
        """
        diameters = [f"tip diameter {2e3 * r:.6g} mm of wheel {i}" for i, r in enumerate(self.tip_radii, 1)]
        for diameter, tip, base in zip(diameters, self.tip_radii, self.base_radii, strict=True):
            if tip <= base:
                raise ValueError(
                    f"{diameter} is not above the base diameter {2e3 * base:.6g} mm; increase "
                    "--tip-diameter or --profile-shift"
                )
        for i, diameter in enumerate(diameters):
            if self.tip_thicknesses[i] <= 0.0:
                raise ValueError(
                    f"{diameter}: the teeth end in a point below it; reduce --profile-shift or --tip-diameter"
                )
            if (clearance := self.tip_clearances[i]) < 0.0:
                raise ValueError(
                    f"{diameter} reaches {-1e3 * clearance:.4g} mm into the root of wheel {2 - i}; reduce "
                    "--tip-diameter"
                )
        if (ratio := self.contact_ratio) < 1.0:
            raise ValueError(
                f"contact_ratio = {ratio:.4g} is below 1: the teeth lose contact; increase --tip-diameter "
                "or reduce --profile-shift"
            )

    def find_geometry_warnings(self) -> list[str]:
        """Find thin tips, undercut, interference and profile shifts outside ISO 6336-1, one line each."""
        warnings = []
        tangent = self.centre_distance * np.sin(self.working_angle)
        for i in (0, 1):
            if (ratio := self.tip_thicknesses[i] / self.normal_module) < MIN_TIP_THICKNESS_OVER_MODULE:
                warnings.append(
                    f"the teeth of wheel {i + 1} are {ratio:.2g} modules thick at the tip; usual are at "
                    f"least {MIN_TIP_THICKNESS_OVER_MODULE:g}"
                )
            if (x := self.profile_shifts[i]) < (least := self.undercut_limits[i]):
                warnings.append(
                    f"the teeth of wheel {i + 1} are undercut: their profile shift {x:g} is below "
                    f"{least:.3g}; the computed contact ratio and stiffness are too large"
                )
            elif np.sqrt(self.tip_radii[1 - i] ** 2 - self.base_radii[1 - i] ** 2) > tangent:
                warnings.append(
                    f"the tips of wheel {2 - i} touch wheel {i + 1} below its base circle: the computed "
                    "contact ratio is too large"
                )
        x1, x2 = self.profile_shifts
        low, high = VALID_PROFILE_SHIFT_SUM_RANGE
        if x1 < x2 or not low <= x1 + x2 <= high:
            warnings.append(
                f"ISO 6336-1 states the tooth stiffness for x1 >= x2 and {low:g} <= x1 + x2 <= {high:g}; "
                f"here x1 = {x1:g}, x2 = {x2:g}"
            )
        return warnings

    def check_centre_distance(self, stated_distance: float) -> None:
        """Raise ValueError, one line, if a stated centre distance [m] contradicts the profile shifts."""
        if (
            abs(stated_distance - self.centre_distance)
            <= MAX_CENTRE_DISTANCE_ERROR_OVER_MODULE * self.normal_module
        ):
            return
        x1, x2 = self.profile_shifts
        message = (
            f"--centre-distance = {1e3 * stated_distance:.7g} mm, but --profile-shift {x1:g} {x2:g} gives "
            f"{1e3 * self.centre_distance:.7g} mm"
        )
        if (cosine := sum(self.base_radii) / stated_distance) < 1.0:
            difference = involute_function(np.arccos(cosine)) - involute_function(self.transverse_angle)
            total = 0.5 * difference * sum(self.tooth_counts) / np.tan(self.pressure_angle)
            message += f"; the stated distance needs shifts with the sum {round(float(total), 4):g}"
        raise ValueError(message)


_MAX_WORKING_ANGLE = 1.4
"""Largest transverse working pressure angle [rad]."""


def involute_function(angle: float) -> float:
    """Involute function of an angle [rad]: tan(angle) - angle."""
    return float(np.tan(angle) - angle)
