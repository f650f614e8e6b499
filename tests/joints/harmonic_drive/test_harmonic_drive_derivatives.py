"""Derivatives of the harmonic drive's FMUs keep the closed relations of the drive."""

import numpy as np
from joint_cases import random_inputs
from natives import Host, close, jacobian


def test_derivatives_keep_the_closed_relations_of_the_drive(host: Host, version: str) -> None:
    ratio, d = 80.0, 0.7
    spring = host("HarmonicDriveSpring", version).start({"ratio": ratio, "d": d})
    compliance = host("HarmonicDriveCompliance", version).start()
    beyond = {"phi1": 0.0, "w1": 0.0, "phi2": 0.05, "w2": 1.0}
    for state in (*random_inputs("HarmonicDriveSpring", 20, seed=33), beyond):
        values, J = spring.at(state), jacobian(spring)
        K = values["K_WTS"]
        assert J["tau", "phi2"] == close(K, 1e-12)
        assert J["tau", "phi1"] == close(-K / ratio, 1e-12)
        assert (J["tau", "w2"], J["tau", "w1"]) == close((d, -d / ratio), 1e-12)
        for moved in state:
            assert J["tau1", moved] == close(J["tau", moved] / ratio, 1e-12)
            assert J["tau2", moved] == -J["tau", moved]
            series = J["K_TS", moved] / values["K_TS"] ** 2 - J["K_WTS", moved] / K**2
            assert abs(series) <= 1e-12 * abs(J["K_WTS", moved]) / K**2
        assert (J["phi_rel", "phi1"], J["phi_rel", "phi2"]) == close((-1.0 / ratio, 1.0), 1e-12)
    assert J["K_WTS", "phi2"] == 0.0  # beyond the table: a straight line
    for tau in (*np.linspace(-29.0, 29.0, 15), 100.0):
        wound, J = compliance.at({"tau": float(tau)}), jacobian(compliance)
        assert J["phi_rel", "tau"] == close(1.0 / wound["K_WTS"], 1e-12)
    assert J["K_WTS", "tau"] == 0.0
