"""The gear mesh in the Modelica library, run by rumoca."""

from typing import Any

import numpy as np
import pytest
from test_modelica import EXACT, move, simulate, top

from jointfmu.joints.gear_mesh.spring import GearMeshSpring, base_pitch
from jointfmu.parameters import default

pytestmark = pytest.mark.slow

SPRING = GearMeshSpring.of(default("gear_mesh").values)
MESH = SPRING.joint


def rolling(cycles: float, along: float) -> tuple[float, float]:
    """Rates of both wheels [rad/s] for so many mesh cycles and a way along the line of action [m]."""
    way = cycles * float(base_pitch(MESH))
    return (way + 0.5 * along) / MESH.r_b1, (0.5 * along - way) / MESH.r_b2


@pytest.mark.parametrize(
    ("start", "rate"),
    [
        pytest.param((-1e-2, 0.0), (2e-2, 0.0), id="both flanks to beyond the table"),
        pytest.param((0.0, 1e-3), rolling(2.4, 4e-5), id="mesh cycles under load"),
        pytest.param((0.0, 0.0), rolling(1.2, -2e-4), id="into the back flanks"),
    ],
)
def test_component_gives_the_torques_of_the_package(
    start: tuple[float, float], rate: tuple[float, float]
) -> None:
    rumoca: Any = pytest.importorskip("rumoca")
    moved = "".join(
        f"\n  Move m{i}(at={at!r}, rate={w!r});" for i, at, w in zip((1, 2), start, rate, strict=True)
    )
    text = top(
        f"JointStiffness.Components.GearMesh mesh;{moved}",
        "connect(m1.flange, mesh.flange_a);\n  connect(mesh.flange_b, m2.flange);",
        move("Rotational", "phi"),
    )
    found = simulate(rumoca, text, 1.0, 1e-3)
    phi1, phi2 = (at + w * found.time for at, w in zip(start, rate, strict=True))
    exact = SPRING.motion(phi1, rate[0], phi2, rate[1])
    exact |= {"flange_a.tau": -exact["tau1"], "flange_b.tau": -exact["tau2"]}
    for name in ("flange_a.tau", "flange_b.tau", "s_rel", "f", "K", "pairs", "E"):
        # where damping and spring cancel the error is that of the larger one
        least = 1e-6 * np.abs(exact[name]).max()
        error = np.abs(found[f"mesh.{name}"] - exact[name])
        assert np.all(error <= EXACT * np.maximum(np.abs(exact[name]), least)), name
    assert np.ptp(exact["E"]) > 0.0
