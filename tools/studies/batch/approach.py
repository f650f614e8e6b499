"""Stiffness and approach over pressure of an interface, tabulated for many samples at once.

The same curve as `curve.approach_curve` with fewer nodes: load and stiffness are integrals over the log-area
u of the largest spot, from the end of the contact's closing on; Chebyshev polynomials between the ends of the
law's regimes. A table is a row of nodes per sample, ascending in the log-pressure, with cubics between them.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from jointfmu.contact.interface import ONE_SIDED_OFFSET, InterfaceLaw, find_checked_spots
from jointfmu.contact.powerlaw import SpotDistribution
from jointfmu.mechanics.curve import CLOSING_AREA_RATIO, closing_length_ratio, closing_pressure
from jointfmu.quantity import Array, ParameterLimit, assemble_parameter_set, flat_fields, flatten_parameters

Mask = NDArray[np.bool_]
T = TypeVar("T")


def columns(cls: type[T], values: Mapping[str, object], axes: int = 0) -> T:
    """The parameter set `cls` with samples (n) among its values, as (n, 1, ...) with `axes` ones.

    Unchecked: `inside` tells the samples apart.
    """
    shaped = {k: v.reshape(-1, *[1] * axes) if isinstance(v, np.ndarray) else v for k, v in values.items()}
    return assemble_parameter_set(cls, shaped, _unchecked)


def _unchecked(cls: type[object], arguments: Mapping[str, object]) -> object:
    """A frozen instance without its checks, which take no samples."""
    instance = object.__new__(cls)
    for name, value in arguments.items():
        object.__setattr__(instance, name, value)
    return instance


def inside(joint: object, count: int) -> Mask:
    """Which of `count` samples have every parameter in its interval, those that others decide included."""
    good = np.ones(count, dtype=bool)
    values = flatten_parameters(joint)
    for name, item in flat_fields(type(joint)):
        meta, value = item.metadata, values.get(name)
        if "allowed" in meta or not isinstance(value, np.ndarray):
            continue
        good &= meta["interval"].contains(value)
        if meta["whole"]:
            good &= value % 1.0 == 0.0
    with np.errstate(all="ignore"):
        for which in ("find_limits", "find_table_limits"):
            limits = getattr(joint, which, None)
            good &= within(values, limits() if limits else [], count)
    return good


def within(values: Mapping[str, object], limits: Iterable[ParameterLimit], count: int) -> Mask:
    """Which samples lie between the limits that other parameters decide."""
    good = np.ones(count, dtype=bool)
    for limit in limits:
        good &= limit.interval.contains(np.asarray(values[limit.name]))
    return good


def nodes(count: int) -> Array:
    """Chebyshev points of the second kind on [0, 1], ends included, ascending."""
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))))


@cache
def coefficients(count: int) -> Array:
    """(count, count) from values at `nodes` to Chebyshev coefficients: values @ matrix."""
    return np.asarray(np.linalg.inv(chebyshev.chebvander(2.0 * nodes(count) - 1.0, count - 1)).T)


def interpolation(count: int, x: Array) -> Array:
    """(count, x.size) from values at `nodes` to values at x in [0, 1]: values @ matrix."""
    return np.asarray(coefficients(count) @ chebyshev.chebvander(2.0 * x - 1.0, count - 1).T)


def integration(count: int, x: Array) -> Array:
    """(count, x.size) from values at `nodes` to integrals from 0 to x: values @ matrix."""
    # column j: coefficients of the integral of T_j
    integral = chebyshev.chebint(np.eye(count), lbnd=-1.0, axis=0)
    at = chebyshev.chebvander(2.0 * x - 1.0, count) @ integral
    return np.asarray(np.where(x > 0.0, 0.5 * coefficients(count) @ at.T, 0.0))


def discrete_gauss(values: Array, weights: Array, count: int) -> tuple[Array, Array]:
    """Gauss quadrature of a discrete measure: `count` nodes that integrate polynomials of its values exactly.

    values, weights : (n) of the measure
    Returns nodes and weights (count), exact up to degree 2 count - 1 (Lanczos; Golub and Welsch 1969).
    """
    from scipy.linalg import eigh_tridiagonal

    total = float(np.sum(weights))
    basis = [np.sqrt(weights / total)]
    diagonal, off = [], []
    for k in range(count):
        q = values * basis[k]
        diagonal.append(float(q @ basis[k]))
        for earlier in (*basis, *basis):  # twice: keeps the basis orthogonal to round-off
            q = q - (q @ earlier) * earlier
        norm = float(np.linalg.norm(q))
        if k + 1 == count or norm <= 1e-13 * float(np.max(np.abs(values))):
            break
        off.append(norm)
        basis.append(q / norm)
    at, vectors = eigh_tridiagonal(np.array(diagonal), np.array(off))
    return np.asarray(at), np.asarray(total * vectors[0] ** 2)


COLLOCATION = 15
"""Chebyshev nodes per regime [1]."""
FINE = 29
"""Nodes of the table per regime [1]."""
WIDEST = 8.0
"""Log-area of a regime [1] from which on it is taken in several parts."""
CLOSING = np.unique(np.round(512.0 * np.geomspace(1.0 / 512.0, 1.0, 64)).astype(int))[:-1]
"""Nodes of the closing of the contact, out of 512 evenly spaced ones [1]."""
_CHEBYSHEV = nodes(COLLOCATION)
_INTEGRAL = integration(COLLOCATION, _CHEBYSHEV)
_UNIFORM = np.linspace(0.0, 1.0, FINE)
_REFINE = interpolation(COLLOCATION, _UNIFORM)


@dataclass(frozen=True, slots=True)
class Rows:
    """Nodes (n, k) of every sample, all in logarithms: pressure, and by name values and slopes in it."""

    pressure: Array
    values: Mapping[str, tuple[Array, Array]]

    def __call__(self, common: Array, offset: Array) -> dict[str, Array]:
        """Values (n, m) by name at the log-pressures common (m), ascending, + offset (n, 1).

        Below the first node a power of the pressure, as at the node.
        """
        right = self._right(common, offset)
        left = right - 1
        x0 = np.take_along_axis(self.pressure, left, 1)
        h = np.take_along_axis(self.pressure, right, 1) - x0
        h = np.where(h > 0.0, h, 1.0)
        t = (common + offset - x0) / h
        inside = np.maximum(t, 0.0)
        out = {}
        for name, (value, slope) in self.values.items():
            y0, y1 = (np.take_along_axis(value, i, 1) for i in (left, right))
            s0, s1 = (h * np.take_along_axis(slope, i, 1) for i in (left, right))
            square, cube = 3.0 * (y1 - y0) - 2.0 * s0 - s1, s0 + s1 - 2.0 * (y1 - y0)
            out[name] = y0 + s0 * t + inside**2 * (square + inside * cube)
        return out

    def _right(self, common: Array, offset: Array) -> NDArray[np.intp]:
        """Index (n, m) of the node above: how many nodes lie at or below a place, counted once per node."""
        (n, k), m = self.pressure.shape, common.size
        first = np.searchsorted(common, self.pressure - offset)
        cells = first + np.arange(n)[:, None] * (m + 1)
        count = np.bincount(cells.ravel(), minlength=n * (m + 1)).reshape(n, m + 1)
        return np.asarray(np.clip(np.cumsum(count[:, :m], axis=1), 1, k - 1))


def tabulate(
    law: InterfaceLaw, lowest: Array, highest: Array, names: tuple[str, ...] = ()
) -> tuple[Rows, Array]:
    """Rows of `k` (stiffness per area [N/m3]), `s` (approach from first touch [m]) and further totals of
    the law by name between pressures (n, 1) [Pa]; and the pressures (n, 1) [Pa] at which the closing of
    the contact ends.

    Parameters of the law are (n, 1) or scalars. Further totals keep their value inside the closing.
    """
    spots, area = find_checked_spots(law), law.A_0
    shape = np.shape(highest)
    first = np.broadcast_to(spots.stiffness_onset_log_area + np.log(CLOSING_AREA_RATIO), shape)
    load = spots.total("load", first)
    span = np.log(highest * area / load) / spots.size_exponent  # ln F grows at least with m u
    last = first + np.maximum(span, 0.1)
    nodes, rises = _regimes(spots, first, last, ("load", "normal", *names))
    p, k = (nodes[name] - np.log(area) for name in ("load", "normal"))
    relative = {name: rises[name] / rises["load"] for name in ("normal", *names)}
    start, stiff = np.exp(p[:, :1]), np.exp(k[:, :1])
    bend = stiff**2 / start * relative["normal"][:, :1]
    kept = CLOSING if np.any(lowest < start) else CLOSING[:0]
    x, *closed = closing_pressure(start, stiff, bend, kept / 512.0)
    length = closing_length_ratio(start, stiff, bend) * start / stiff
    s = np.log(np.concatenate([length + x, length + nodes["approach"]], axis=1))
    pressure = np.concatenate([np.log(closed[0]), p], axis=1)
    stiffness = np.concatenate([np.log(closed[1]), k], axis=1)
    slope = np.concatenate([closed[2] * closed[0] / closed[1] ** 2, relative["normal"]], axis=1)
    values = {"k": (stiffness, slope), "s": (s, np.exp(pressure - stiffness - s))}
    for name in names:
        flat = np.zeros_like(x)
        values[name] = (
            np.concatenate([flat + nodes[name][:, :1], nodes[name]], axis=1),
            np.concatenate([flat, relative[name]], axis=1),
        )
    return Rows(pressure, values), start


def _regimes(
    spots: SpotDistribution, first: Array, last: Array, names: tuple[str, ...]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """ln of totals and their derivatives in u (n, nodes), and `approach` = integral of dF/K [m].

    Between two ends of regimes a total is m w exp(m u) times the integral of exp(-m t) spot(t), which
    grows from node to node by a Chebyshev polynomial's integral.
    """
    m, grown = spots.size_exponent, 0.0
    sums = {name: spots.total(name, first) * np.exp(-m * first) for name in names}
    logs: dict[str, list[Array]] = {name: [] for name in (*names, "approach")}
    rises: dict[str, list[Array]] = {name: [] for name in names}
    for left, right in _pieces(spots, first, last):
        width = right - left
        u = left + width * _CHEBYSHEV
        side = np.clip(u, left + ONE_SIDED_OFFSET, right - ONE_SIDED_OFFSET)
        decay = m * spots.size_prefactor * np.exp(-m * u)
        rate = {
            name: decay * sum(term.spot_value(side) for term in spots.regime_terms[name]) for name in names
        }
        sums = {name: sums[name][:, -1:] + width * (rate[name] @ _INTEGRAL) for name in names}
        growth = {name: m + rate[name] / sums[name] for name in names}
        approach = grown + width * ((growth["load"] * sums["load"] / sums["normal"]) @ _INTEGRAL)
        grown = approach[:, -1:]
        for name in names:
            logs[name].append((np.log(sums[name]) + m * u) @ _REFINE)
            rises[name].append(growth[name] @ _REFINE)
        logs["approach"].append(approach @ _REFINE)
    return (
        {name: np.concatenate(parts, axis=1) for name, parts in logs.items()},
        {name: np.concatenate(parts, axis=1) for name, parts in rises.items()},
    )


def _pieces(spots: SpotDistribution, first: Array, last: Array) -> list[tuple[Array, Array]]:
    """Ends (n, 1) of the regimes between two log-areas, wide ones in parts; one that no sample reaches is
    left out."""
    inner = [np.clip(np.broadcast_to(end, first.shape), first, last) for end in spots.regime_end_log_areas]
    limits = np.sort(np.concatenate([first, *inner, last], axis=1), axis=1)
    pairs = [(limits[:, i : i + 1], limits[:, i + 1 : i + 2]) for i in range(limits.shape[1] - 1)]
    parts = []
    for left, right in pairs:
        count = int(np.ceil(np.max(right - left) / WIDEST))
        cuts = [left + (right - left) * (i / count) for i in range(count)] + [right]
        parts += [(cuts[i], cuts[i + 1]) for i in range(count)]
    return parts


def held(rows: Rows, common: Array, offset: Array, end: Array) -> dict[str, Array]:
    """`rows` at log-pressures; beyond `end` (n, 1), the log of the hardness, the last tangent continues."""
    values = rows(common, offset)
    if np.any(common[-1] + offset > end):
        last = rows(np.zeros(1), end)
        beyond = common + offset > end
        with np.errstate(over="ignore"):
            excess = np.where(beyond, np.exp(common + offset) - np.exp(end), 0.0)
        values["s"] = np.where(beyond, np.log(np.exp(last["s"]) + excess * np.exp(-last["k"])), values["s"])
        values["k"] = np.where(beyond, last["k"], values["k"])
    return values
