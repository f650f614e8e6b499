"""Newton's method for the equilibrium, with explicit residuals: without joint and finite elements."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointfmu.joints.bolted_joint import equilibrium

K = np.array([[4.0, 1.0], [-1.0, 3.0]])
"""Stiffness [N/m] for two modal coordinates, not symmetric."""
LOAD = np.array([1.0, 2.0])
"""Force [N] on the modal coordinates at the end of the load step."""


def state(a, residual):
    return SimpleNamespace(
        modal_coordinates=a,
        residual=residual,
        residual_norm=np.max(np.abs(residual)),
        residual_tolerance=1e-12,
    )


def load_step(residual, tangent=K):
    """Load step from rest with this residual [N] as a function of step fraction and modal coordinates."""
    return SimpleNamespace(
        displacement_at=lambda step_fraction: step_fraction,
        evaluate_trial=lambda step_fraction, a: state(a, residual(step_fraction, a)),
        residual_jacobian=lambda trial: tangent,
        input_summary="s_rel_x = 1",
    )


def linear(step_fraction, a):
    return K @ a - step_fraction * LOAD


def test_newton_solves_a_linear_equilibrium():
    found, converged = equilibrium.solve_newton(load_step(linear), 1.0, np.zeros(2), K)
    assert converged
    np.testing.assert_allclose(found.modal_coordinates, np.linalg.solve(K, LOAD), rtol=1e-12)


def test_newton_may_converge_in_the_last_iteration():
    """At a triple root, the residual falls by a constant factor in each iteration."""

    def solve(tolerance):
        def evaluate(_, a):
            return SimpleNamespace(**vars(state(a, a**3)) | {"residual_tolerance": tolerance})

        step = load_step(None)
        step.evaluate_trial = evaluate
        step.residual_jacobian = lambda trial: np.diag(3.0 * trial.modal_coordinates**2)
        return equilibrium.solve_newton(step, 1.0, np.ones(2), 3.0 * np.eye(2))

    last, converged = solve(0.0)
    assert not converged
    assert solve(last.residual_norm)[1]
    assert not solve(0.999 * last.residual_norm)[1]


@pytest.mark.parametrize("change", [0.0, -0.2, 0.2])
def test_a_correction_that_raises_the_energy_is_shortened(change):
    """The energy slope is positive at the start and hardly changes, so regula falsi finds no zero."""
    lengths = []

    def residual(_, a):
        lengths.append(a[0])
        return np.array([1.0 + change * a[0], 0.0])

    start = state(np.zeros(2), np.array([1.0, 0.0]))
    correction = np.array([1.0, 0.0])
    _, is_full = equilibrium.search_line(load_step(residual), 1.0, start, correction, True)
    assert not is_full
    np.testing.assert_allclose(lengths, 0.1 ** np.arange(equilibrium.MAX_LINE_SEARCH_TRIALS))


def test_a_singular_tangent_at_the_start_is_no_equilibrium():
    step = load_step(linear)
    step.start_displacement, step.end_displacement, step.modal_coordinates = (
        np.zeros(6),
        np.ones(6),
        np.zeros(2),
    )
    step.preload_state = step.preload_bolt_force = step.friction_tangent = None
    step.assembly = SimpleNamespace(
        evaluate_normal=lambda *arguments: SimpleNamespace(stiffness=None),
        bolts=SimpleNamespace(active_stiffness=lambda *arguments: None),
        elongation=lambda *arguments: None,
        tangent_stiffness=lambda *arguments: np.zeros((8, 8)),
    )
    with pytest.raises(
        ValueError,
        match=r"s_rel_x = 1: no equilibrium of the joint .* the tangent stiffness .* is singular",
    ):
        equilibrium.solve_equilibrium(step)
