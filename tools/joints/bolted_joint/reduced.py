"""The bolted joint for many samples at once: stiffness, damping and approach along a ramp of preload.

Without a moment and tightened only, a node's pressure is the mean pressure times a fixed number
`equal`. Sums over the nodes are sums over a few Gauss points of its distribution, taken from a table
over the log of the pressure whose places relative to the end of the ramp are the same for all samples:
one matrix for all of them. With elastic sides the stiffness is that of the whole, condensed at the points and
patches of the exported joint.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from jointfmu.contact.laws import mindlin
from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.bodies import Modes
from jointfmu.joints.bolted_joint.bolts import AT_LIFT_OFF
from jointfmu.joints.bolted_joint.contact import pressure_transfer
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, contact_points, friction_patches_of
from jointfmu.joints.bolted_joint.kinematics import tangential_jacobian
from jointfmu.joints.bolted_joint.law import Bolted, ElasticBodies, interface_alone, node_pressure, slip_force
from jointfmu.joints.model import Variable
from jointfmu.mechanics.footprint.bolts import PressureSource, pressure_distribution
from jointfmu.quantity import Array, flatten_parameters

from ...studies.batch.approach import columns, discrete_gauss, held, tabulate
from ...studies.uncertainty.problem import ReducedCurves
from .report import loss_factor

EQUAL = 6
"""Gauss points of the distribution of the pressure over the nodes [1]."""
CELL = 0.15
"""Places per unit of log-pressure of the table on which all samples share their matrices [1]."""
_POWER = 0.8
"""The stiffness grows about like this power of the pressure; what is left is interpolated."""
_PLAN = ("pattern.", "plate.")
"""Prefixes of what decides the distribution of the pressure."""
FEW, FEW_SIDES = 7, 16
"""Loads at which the loss factor is computed, and what elastic sides make of the stiffness [1]."""
_BELOW = 1e-6
"""Where the table begins, over the pressure at which the closing ends [1]: K is a power of p there."""
SHEAR = 0.05
"""Shear over the force of all bolts [1] at which `uncertainty` tells the loss factor: half of what the least
usual mu carries."""
MOST = 0.8
"""Most shear over that at which all slips [1]: of less friction the loss factor is told there."""
STEPS = 6
"""Of the integration up to the shear [1]."""


@lru_cache(maxsize=64)
def equal_pressures(pattern: PressureSource) -> tuple[Array, Array]:
    """Pressure over mean pressure (q) [1], ascending, and shares of the area (q) that stand for all nodes.

    Open nodes have no part in it.
    """
    shape = pressure_distribution(pattern)
    closed = shape.preload_shape > 0.0
    logs, shares = discrete_gauss(np.log(shape.preload_shape[closed]), shape.area_share[closed], EQUAL)
    return np.exp(logs), shares


@dataclass(frozen=True, slots=True)
class Places:
    """Places on the log-pressure relative to the mean pressure at the end of the ramp, for all samples.

    table : (t) where the rows are read
    force : (f) log of the force over its end, for the integral of dF/K
    """

    table: Array
    force: Array

    @classmethod
    def of(cls, start: float, equal: Array, most: float) -> "Places":
        """From the log of the force over its end, `start`, to the greatest pressure over the mean one."""
        force = np.arange(start, 0.5 * CELL, CELL)
        table = np.arange(start + np.log(equal[0]) - CELL, np.log(most) + 2.0 * CELL, CELL)
        return cls(table, force)

    def sums(self, equal: Array, shares: Array, force: Array) -> Array:
        """(t, force) from values over p^POWER at the table's places to sums over the nodes at forces."""
        spline = CubicSpline(self.table, np.eye(self.table.size))
        total = np.zeros((self.table.size, force.size))
        for e, share in zip(equal, shares, strict=True):
            total += share * np.exp(_POWER * (force + np.log(e))) * spline(force + np.log(e)).T
        return total

    def at(self, scaled: Array, logs: Array) -> Array:
        """(n, e) from values (n, t) over p^POWER at the table's places to values at log-pressures (e) over
        the mean one at the end; before the first place they go as that power."""
        spline = CubicSpline(self.table, np.eye(self.table.size))
        weight = np.exp(_POWER * logs) * spline(np.maximum(logs, self.table[0])).T
        return np.asarray(scaled @ weight)

    def integral(self, force: Array) -> Array:
        """(f, force) from an integrand over the log of the force to its integral from the first place."""
        return np.asarray(CubicSpline(self.force, np.eye(self.force.size)).antiderivative()(force).T)


def evaluate(
    parameters: type[Any], values: Mapping[str, Any], loads: Array, factor: Array
) -> dict[str, Array]:
    """K_zz, K_xx [N/m], C_zz, C_xx [N.s/m], approach [m], slip_force [N] and loss_factor [1] (n, m) at
    preloads factor (n, 1) times loads (m) that embedding has left.

    The approach is the integral of dF/K_zz of the interface over the force F of all bolts, from zero.
    values : by structured name, numbers or samples (n); samples of the pattern go one by one
    """
    samples = {name for name, value in values.items() if isinstance(value, np.ndarray)}
    names = [name for name in values if name.startswith(_PLAN) and name in samples]
    if not names:
        return _evaluate(parameters, values, loads, factor)
    parts = []
    for i in range(factor.size):
        sample = {k: v[i : i + 1] if isinstance(v, np.ndarray) else v for k, v in values.items()}
        sample |= {name: float(values[name][i]) for name in names}
        parts.append(_evaluate(parameters, sample, loads, factor[i : i + 1]))
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@lru_cache(maxsize=8)
def _matrices(
    pattern: PressureSource, start: float, most: float, ramp: bytes
) -> tuple[Places, Array, Array, Array]:
    equal, shares = equal_pressures(pattern)
    places, force = Places.of(start, equal, most), np.frombuffer(ramp)
    ends = (places.force, force)
    to_force, to_ramp = (places.sums(equal, shares, end) for end in ends)
    return places, to_force, to_ramp, places.integral(force)


def _evaluate(
    parameters: type[Any], values: Mapping[str, Any], loads: Array, factor: Array
) -> dict[str, Array]:
    joint = columns(parameters, values, 1)
    pattern = type(joint.pattern)(**flatten_parameters(joint.pattern))
    equal, shares = equal_pressures(pattern)
    touching = loads > 0.0
    ramp = np.log(loads[touching] / loads[-1])
    mean = np.broadcast_to(factor * loads[-1] * joint.n_bolts / joint.A_0, factor.shape)
    works = ("plastic_work", "elastic_work") if joint.plastic_damping else ()
    sides = Sides.of(joint, pattern) if joint.elastic else None
    most = max(float(equal[-1]), sides.most if sides else 0.0)
    rows, closed = tabulate(joint, 0.0 * mean, mean * most * np.exp(2.0 * CELL), works)
    first = float(np.min(np.log(_BELOW * closed / mean))) - np.log(equal[-1])
    start = CELL * np.floor(min(first, ramp[0] - 1.0) / CELL / 10.0) * 10.0
    places, to_force, to_ramp, integral = _matrices(pattern, start, most, ramp.tobytes())
    end = np.log(joint.hardness)
    table = held(rows, places.table, np.log(mean), end)
    scaled = {name: np.exp(value - _POWER * places.table) for name, value in table.items()}
    direct = ramp < np.max(np.log(closed / mean)) - np.log(equal[0]) + 4.0 * CELL
    near = [held(rows, ramp[direct], np.log(mean * e), end) for e in equal] if np.any(direct) else []

    def total(name: str) -> Array:
        sums = scaled[name] @ to_ramp
        if near:
            sums[:, direct] = sum(share * np.exp(n[name]) for share, n in zip(shares, near, strict=True))
        return np.asarray(sums)

    force = joint.A_0 * mean * np.exp(places.force)
    compliance = force / (joint.A_0 * (scaled["k"] @ to_force))
    K = joint.A_0 * total("k")
    rho = joint.shear_stiffness_ratio()
    C = 0.0 * K
    if works:
        C = mindlin.equivalent_damping(total(works[0]) / total(works[1]), joint.mass, K)
    eta_t = joint.loss_factor()
    tangential = mindlin.equivalent_damping(eta_t, joint.mass, rho * K)
    approach = 3.0 * compliance[:, :1] + compliance @ integral
    curves = {"K_zz": K, "K_xx": rho * K, "C_zz": C, "C_xx": tangential, "approach": approach}
    zero = np.zeros((factor.size, int(np.sum(~touching))))
    curves = {name: np.concatenate([zero, value], axis=1) for name, value in curves.items()}
    slip = np.broadcast_to(slip_force(joint, factor * loads), curves["K_zz"].shape)
    pulling = np.where(touching, 1.0, AT_LIFT_OFF)
    curves["K_zz"] = curves["K_zz"] + joint.n_bolts * joint.bolt_stiffness * pulling
    if sides:
        few, between = _few(ramp, FEW_SIDES)
        at = np.concatenate([[-np.inf], few])
        for name, K in sides.stiffness(joint, places, scaled["k"], at).items():
            curves[name][:, touching] = np.exp(np.log(K[:, 1:]) @ between)
            curves[name][:, ~touching] = K[:, :1]
    few, between = _few(ramp, FEW)
    lost = loss_factors(_pressed(table["k"], places, few), equal, shares, joint.mu, (factor.size, few.size))
    lost = lost @ between
    return curves | {"slip_force": slip, "loss_factor": np.concatenate([zero, lost], axis=1)}


class Sides(NamedTuple):
    """What elastic sides make of the stiffness of points and patches, by one motion and k modes.

    equal  : (points), (patches) [1] pressure over mean pressure
    normal : (points, (1 + k)^2) [1] products of how far they come apart by s_z and the modes, times shares
    shear  : (patches, (1 + k)^2) [1] of how far they shift by s_x and the modes
    bolts  : ((1 + k)^2) [1] of how far their seats come apart
    modes  : (k) [N/m]
    """

    equal: tuple[Array, Array]
    normal: Array
    shear: Array
    bolts: Array
    modes: Array

    @classmethod
    def of(cls, joint: Bolted, pattern: PressureSource) -> "Sides":
        """Raises ValueError for bodies that were computed for another contact."""
        shape, few = contact_points(pattern), friction_patches_of(pattern)
        assert isinstance(joint.bodies, ElasticBodies)
        modes = Modes.of(joint.bodies, shape.area_share.size, few.position)
        bolts = len(modes.bolt_elongation)
        along_x = tangential_jacobian(few)[:, :, :1]

        def products(weight: Array, *motions: tuple[Array, Array]) -> Array:
            rows = [np.column_stack(motion) for motion in motions]
            return np.asarray(sum(np.einsum("n,ni,nj->nij", weight, row, row) for row in rows)).reshape(
                len(weight), -1
            )

        return cls(
            (shape.preload_shape, pressure_transfer(shape, few) @ shape.preload_shape),
            products(shape.area_share, (np.ones(len(shape.area_share)), modes.opening)),
            products(few.area_share, *zip(along_x, modes.patch_displacement, strict=True)),
            products(np.ones(bolts), (np.ones(bolts), modes.bolt_elongation)).sum(axis=0),
            modes.stiffness,
        )

    @property
    def most(self) -> float:
        """Greatest pressure over the mean one [1]."""
        return float(max(np.max(equal) for equal in self.equal))

    def stiffness(self, joint: Bolted, places: Places, scaled: Array, ramp: Array) -> dict[str, Array]:
        """K_zz and K_xx (n, m) [N/m] of the whole, tightened, at logs (m) of loads over the end of the ramp.

        scaled : (n, t) stiffness of the interface over p^POWER at the table's places
        """
        size, found = 1 + len(self.modes), []
        for load in ramp:
            with np.errstate(divide="ignore"):
                points, patches = (places.at(scaled, load + np.log(equal)) for equal in self.equal)
            pulling = 1.0 if np.isfinite(load) else AT_LIFT_OFF
            normal = joint.A_0 * (points @ self.normal) + joint.bolt_stiffness * self.bolts * pulling
            shear = joint.shear_stiffness_ratio() * joint.A_0 * (patches @ self.shear)
            H = np.stack([each.reshape(-1, size, size) for each in (normal, shear)])
            beside = np.moveaxis(H[:, :, 1:, 0], 0, -1)
            follow = np.linalg.solve(H.sum(axis=0)[:, 1:, 1:] + np.diag(self.modes), beside)
            found.append(H[:, :, 0, 0] - np.einsum("nkd,nkd->dn", beside, follow))
        return dict(zip(("K_zz", "K_xx"), np.stack(found, axis=-1), strict=True))


def _few(ramp: Array, count: int) -> tuple[Array, Array]:
    """Few loads, as logs (f), and what carries values there to the ramp (f, m): what changes smoothly."""
    if ramp.size <= count:
        return ramp, np.eye(ramp.size)
    few = np.linspace(ramp[0], ramp[-1], count)
    return few, np.asarray(CubicSpline(few, np.eye(count))(ramp).T)


def _pressed(log_k: Array, places: Places, ramp: Array) -> Callable[[Array], Array]:
    """Stiffness (n, m, e) at pressures over the mean ones (n, m, e) of a ramp (m), from its log (n, t) at the
    table's places; beyond the places it goes as a power."""
    first, last = places.table[0], places.table[-1]
    rest = log_k - _POWER * places.table
    row = np.arange(len(log_k))[:, None, None]

    def stiffness(pressure: Array) -> Array:
        x = np.log(pressure) + ramp[:, None]
        at = (np.clip(x, first, last) - first) / CELL
        i = np.minimum(at.astype(np.int64), places.table.size - 2)
        low, high = rest[row, i], rest[row, i + 1]
        return np.asarray(np.exp(low + (at - i) * (high - low) + _POWER * x))

    return stiffness


def shear_at(joint: Bolted, left: float) -> float:
    """Shear [N] of `uncertainty` under the force [N] of each bolt."""
    return joint.n_bolts * left * min(SHEAR, MOST * joint.mu)


def loss_factors(
    stiffness: Callable[[Array], Array], pressure: Array, share: Array, mu: Array, shape: tuple[int, int]
) -> Array:
    """`report.loss_factor` at SHEAR for samples and loads (n, m).

    stiffness : (n, m, e) [1] of pressures over mean pressure (n, m, e), up to a factor of each (n, m)
    pressure  : (e) [1] over mean pressure, with shares (e) of the area
    mu        : (n, 1)

    Shear falls short of the friction by what the pressure p - S of an earlier approach has: at each place
    p(delta - v) falls with v = u K_T/(K_N mu), and the mean fall S carries the shear mu S. With dv/dS = c the
    loss is 4 mu^2 K_N/K_T times the integral of (2 S - S_end) c, the stored energy half of mu^2 K_N/K_T S_end
    times that of c.
    """
    end = np.minimum(SHEAR / mu, MOST) + np.zeros(shape)
    step = end / STEPS
    now = np.broadcast_to(pressure, (*shape, pressure.size))

    def rate(there: Array) -> tuple[Array, Array]:
        k = stiffness(np.maximum(there, 1e-30))
        c = 1.0 / (k @ share)
        return -k * c[..., None], c

    h, moments = step[..., None], np.zeros((2, *shape))
    for i in range(STEPS):
        first, c0 = rate(now)
        second, c1 = rate(now + 0.5 * h * first)
        third, c2 = rate(now + 0.5 * h * second)
        fourth, c3 = rate(now + h * third)
        now = now + h / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        for part, c in zip((0.0, 0.5, 1.0), (c0 / 6.0, (c1 + c2) / 3.0, c3 / 6.0), strict=True):
            moments += np.stack([c, (2.0 * (i + part) * step - end) * c]) * step
    return np.asarray(4.0 / np.pi * moments[1] / (end * moments[0]))


def exact(joint: Bolted, loads: Array) -> dict[str, Array]:
    """Stiffness, damping, approach, slip force and loss factor (m) of the spring on all nodes, in full stick,
    at preloads (m) [N] that embedding has left; the first two of the exported joint with elastic sides.
    """
    alone = replace(interface_alone(joint), memory=False, embedding=0.0)
    spring, rest = BoltedJointSpring.of_nodes(alone), (0.0, 0.0, 0.0)
    tightened = BoltedJointSpring.of(replace(joint, embedding=0.0)) if joint.elastic else spring
    states = [tightened.evaluate(float(load), 0.0, rest, rest) for load in loads]
    curves = {name: np.array([state[name] for state in states]) for name in _OUTPUTS}
    pressure = node_pressure(
        alone, spring.points.preload_shape, spring.points.moment_shape, loads[:, None], 0.0
    )
    slip = (
        alone.A_0 * spring.friction.foundation().friction_coefficient * (pressure @ spring.points.area_share)
    )
    lost = [loss_factor(spring, each, shear_at(alone, each)) if each > 0.0 else 0.0 for each in loads]
    found = {"approach": approach(spring, loads), "slip_force": slip, "loss_factor": np.array(lost)}
    return curves | found


def approach(spring: BoltedJointSpring, loads: Array) -> Array:
    """Integral of dF/K_zz over the force of all bolts from 0 to preloads (m) [N].

    Three Gauss-Legendre nodes per log-spaced panel; nodes of the pressure pattern that its symmetry makes
    equal are taken together.
    """
    joint, shape = spring.joint, spring.points.merge_nodes(keeps_moment=False)
    lowest = 1e-9 * spring.curve.closing_end_load * joint.A_0 / joint.n_bolts
    ends = np.unique(np.concatenate([np.geomspace(lowest, np.max(loads), 60), loads[loads > lowest]]))
    places, weights = np.polynomial.legendre.leggauss(3)
    half, middle = 0.5 * np.diff(np.log(ends)), 0.5 * np.log(ends[1:] * ends[:-1])
    preload = np.concatenate([ends[:1], np.exp(middle[:, None] + half[:, None] * places).ravel()])
    node = spring.curve.inverse(
        node_pressure(joint, shape.preload_shape, shape.moment_shape, preload[:, None], 0.0)
    )
    K = joint.A_0 * spring.curve.derivatives(node, 1)[1] @ shape.area_share
    rate = joint.n_bolts * preload / K
    panels = half * (rate[1:].reshape(-1, 3) @ weights)
    integral = 3.0 * rate[0] + np.concatenate([[0.0], np.cumsum(panels)])
    return np.where(loads > lowest, integral[np.clip(np.searchsorted(ends, loads), 0, ends.size - 1)], 0.0)


_OUTPUTS = ("K_zz", "K_xx", "C_zz", "C_xx")
REDUCED = ReducedCurves(
    load=replace(KIND.variables["preload"], doc="force of each bolt after embedding"),
    outputs=(
        *(KIND.variables[name] for name in _OUTPUTS),
        Variable("approach", "m", "approach of the two sides by tightening, from zero preload", 1e-6),
        Variable("slip_force", "N", "shear force at which the whole interface slips", 1e4),
        Variable("loss_factor", "1", f"of a loop under a shear of {SHEAR:g} times the bolts' force", 0.1),
    ),
    default_end=lambda joint: 30e3,
    max_load=lambda joint: joint.H * joint.A_0 / joint.n_bolts,
    evaluate=evaluate,
    exact=exact,
)
