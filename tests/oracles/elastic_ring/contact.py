"""Equilibrium of elastic bodies with unilateral contacts, by Newton's method.

A contact carries a pressure or force that is a monotone function of its overlap, so the energy is
convex and the equilibrium unique.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
ContactLaw = Callable[[Array], tuple[Array, Array]]
"""Contact law: overlap (n) [m] -> load (n) and its derivative, as pressure [Pa] or force per width [N/m]."""

TOLERANCE = 1e-12
"""Remaining energy reduction over the work of contacts and loads [1] at which Newton's method ends."""
UNBALANCED = 1e-4
"""Unbalanced force over the sum of loads and contact forces [1] above which a body counts as unsupported: the
drive has 2e-8, a loose ring about 1."""
MOST_STEPS = 300
_LOOSE = "the contact found no equilibrium: nothing holds a body, or loads are out of all proportion"


@dataclass(frozen=True, slots=True)
class Contact:
    """Unilateral contact: overlap = rows @ unknowns + start (m) [m]; the law gives the loads, with weights
    (m) [m or 1]."""

    rows: Any
    start: Array
    weight: Array
    law: ContactLaw

    def overlap(self, x: Array) -> Array:
        return np.asarray(self.rows @ x + self.start)

    def load(self, x: Array) -> Array:
        return self.law(self.overlap(x))[0]


@dataclass(frozen=True, slots=True)
class Spring:
    """Linear spring [N/m per metre of width] on the linear combination `row` (n) of unknowns."""

    row: Array
    stiffness: float


def linear_contact(modulus: float) -> ContactLaw:
    """Unilateral foundation: pressure = modulus [Pa/m] times overlap, where positive."""
    return lambda d: (modulus * np.maximum(d, 0.0), np.where(d > 0.0, modulus, 0.0))


def hertz_contact(stiffness: float) -> ContactLaw:
    """Unilateral force = stiffness times overlap^(3/2)."""

    def law(d: Array) -> tuple[Array, Array]:
        root = np.sqrt(np.maximum(d, 0.0))
        return stiffness * root**3, 1.5 * stiffness * root

    return law


def equilibrium(
    stiffness: Any,
    load: Array,
    contacts: Sequence[Contact],
    start: Array,
    held: Sequence[int],
    springs: Sequence[Spring] = (),
) -> Array:
    """Unknowns (n) for which rings, contacts and springs are in equilibrium with the load (n).

    stiffness : (n, n) sparse; start : (n) where Newton's method begins; held : unknowns that stay 0

    Raises RuntimeError if Newton's method does not end, or out of balance (a ring that nothing holds).
    """
    free = np.ones(load.size, dtype=bool)
    free[list(held)] = False
    x = np.where(free, start, 0.0)
    rate = _gradient(stiffness, load, contacts, springs, x) * free
    for _ in range(MOST_STEPS):
        step = np.zeros_like(x)
        step[free] = _newton_step(stiffness, contacts, springs, x, rate, free)
        gain = -float(rate @ step)
        scale = abs(float(load @ x)) + sum(
            float(c.weight * c.load(x) @ np.abs(c.overlap(x))) for c in contacts
        )
        if gain <= TOLERANCE * scale:
            x = x + step
            left = _gradient(stiffness, load, contacts, springs, x) * free
            forces = [load, *(c.rows.T @ (c.weight * c.load(x)) for c in contacts)]
            if float(np.abs(left).sum()) > UNBALANCED * sum(float(np.abs(f).sum()) for f in forces):
                break  # whether the factor of a loose ring breaks down is up to round-off
            return x
        part = 1.0
        while True:
            trial = _gradient(stiffness, load, contacts, springs, x + part * step) * free
            if float(trial @ step) <= 0.5 * gain or part < 1e-9:
                break
            part *= 0.5
        x, rate = x + part * step, trial
    raise RuntimeError(_LOOSE)


def _gradient(
    stiffness: Any, load: Array, contacts: Sequence[Contact], springs: Sequence[Spring], x: Array
) -> Array:
    """Gradient (n) of the energy with respect to the unknowns."""
    out = np.asarray(stiffness @ x - load)
    for c in contacts:
        out = out + c.rows.T @ (c.weight * c.load(x))
    for spring in springs:
        out = out + spring.stiffness * (spring.row @ x) * spring.row
    return out


def _newton_step(
    stiffness: Any, contacts: Sequence[Contact], springs: Sequence[Spring], x: Array, rate: Array, free: Any
) -> Array:
    """Newton step of the free unknowns; the spring forces are additional unknowns, so the matrix stays
    sparse."""
    tangent = stiffness
    for c in contacts:
        tangent = tangent + c.rows.T @ sparse.diags(c.weight * c.law(c.overlap(x))[1]) @ c.rows
    tangent = tangent[free][:, free]
    right = -rate[free]
    if springs:
        border = sparse.csr_matrix(np.stack([s.row[free] for s in springs]))
        corner = sparse.diags([-1.0 / s.stiffness for s in springs])
        tangent = sparse.bmat([[tangent, border.T], [border, corner]])
        right = np.concatenate([right, np.zeros(len(springs))])
    try:
        step = splu(tangent.tocsc()).solve(right)
    except RuntimeError:
        raise RuntimeError(_LOOSE) from None
    return np.asarray(step)[: int(np.sum(free))]
