"""Largest stable communication step of a system, from the largest stable step of each joint."""

from collections.abc import Mapping, Sequence

import numpy as np
from jointfmu_fmu_src.partners import PARTNERS

from jointfmu.mechanics.stable_steps import MAX_STABLE_STEP, STABLE_STEP_OUTPUTS
from jointfmu.quantity import Array, replace_values

from .system import Component, System
from .wiring import ConnectionEnd, find_connections, find_model, find_signals

_INERTIA_PARAMETER_BY_FLANGE = {"flange1": "inertia1", "flange2": "inertia2"} | dict.fromkeys(
    ("flange_x", "flange_y", "flange_z"), "mass"
)
"""{flange of a joint: parameter with the inertia of the body on this flange}."""


def find_largest_stable_step(
    system: System, simulation_results: Mapping[str, Array] | None = None
) -> tuple[float, str]:
    """Largest stable step [s] of a system with a parallel master, and the name of the joint that limits it.

    Each joint is treated alone with the bodies on it. An undamped joint has no stable step with a parallel
    master; then the step of a sequential master is used.

    simulation_results : time series of all connected outputs; the stable step is evaluated at their largest
        joint loads. None: at the start values

    Raises ValueError for invalid connections of the system.
    """
    connected, signals, steps = find_connections(system), find_signals(system), [(MAX_STABLE_STEP, "")]
    for name, component in system.joints.items():
        bodies = _find_flange_inertias(component, connected)
        if not component.parameter_file or not any(bodies.values()):
            continue
        model = find_model(component)
        spring = model.tabulate(replace_values(component.parameter_file.values, bodies))
        start = {
            v.name: component.parameter_file.start_value(v.name) for v in model.inputs
        } | component.constant_inputs
        operating_points: list[dict[str, float]] = [{}]
        if simulation_results:
            rows = {
                int(np.argmax(np.abs(simulation_results[f"{name}.{w.source_output}"])))
                for w in signals
                if w.source_component == name
            }
            input_values = {
                w.target_input: simulation_results[f"{w.source_component}.{w.source_output}"]
                for w in signals
                if w.target_component == name
            }
            operating_points = [{key: float(column[k]) for key, column in input_values.items()} for k in rows]
        for inputs in operating_points:
            out = model.evaluate(spring, start | inputs)
            sequential, parallel = (float(out.get(key, MAX_STABLE_STEP)) for key, _ in STABLE_STEP_OUTPUTS)
            steps.append((parallel or sequential, name))
    return min(steps)


def _find_flange_inertias(
    component: Component, connections: Sequence[tuple[ConnectionEnd, ConnectionEnd]]
) -> dict[str, float]:
    """{parameter of a joint: inertia of the body on its flange}; 0 for a flange on the ground."""
    inertias = {
        key: 0.0
        for key in ("inertia1", "inertia2")
        if component.parameter_file and key in component.parameter_file.values_by_name
    }
    for first, second in connections:
        key = (
            _INERTIA_PARAMETER_BY_FLANGE.get(first.flange.terminal_name)
            if first.component is component and first.flange
            else None
        )
        if key and second.component:
            inertia = second.component.stated_values[
                PARTNERS[second.component.model_name].parameter_class.inertia_name
            ]
            inertias[key] = min(inertia, inertias.get(key) or inertia)
    return inertias
