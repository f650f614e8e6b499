"""What the tests of native FMUs share: the package beside them, and how to drive them in both interfaces."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from case import Inputs
from conftest import Fmu
from joint_cases import CASES, STATE, Law, law, parameters

from jointfmu.joints import MODELS

Host = Callable[..., Fmu]

SAME = 1e-9
"""Flavours and package may differ by this [1]: the same law, with another mathematical library, sums in
another order and each its own inversion to round-off. Measured over random parameters: 4e-12 for K_TS and
K_zz, which cancel most, below 1e-12 for all others."""
VERSIONS = ("fmi2", "fmi3")
SAID = {
    "lifecycle": "all lives are well\n",
    "modes": "every call is answered in every mode\n",
    "refusals": "every wrong call is refused with its reason\n",
}
"""{program of tests/native/hosts: what it prints at its end}; a program that was never run prints nothing."""


def close(expected: Any, tolerance: float = SAME) -> Any:
    """Equal to a relative tolerance, without pytest's absolute one: outputs may be small numbers."""
    return pytest.approx(expected, rel=tolerance, abs=0.0)


def near(name: str, expected: Inputs) -> dict[str, Any]:
    """As `close`, but where the terms of an output cancel: 1e-14 of its nominal value is their round-off."""
    nominal = {v.name: v.nominal for v in MODELS[name].outputs}
    return {o: pytest.approx(value, rel=SAME, abs=1e-14 * nominal[o]) for o, value in expected.items()}


def package(name: str, changes: dict[str, Any] | None = None) -> Law:
    """The joint of the package, at rest."""
    return law(name, parameters(name, changes))


def attempt(call: Callable[..., Any], *args: Any) -> tuple[Any, str]:
    """What a call into the package gives, or the reason for its refusal."""
    try:
        with np.errstate(all="ignore"):
            return call(*args), ""
    except (ValueError, RuntimeError) as error:
        return None, str(error)


def numbers(instance: Fmu) -> dict[str, float]:
    """All variables but the Boolean ones, in FMI 3.0 with the time."""
    return instance.get(*(v.name for v in instance.variables.values() if v.type != "Boolean"))


def settle(instance: Fmu) -> None:
    """Let the simulation go on: a step, or on to continuous time and back to the next event."""
    if instance.is_model_exchange:
        instance.fmu.enterContinuousTimeMode()
        instance.time += 1.0
        instance.fmu.setTime(instance.time)
        instance.fmu.enterEventMode()
    else:
        instance.step()


def slope(instance: Fmu, **slopes: float) -> None:
    """Give derivatives of inputs for the next step (FMI 2.0)."""
    references = [instance.variables[n].valueReference for n in slopes]
    instance.fmu.setRealInputDerivatives(references, [1] * len(slopes), list(slopes.values()))


def jacobian(instance: Fmu) -> dict[tuple[str, str], float]:
    """{(output, input): derivative}, an input at a time."""
    inputs = [v.name for v in instance.variables.values() if v.causality == "input"]
    unknowns = [instance.variables[o].valueReference for o in instance.outputs]
    found = {}
    for name in inputs:
        column = instance.fmu.getDirectionalDerivative(
            unknowns, [instance.variables[name].valueReference], [1.0]
        )
        found |= {(o, name): value for o, value in zip(instance.outputs, column, strict=True)}
    return found


def check_slopes(
    name: str,
    state: Inputs,
    moved: str,
    slopes: Mapping[str, float],
    changes: dict[str, Any] | None = None,
) -> None:
    """Derivatives of all outputs in an input are those of the package, which was started with no input.

    Central differences of fourth order. A kink or jump of the output between their points makes those of
    second order differ, by at least a quarter of its effect on the one of fourth.
    """
    expected, size = package(name, changes).after(), abs((STATE[name] | CASES[name].numbers.sizes)[moved])
    h = 1e-3 * size
    here, up, down, far, back = (expected(state | {moved: state[moved] + k * h}) for k in (0, 1, -1, 2, -2))
    for output, slope in slopes.items():
        near, wide = ((b[output] - a[output]) / d for a, b, d in ((down, up, 2.0 * h), (back, far, 4.0 * h)))
        most = allowed(name, output) * max(abs(here[output]) / size, abs(slope))
        doubt = 4.0 * abs(near - wide) if output in CASES[name].numbers.kinks else 0.0
        found = (4.0 * near - wide) / 3.0
        assert abs(slope - found) <= most + doubt, (output, moved, slope, found, most, doubt)


DIFFERENCE = 1e-6
"""Derivative times the size of its input, relative to the output or to itself: truncation h^4 and round-off
1e-16/h of the differences at h = 1e-3 are below 1e-11, but the third derivative of the tables jumps at their
nodes, which are about as far apart as the differences reach. Measured: 8e-9."""
KINKS = 2e-3
"""The same for an output with kinks; two of them can hide each other from the differences. Measured: 6e-4."""
JUMPS = 1e-4
"""The same for an output that holds the third derivative itself. Measured for K_zz: 2e-6."""


def allowed(name: str, output: str) -> float:
    """How far a derivative of an output may be from its differences."""
    if output in CASES[name].numbers.kinks:
        return KINKS
    return JUMPS if output in CASES[name].numbers.jumps else DIFFERENCE
