"""Shared functions of the tests of native FMUs: the package's results, and calls in both interfaces."""

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
"""Relative difference [1] between flavours and package: the same law with another mathematical library, other
orders of summation and separate inversions. Measured over random parameters: 4e-12 for K_TS and K_zz, in
which terms cancel, below 1e-12 for all others."""
VERSIONS = ("fmi2", "fmi3")
SAID = {
    "lifecycle": "all lives are well\n",
    "modes": "every call is answered in every mode\n",
    "refusals": "every wrong call is refused with its reason\n",
}
"""{program of tests/native/hosts: its last output}; a program that did not run prints nothing."""


def close(expected: Any, tolerance: float = SAME) -> Any:
    """Approximation with a relative tolerance only, because outputs may be small numbers."""
    return pytest.approx(expected, rel=tolerance, abs=0.0)


def near(name: str, expected: Inputs) -> dict[str, Any]:
    """Approximation as `close`, plus 1e-14 of the nominal value of outputs whose terms cancel."""
    nominal = {v.name: v.nominal for v in MODELS[name].outputs}
    return {o: pytest.approx(value, rel=SAME, abs=1e-14 * nominal[o]) for o, value in expected.items()}


def package(name: str, changes: dict[str, Any] | None = None) -> Law:
    """Joint of the package, in the virgin state."""
    return law(name, parameters(name, changes))


def attempt(call: Callable[..., Any], *args: Any) -> tuple[Any, str]:
    """Result of a call into the package, or the message of its refusal."""
    try:
        with np.errstate(all="ignore"):
            return call(*args), ""
    except (ValueError, RuntimeError) as error:
        return None, str(error)


def numbers(instance: Fmu) -> dict[str, float]:
    """Values of all variables except Booleans; in FMI 3.0 with the time."""
    return instance.get(*(v.name for v in instance.variables.values() if v.type != "Boolean"))


def settle(instance: Fmu) -> None:
    """Continue the simulation: do a step, or go to continuous-time mode and back to the next event."""
    if instance.is_model_exchange:
        instance.fmu.enterContinuousTimeMode()
        instance.time += 1.0
        instance.fmu.setTime(instance.time)
        instance.fmu.enterEventMode()
    else:
        instance.step()


def slope(instance: Fmu, **slopes: float) -> None:
    """Set derivatives of inputs for the next step (FMI 2.0)."""
    references = [instance.variables[n].valueReference for n in slopes]
    instance.fmu.setRealInputDerivatives(references, [1] * len(slopes), list(slopes.values()))


def jacobian(instance: Fmu) -> dict[tuple[str, str], float]:
    """Jacobian {(output, input): derivative}, one input at a time."""
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
    """Assert that the derivatives of all outputs with respect to an input are those of the package, for a
    virgin start.

    The references are central differences of fourth order. A kink or jump between their points is detected by
    the difference to central differences of second order, which is at least a quarter of its effect on the
    fourth order.
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
"""Tolerance of derivative times input size, over the output. At h = 1e-3, truncation h^4 and round-off
1e-16/h of the differences are below 1e-11; jumps of the third derivative at table nodes, about h apart, are
larger. Measured: 8e-9."""
KINKS = 2e-3
"""Tolerance as DIFFERENCE for an output with kinks; two kinks can cancel in the differences. Measured: 6e-4.
"""
JUMPS = 1e-4
"""Tolerance as DIFFERENCE for an output that contains the third derivative. Measured for K_zz: 2e-6."""


def allowed(name: str, output: str) -> float:
    """Tolerance of an output's derivative against differences."""
    if output in CASES[name].numbers.kinks:
        return KINKS
    return JUMPS if output in CASES[name].numbers.jumps else DIFFERENCE
