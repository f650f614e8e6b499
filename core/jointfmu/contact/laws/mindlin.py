"""Partial slip of a single contact spot under a shear force (Mindlin and Deresiewicz).

Formulas write x for the traction ratio T/(mu P) [1].

The loop energies of Zhao 2018 are differences of powers of v = (1 - x)^(1/3) that cancel for small x. In the
form factored by `(1 - v)` used here they keep full precision down to x = 0 (derivation in docs/errata.md).
"""

import numpy as np

from ...quantity import Number


def stick_radius_ratio(traction_ratio: Number) -> tuple[Number, Number]:
    """Stick radius ratio v = (1 - x)^(1/3) [1] at the traction ratio 0 <= x < 1, and 1 - v [1].

    1 - v is computed without cancellation.
    """
    log = np.log1p(-traction_ratio) / 3.0
    return np.exp(log), -np.expm1(log)


def dissipated_energy_function(traction_ratio: Number) -> Number:
    """Function H1 [1] of the dissipated energy, Zhao 2018, Eq. 23.

    H1 = 1 - v^5 - (5x/6)(1 + v^2) = (1 - v)^3 (1 + 3v + v^2)/6, with the traction ratio x and the stick
    radius ratio v.
    """
    v, slip = stick_radius_ratio(traction_ratio)
    return slip**3 * (1.0 + 3.0 * v + v**2) / 6.0


def stored_energy_function(traction_ratio: Number) -> Number:
    """Function H2 [1] of the stored energy, Zhao 2018, Eq. 25.

    H2 = 3/5 + (2/5) v^5 - v^2 = (1 - v)^2 (3 + 6v + 4v^2 + 2v^3)/5, with the stick radius ratio v.
    """
    v, slip = stick_radius_ratio(traction_ratio)
    return slip**2 * (3.0 + 6.0 * v + 4.0 * v**2 + 2.0 * v**3) / 5.0


def loss_ratio(traction_ratio: Number) -> Number:
    """Dissipated energy W_d of a shear cycle divided by W, 2 pi times the stored energy: 12 H1/(5 pi H2) [1].

    H1: `dissipated_energy_function`, H2: `stored_energy_function`.
    """
    v, slip = stick_radius_ratio(traction_ratio)
    return 2.0 / np.pi * slip * (1.0 + 3.0 * v + v**2) / (3.0 + 6.0 * v + 4.0 * v**2 + 2.0 * v**3)


def loss_factor(traction_ratio: Number) -> Number:
    """Loss factor eta_t = W_d/(W - W_d) [1] of a shear cycle at the traction ratio, Zhao 2018, Eqs. 27-29.

    W_d: dissipated energy, W: 2 pi times the stored energy; with 5 pi/12 for the printed 5 pi/24.
    """
    ratio = loss_ratio(traction_ratio)
    return ratio / (1.0 - ratio)


def equivalent_damping(loss_factor: Number, mass: Number, stiffness: Number) -> Number:
    """Equivalent viscous damping C = eta sqrt(m K) [N.s/m] (Zhao 2018, Eqs. 20, 29).

    C dissipates as much as the loss factor eta [1] if a mass m [kg] vibrates at resonance on the stiffness
    K [N/m].
    """
    return loss_factor * np.sqrt(mass * stiffness)
