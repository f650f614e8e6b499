"""Brake-Reuss beam: published geometry, contact law, scanned form, and published curves of the first mode."""

from dataclasses import dataclass, replace
from importlib.resources import files

import numpy as np
from scipy.interpolate import PchipInterpolator, RegularGridInterpolator
from scipy.optimize import brentq

from ..measured_joints import joint_law, level, measured
from .mesh import LapBeam

FRICTION_COEFFICIENT = 0.15
"""Friction coefficient of dry machined metal, the default of `jointfmu new` (VDI 2230: 0.1 to 0.3) [1]."""
AMPLITUDES = np.geomspace(1e-7, 1e-4, 13)
"""Modal amplitudes q [m kg^0.5] of the linear beam under the loads."""
GLUED_STIFFNESS = 1e17
"""Stiffness [N/m3] of a glued lap: as of 2 um of steel."""


def data():
    """Read models/reference/brake_reuss.toml."""
    return measured("brake_reuss")


def beam():
    """Geometry and material of the beam."""
    entries = data()
    known = {name: value for name, value in entries["beam"].items() if name != "preload"}
    return LapBeam(**known | {"bolts": tuple(known["bolts"]), "E": entries["E"], "nu": entries["nu"]})


def form():
    """Gap [m] of the unloaded lap at positions x, y [m], from models/reference/brake_reuss_lap_form.csv.

    Half the width is modelled, with the mean of both halves. In a hole the gap is taken from next to it
    along x; beyond the scan, from the last row or column.
    """
    text = (files("jointfmu_models") / "reference" / "brake_reuss_lap_form.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    gap = 1e-6 * np.array([[float(cell) if cell else np.nan for cell in line.split(",")] for line in lines])
    y, x = (1e-3 * np.linspace(-end, end, n) for end, n in zip((13.2, 61.206), gap.shape, strict=True))
    known = np.isfinite(gap).sum(axis=1) > 0.5 * x.size
    rows = [np.interp(x, x[np.isfinite(row)], row[np.isfinite(row)]) for row in gap[known]]
    surface = RegularGridInterpolator((y[known], x), np.array(rows))
    most = np.min(np.abs(y[known][[0, -1]]))

    def mean(at_x, at_y):
        across, along = np.minimum(np.abs(at_y), most), np.clip(at_x, x[0], x[-1])
        return 0.5 * sum(surface(np.stack([side * across, along], axis=-1)) for side in (1.0, -1.0))

    return mean


def crown(height, lap):
    """Gap [m] at positions x, y [m] between faces that are parabolic along the lap; zero at first contact."""
    return lambda x, y: height * (2.0 * x / lap) ** 2 + max(-height, 0.0)


def laws():
    """Interface laws: `roughness` from the rms height of the gap, `published` scaled to the published
    stiffness."""
    entries = data()
    ours = joint_law(entries | {"Rq": entries["h"] / np.sqrt(2.0)}, H=entries["H"])

    def excess(h):
        return level(replace(ours, h=h), entries["pressure"]) / entries["normal"] - 1.0

    return {"roughness": ours, "published": replace(ours, h=brentq(excess, 0.5 * ours.h, 2.0 * ours.h))}


def solid_bar_frequency(one):
    """First bending frequency [Hz] of a free bar without a joint (Timoshenko; shear by Cowper)."""
    area, inertia = one.across * one.side, one.across * one.side**3 / 12.0
    shear = 10.0 * (1.0 + one.nu) / (12.0 + 11.0 * one.nu) * one.E / (2.0 * (1.0 + one.nu)) * area
    bend, heavy, turned, half = one.E * inertia, one.density * area, one.density * inertia, 0.5 * one.length

    def ends(omega):
        """Residual of the free-end condition for an even mode of cos(k x) and cosh(m x)."""
        slow = heavy * omega**2 / shear
        parts = [bend, -(turned * omega**2 + bend * slow), -heavy * omega**2 + turned * omega**2 * slow]
        m, k = np.sqrt(np.abs(np.sort(np.roots(parts))))
        left = (slow - k**2) * np.cos(k * half) * np.sinh(m * half) / m
        return left - (slow + m**2) * np.cosh(m * half) * np.sin(k * half) / k

    euler = (4.7300 / one.length) ** 2 * np.sqrt(bend / heavy)
    return brentq(ends, 0.9 * euler, 1.01 * euler) / (2.0 * np.pi)


@dataclass(frozen=True)
class Curves:
    """First mode over the modal amplitude q (k) [m kg^0.5]: frequency (k) [Hz], damping ratio (k) [1]."""

    q: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray

    def at(self, q):
        """Frequency and damping ratio at other amplitudes, by monotone cubics in the logarithm of q.

        Below the range the damping ratio falls with q: the loss of small motions with its third power.
        """
        values = np.column_stack([self.frequency, np.log(self.damping)])
        f, loss = PchipInterpolator(np.log(self.q), values)(np.log(np.maximum(q, self.q[0]))).T
        return f, np.exp(loss) * np.minimum(q / self.q[0], 1.0)


def published(name):
    """Published curves of the authors, `flat` or `curved`."""
    return Curves(**{key: np.array(values) for key, values in data()["published"][name].items()})
