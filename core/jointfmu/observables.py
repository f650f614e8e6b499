"""What a published number means: one function per quantity of models/reference/, on a parameter set."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .asperity import hu2023 as hu
from .asperity import kogut_etsion, mindlin
from .asperity import zhao2018 as zhao
from .asperity.yu2022 import Yu2022
from .footprint.bolts import cells, pressure_shape, unit_pressures
from .interface import at_largest_spot
from .joints.bolted_joint.spring import BoltedJoint, bolt_pattern, pressures, row_forces
from .joints.gear_contact.spring import GearContact
from .joints.harmonic_drive.spring import HarmonicDrive, drive_stiffness, pair_stiffness, peak_pressure
from .surface import domain_extension, hardness_coefficient

Array = NDArray[np.float64]


def K_TS(
    drive: HarmonicDrive, torque: float, deformation: float | None = None, eccentricity: float = 0.0
) -> float:
    """K_TS [N.m/rad] on the paper's scale at a torque [N.m], radial deformation and eccentricity [m]."""
    w = drive.radial_deformation if deformation is None else deformation
    there = replace(drive, radial_deformation=w, eccentricity=eccentricity)
    return float(pair_stiffness(there, torque)[0])


def K_TS_least(drive: HarmonicDrive, torque: float, lower: float, upper: float) -> float:
    """Least K_TS [N.m/rad] over 41 radial deformations of an interval [m]."""
    return min(K_TS(drive, torque, w) for w in np.linspace(lower, upper, 41).tolist())


def K_TS_change(drive: HarmonicDrive, torque: float, eccentricity: float) -> float:
    """Change of K_TS [%] by an eccentricity [m] at the nominal radial deformation."""
    return 100.0 * (K_TS(drive, torque, eccentricity=eccentricity) / K_TS(drive, torque) - 1.0)


def K_WTS(drive: HarmonicDrive, torque: float) -> float:
    """K_WTS [N.m/rad] at a torque [N.m]."""
    return float(drive_stiffness(drive, torque)[0])


def drive_peak_pressure(drive: HarmonicDrive, torque: float) -> float:
    """Peak contact pressure [Pa] at a torque [N.m]."""
    return float(peak_pressure(drive, torque)[0])


def kogut_etsion_product(drive: HarmonicDrive, product: str, stage: int) -> float:
    """Constants [1] of the elastic-plastic stages by area: load, stiffness, or where the stage ends."""
    if product == "area":
        return float((kogut_etsion.SECOND_AREA, kogut_etsion.PLASTIC_AREA)[stage - 1])
    powers = kogut_etsion.by_area((kogut_etsion.FIRST, kogut_etsion.SECOND)[stage - 1])
    return powers.A if product == "load" else powers.B


def plastic_onset_pressure(drive: HarmonicDrive, nu: float) -> float:
    """Mean pressure over hardness [1] of a spot of Kogut and Etsion at the onset of full plasticity."""
    stage, w = kogut_etsion.SECOND, kogut_etsion.PLASTIC_ONSET
    load_per_area = stage.c * w**stage.d / (stage.m * w**stage.n)
    return float(2.0 / 3.0 * hardness_coefficient(nu) * load_per_area)


def shear_over_friction(drive: HarmonicDrive, stage: str) -> float:
    """t/(mu f) [1] of a spot at the end of a stage if its area carries tau_b = sigma_s/sqrt(3)."""
    law = drive.law
    first, second = (kogut_etsion.by_area(s) for s in (kogut_etsion.FIRST, kogut_etsion.SECOND))
    load, area = {
        "elastic": (1.0, 1.0),
        "first": (first.A * kogut_etsion.SECOND_AREA**first.p, kogut_etsion.SECOND_AREA),
        "second": (second.A * kogut_etsion.PLASTIC_AREA**second.p, kogut_etsion.PLASTIC_AREA),
    }[stage]
    pressure = 2.0 / 3.0 * hardness_coefficient(law.side1.nu) * law.hardness * load / area
    return float(law.sigma_y / np.sqrt(3.0) / (law.mu * pressure))


def least_mean_pressure(drive: HarmonicDrive) -> float:
    """F_r/S_r [Pa] of purely elastic spots, largest spot s_ec: the least F_r/S_r of larger ones."""
    state = at_largest_spot(drive.law, hu.critical_area(drive.law))
    return float(state["F"] / state["A_r"])


def p_max(joint: BoltedJoint, preload: float) -> float:
    """Largest node pressure [Pa] at a preload [N] per bolt."""
    return float(np.max(pressures(joint, pressure_shape(joint.pattern), preload, 0.0)))


def p_between(joint: BoltedJoint, preload: float) -> float:
    """Pressure [Pa] midway between a corner bolt and its neighbour off the row, at a preload [N]."""
    pattern = bolt_pattern(joint)
    areas, nodes = cells(pattern)
    middle = pattern.bolts[[0, 3]].mean(axis=0)[None, :]
    unit = float(unit_pressures(pattern, areas, nodes, middle).sum())
    return unit * preload * joint.n_bolts / 8.0 * float(areas.sum()) / joint.A_0


def row_force(joint: BoltedJoint, preload: float, moment: float, row: int) -> float:
    """Bolt force [N] in row 1 or 2 under a moment [N.m]."""
    return row_forces(joint, preload, moment)[row - 1]


def critical_area(joint: BoltedJoint, choice: str) -> float:
    """a'_c [m2] by a named choice."""
    return float(zhao.critical_area(replace(joint, critical_area=choice)))


def spot_stiffness_ratio(joint: BoltedJoint) -> float:
    """Spot stiffness along the size family over Hertz [1]."""
    family, hertz = (
        zhao.normal_stiffness(replace(joint, spot_stiffness=kind), 1e-6) for kind in ("family", "hertz")
    )
    return float(family / hertz)


def mindlin_function(joint: BoltedJoint, function: str, x: float) -> float:
    """H1 (`loop`), H2 (`storage`) or W_d/W (`loss_ratio`) [1] at a traction ratio."""
    table = {"loop": mindlin.loop, "storage": mindlin.storage, "loss_ratio": mindlin.loss_ratio}
    return float(table[function](x))


def psi(joint: BoltedJoint, D: float) -> float:
    """Domain extension factor [1] of a profile dimension."""
    return float(domain_extension(D))


def frequency_error(joint: BoltedJoint, predicted: float, measured: float) -> float:
    """Error [%] of a predicted frequency against the experiment."""
    return 100.0 * (predicted / measured - 1.0)


def claim(contact: GearContact, of: str, over: str) -> bool:
    """A claim of Yu 2022, section 5, with the parameters named there.

    Load and stiffness are compared at equal real areas, real areas at an equal largest spot.
    """
    if over == "MB":
        return _below_majumdar_bhushan(contact)
    if of == "elastic_fraction" and over == "e":
        shares = [
            _at_real_area(_varied(contact, D1=1.56, D2=1.56, e=e), 0.01)[of] for e in (0.1, 0.3, 0.5, 0.7)
        ]
        return bool(max(shares) - min(shares) < 0.05)
    if of == "elastic_fraction":
        share = [_at_real_area(_varied(contact, D1=1.56, D2=D), 0.01)[of] for D in (1.45, 1.55, 1.65)]
        return bool(share[0] < share[1] and abs(share[2] - share[1]) < 0.2 * (share[1] - share[0]))
    fine = {"G1": 1e-11, "G2": 1e-11}
    studies: dict[str, list[Yu2022]] = {
        "D": [_varied(contact, D1=1.36, D2=D, **fine) for D in (1.36, 1.46, 1.56, 1.66, 1.76)],
        "G": [_varied(contact, G2=G) for G in (9e-10, 7e-10, 5e-10, 3e-10, 1e-10)],
        "e": [_varied(contact, e=e, **fine) for e in (0.7, 0.5, 0.3, 0.1)],
        "lambda": [_varied(contact, lambda_=v, **fine) for v in (0.3, 0.5, 0.7, 0.9)],
    }
    if of == "A_r":
        rows = [[float(at_largest_spot(law, 1e-6)[of]) for law in studies[over]]]
    else:
        fractions = np.geomspace(1e-3, 1e-1, 9)
        rows = [[_at_real_area(law, part)[of] for law in studies[over]] for part in fractions]
    return bool(np.all(np.diff(rows, axis=1) > 0.0))


def _varied(contact: GearContact, **changes: Any) -> GearContact:
    for key in ("D1", "D2", "G1", "G2"):
        if key in changes:
            name = f"surface{key[1]}"
            surface = replace(getattr(contact, name), **{key[0]: changes.pop(key)})
            contact = replace(contact, **{name: surface})
    return replace(contact, **changes)


def _at_real_area(law: Yu2022, fraction: float) -> dict[str, float]:
    """State at a real area that is a fraction of A_0; Eq. 54 gives the largest spot."""
    spots = law.spots()
    largest = fraction * law.A_0 * (1.0 - spots.m) / (spots.m * spots.weight)
    state: dict[str, Any] = law.state(np.log(largest / spots.reference))
    return {name: float(value) for name, value in state.items()}


def _below_majumdar_bhushan(contact: GearContact) -> bool:
    """Load below that of Majumdar and Bhushan (1991), same D and G, at 1 to 10 % real area.

    Elastic spots above a_c = G^2 (2 E/H)^(2/(D-1)), plastic ones below; profile dimension D.
    """
    D, G = contact.surface1.D, contact.surface1.G
    E, H = contact.side1.E / (1.0 - contact.side1.nu**2), contact.hardness
    critical = G**2 * (2.0 * E / H) ** (2.0 / (D - 1.0))
    for fraction in np.geomspace(1e-2, 1e-1, 9):
        largest = fraction * contact.A_0 * (2.0 - D) / D
        scale = 4.0 * np.sqrt(np.pi) / 3.0 * E * G ** (D - 1.0) * D / (3.0 - 2.0 * D)
        elastic = scale * largest ** (0.5 * D) * (largest ** (1.5 - D) - critical ** (1.5 - D))
        plastic = H * D / (2.0 - D) * largest ** (0.5 * D) * critical ** (1.0 - 0.5 * D)
        if _at_real_area(contact, fraction)["F"] >= elastic + plastic:
            return False
    return True


OBSERVABLES: dict[str, Callable[..., float | bool]] = {
    "K_TS": K_TS,
    "K_TS_least": K_TS_least,
    "K_TS_change": K_TS_change,
    "K_WTS": K_WTS,
    "peak_pressure": drive_peak_pressure,
    "kogut_etsion": kogut_etsion_product,
    "plastic_onset_pressure": plastic_onset_pressure,
    "shear_over_friction": shear_over_friction,
    "least_mean_pressure": least_mean_pressure,
    "p_max": p_max,
    "p_between": p_between,
    "row_force": row_force,
    "critical_area": critical_area,
    "spot_stiffness_ratio": spot_stiffness_ratio,
    "mindlin": mindlin_function,
    "psi": psi,
    "frequency_error": frequency_error,
    "claim": claim,
}
