"""Monotone force laws as tables: load over displacement with its exact stiffness.

A table is a quintic Hermite spline through load, stiffness and the stiffness' derivative at the
nodes. The load is twice continuously differentiable, the stiffness is its exact derivative, and
the energy its exact integral.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from math import factorial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..contact.interface import CLOSE, MOST_STEPS, SIDE, InterfaceLaw, checked_spots, largest_spot
from ..contact.powerlaw import Spots
from ..quantity import Array, Number

MAX_ERROR = 1e-8
"""Largest relative interpolation error of load and stiffness [1] that a table may have."""
MOST_NODES = 2600
"""Most nodes of a table: what fits the memory of an FMU's instance."""
FINEST = 16
"""Most times that the steps of a table are doubled, as their factor: 1, 2, 4, ... [1]."""
STEPS = 12
"""Steps of the approach curve per unit of log-area [1], doubled until it is accurate enough."""
CLOSING_STEPS = 48
"""Steps of the closing of the contact."""
GAUSS = np.polynomial.legendre.leggauss(5)
_TO_POLYNOMIAL = np.array(  # (y0, s0, c0, y1, s1, c1) on [0, 1] -> coefficients of 1, t, ... t^5
    [
        [1, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 0],
        [0, 0, 0.5, 0, 0, 0],
        [-10, -6, -1.5, 10, -4, 0.5],
        [15, 8, 1.5, -15, 7, -1],
        [-6, -3, -0.5, 6, -3, 0.5],
    ]
)
_MEANS = 1.0 / np.arange(1.0, 7.0)
"""Means of 1, t, ... t^5 over [0, 1]."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Load over displacement, monotone; beyond its ends it continues with the last tangent.

    displacement, load, stiffness : (n)
    bend_start, bend_end : (n - 1) derivative of the stiffness at the two ends of each segment
    error : [1] largest relative interpolation error of load and stiffness, measured when built
    """

    displacement: Array
    load: Array
    stiffness: Array
    bend_start: Array
    bend_end: Array
    error: float = 0.0
    _coefficients: Array = field(init=False, repr=False)
    _energies: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        h = np.diff(self.displacement)
        y, s = self.load, self.stiffness
        data = np.stack([y[:-1], s[:-1] * h, self.bend_start * h**2, y[1:], s[1:] * h, self.bend_end * h**2])
        object.__setattr__(self, "_coefficients", _TO_POLYNOMIAL @ data)
        whole = h * (_MEANS @ self._coefficients)
        object.__setattr__(self, "_energies", np.concatenate([[0.0], np.cumsum(whole)]))

    @property
    def closed(self) -> float:
        """Load at zero displacement: where the closing of the contact ends."""
        return float(self.load[np.searchsorted(self.displacement, 0.0)])

    @property
    def end(self) -> tuple[float, float]:
        """Displacement and load at the end of the table."""
        return float(self.displacement[-1]), float(self.load[-1])

    def derivatives(self, x: ArrayLike, order: int = 1) -> list[Array]:
        """Load and its first `order` derivatives at displacements x (...)."""
        x = np.asarray(x, dtype=np.float64)
        nodes = self.displacement
        i = _segment(nodes, x)
        inside = np.minimum(np.maximum(x, nodes[0]), nodes[-1])
        first = nodes[i]
        h = nodes[i + 1] - first
        t = (inside - first) / h
        top, *rest = self._coefficients[::-1]
        out = [top[i], *(np.zeros(x.shape) for _ in range(order))]
        for coefficient in rest:  # Horner's scheme for the value and its derivatives over their factorials
            for n in range(order, 0, -1):
                out[n] = out[n] * t + out[n - 1]
            out[0] = out[0] * t + coefficient[i]
        out = [value * (factorial(n) / h**n) for n, value in enumerate(out)]
        beyond = x != inside
        if not np.any(beyond):
            return out
        slope = out[1] if order else self.derivatives(inside, 1)[1]
        out[0] = out[0] + (x - inside) * slope
        return out[:2] + [np.where(beyond, 0.0, value) for value in out[2:]]

    def energy(self, x: ArrayLike) -> Array:
        """Integral (...) of the load from the first node to displacements x (...)."""
        x = np.asarray(x, dtype=np.float64)
        nodes = self.displacement
        i = _segment(nodes, x)
        inside = np.minimum(np.maximum(x, nodes[0]), nodes[-1])
        step = inside - nodes[i]
        t = step / (nodes[i + 1] - nodes[i])
        mean = np.zeros_like(t)
        for part, coefficient in zip(_MEANS[::-1], self._coefficients[::-1, i], strict=True):
            mean = mean * t + part * coefficient
        energy = np.asarray(self._energies[i] + step * mean)
        beyond = x - inside
        if not np.any(beyond):
            return energy
        load, stiffness = self.derivatives(inside, 1)
        return np.asarray(energy + beyond * (load + 0.5 * beyond * stiffness))

    def odd_inverse(self, load: ArrayLike) -> Array:
        """`inverse` (...) of a curve from zero on that is odd, at loads (...) of either sign."""
        y = np.asarray(load, dtype=np.float64)
        return np.asarray(np.copysign(self.inverse(np.abs(y)), y))

    def inverse(self, load: ArrayLike) -> Array:
        """Displacement (...) at which the table carries a load (...), to round-off.

        Safeguarded Newton inside the segment; on a flat beginning (zero stiffness) the first node.
        """
        y = np.asarray(load, dtype=np.float64)
        nodes, places = self.load, self.displacement
        i = _segment(nodes, y)
        inside = np.minimum(np.maximum(y, nodes[0]), nodes[-1])
        first, h = places[i], places[i + 1] - places[i]
        low, high = np.zeros(y.shape), np.ones(y.shape)
        t = (inside - nodes[i]) / (nodes[i + 1] - nodes[i])
        top, *rest = self._coefficients[::-1, i]
        for _ in range(MOST_STEPS):
            value, slope = top, np.zeros(y.shape)
            for coefficient in rest:
                slope = slope * t + value
                value = value * t + coefficient
            residual = inside - value
            rises = residual > 0.0
            low, high = np.where(rises, t, low), np.where(rises, high, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = t + residual / slope
            newton = (step >= low) & (step <= high)
            new = np.where(newton, step, 0.5 * (low + high))
            done = np.all(np.abs(new - t) <= np.where(newton, CLOSE, 4e-16) * t)
            t = new
            if done:
                break
        x = first + t * h
        edge = np.where(y > nodes[-1], self.stiffness[-1], self.stiffness[0])
        flat = edge == 0.0
        x = np.where(y <= nodes[0], self.displacement[0], x)
        return np.asarray(x + np.where(flat, 0.0, (y - inside) / np.where(flat, 1.0, edge)))


def _segment(nodes: Array, x: Array) -> NDArray[np.intp]:
    """Number (...) of the segment between nodes (n) that x (...) lies in, or next to."""
    return np.minimum(np.maximum(np.searchsorted(nodes, x, side="right") - 1, 0), nodes.size - 2)


def assemble(pieces: list[tuple[Array, Array, Array, Array]], error: float = 0.0) -> Curve:
    """Join pieces (displacement, load, stiffness, bend), each sharing its last node with the next.

    The stiffness is continuous over the joints, its derivative need not be. The error is measured
    against the curve through every second node, at the quarter points of the segments (midway the
    spline is more accurate than elsewhere), and halved: the order falls to one at a kink.
    `error` is that of the data themselves.
    """
    fine, coarse = _join(pieces), _join([tuple(column[::2] for column in piece) for piece in pieces])  # type: ignore[misc]
    nodes = fine.displacement
    points = np.concatenate([nodes[:-1] + part * np.diff(nodes) for part in (0.25, 0.5, 0.75)])
    worst = error
    for value, rough in zip(fine.derivatives(points), coarse.derivatives(points), strict=True):
        loaded = value > 0.0
        worst = max(worst, float(np.max(np.abs(rough - value)[loaded] / value[loaded])) / 2.0)
    return Curve(nodes, fine.load, fine.stiffness, fine.bend_start, fine.bend_end, worst)


def refined(tabulate: Callable[[int], Curve], steps: int) -> Curve:
    """The table with the fewest steps, doubled up to FINEST times as many, whose error is within MAX_ERROR.

    Raises RuntimeError if there is none.
    """
    factor = 1
    while factor <= FINEST:
        curve = tabulate(steps * factor)
        factor *= 2
        if curve.load.size > MOST_NODES:
            raise RuntimeError(
                f"the table needs more than {MOST_NODES} nodes: "
                "the law is not smooth enough with these parameters"
            )
        if curve.error <= MAX_ERROR:
            return curve
    raise RuntimeError(
        f"the table of {curve.load.size} nodes has an interpolation error of {curve.error:.2g}, "
        f"allowed is {MAX_ERROR:g}: the law is not smooth enough with these parameters"
    )


def _join(pieces: list[tuple[Array, Array, Array, Array]]) -> Curve:
    x, y, s = (np.concatenate([piece[k][bool(i) :] for i, piece in enumerate(pieces)]) for k in range(3))
    start = np.concatenate([piece[3][:-1] for piece in pieces])
    end = np.concatenate([piece[3][1:] for piece in pieces])
    return Curve(x, y, s, start, end)


CLOSING_RATIO = 20.0
"""Where the closing of the contact ends [1]: largest spot over the largest plastic spot."""


def closing(p: Number, k: Number, bend: Number, z: Number) -> tuple[Number, Number, Number, Number]:
    """How the contact closes: from separation (p = 0, k = 0) to the point (p, k, dk/d delta).

    While nearly all spots are plastic the laws give a stiffness that vanishes at a finite pressure,
    so that the approach, the integral of dp/k, would start at minus infinity. Below the point where
    the largest spot is CLOSING_RATIO times the largest plastic one the pressure is therefore
    continued to zero by `p z^3 (a + b z + c z^2)` over a length n p/k, twice continuously
    differentiable at both ends. n is 4 unless k grows with less than the power 0.75 of p, where so long a
    closing would begin with a negative load: then the longest that does not. Returned are displacement from
    that point, load, stiffness and its derivative at z from 0 to 1.
    """
    reach = closing_reach(p, k, bend)
    length = reach * p / k
    c = 0.5 * bend * length**2 / p - 3.0 * reach + 6.0
    a, b = 4.0 - reach + c, reach - 3.0 - 2.0 * c
    load = p * z**3 * (a + b * z + c * z**2)
    stiffness = p / length * z**2 * (3.0 * a + 4.0 * b * z + 5.0 * c * z**2)
    slope = p / length**2 * z * (6.0 * a + 12.0 * b * z + 20.0 * c * z**2)
    return (z - 1.0) * length, load, stiffness, slope


def closing_reach(p: Number, k: Number, bend: Number) -> Number:
    """Length of the closing over p/k [1], see `closing`."""
    return 40.0 / (8.0 + np.sqrt(np.maximum(64.0 - 80.0 * bend * p / k**2, 4.0)))


def approach_curve(law: InterfaceLaw) -> Curve:
    """Pressure [Pa] over approach [m] of an interface: the integral of dp/k from separation.

    The table runs over the log-area u of the largest spot, in which load and stiffness are explicit,
    from the end of the closing to a nominal pressure equal to the hardness; the approach is
    integrated by five Gauss-Legendre nodes per step. Zero approach is the end of the closing.

    Raises
    ------
    ValueError : at every pressure up to the hardness all spots are plastic (no stiffness)
    """
    spots, area = checked_spots(law), law.A_0
    first = float(spots.stiff_onset + np.log(CLOSING_RATIO))
    last = float(largest_spot(law, law.hardness))
    if not last > first:
        p = float(spots.total("load", first)) / area
        raise ValueError(
            f"the law has no stiffness below {p:.3g} Pa, above the hardness {float(law.hardness):.3g} Pa: "
            "the surface (D, G) leaves only plastic spots"
        )
    return refined(lambda steps: _approach(spots, area, first, last, steps), STEPS)


def _approach(spots: Spots, area: float, first: float, last: float, steps: int) -> Curve:
    """The table between two log-areas with `steps` per unit of log-area."""
    ends = [first, *(b for b in spots.breaks if first < b < last), last]
    pieces, offset = [], 0.0
    for left, right in pairwise(ends):
        n = max(2 * int(np.ceil(0.5 * steps * (right - left))), 2)
        u = np.linspace(left, right, n + 1)
        half = 0.5 * (u[1] - u[0])
        inner = u[:-1, None] + half * (1.0 + GAUSS[0])
        rise = half * (spots.slope("load", inner) / spots.total("normal", inner)) @ GAUSS[1]
        x = offset + np.concatenate([[0.0], np.cumsum(rise)])
        offset = x[-1]
        side = np.clip(u, left + SIDE, right - SIDE)  # one-sided derivative where a regime ends
        k = spots.total("normal", u) / area
        bend = k * spots.slope("normal", side) / spots.slope("load", side)
        pieces.append((x, spots.total("load", u) / area, k, bend))
    _, p, k, bend = (float(column[0]) for column in pieces[0])
    return assemble([closing(p, k, bend, np.linspace(0.0, 1.0, CLOSING_STEPS + 1)), *pieces])
