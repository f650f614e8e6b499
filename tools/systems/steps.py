"""Largest stable step of a system's co-simulation, joint by joint."""

from collections.abc import Mapping, Sequence

import numpy as np
from jointfmu_fmu_src.partners import PARTNERS

from jointfmu.mechanics.steps import MAX_STEP, STABLE_STEP_OUTPUTS
from jointfmu.quantity import Array, replace_values

from .system import Component, System
from .wiring import End, ends, model_of, wires

_BODIES = {"flange1": "inertia1", "flange2": "inertia2"} | dict.fromkeys(
    ("flange_x", "flange_y", "flange_z"), "mass"
)
"""{flange of a joint: its parameter that is the inertia of the body there}."""


def longest_step(system: System, run: Mapping[str, Array] | None = None) -> tuple[float, str]:
    """The shortest of the joints' largest stable steps [s] where all components step side by side, and its
    joint, each with the bodies on it alone.

    run : of the system: at the largest loads of each joint in it; None: where the system starts

    A joint without damping, of which no step is stable there, has that of a force that arrives at once.

    Raises ValueError as `wiring.ends`.
    """
    connected, signals, found = ends(system), wires(system), [(MAX_STEP, "")]
    for name, part in system.joints.items():
        bodies = _bodies(part, connected)
        if not part.file or not any(bodies.values()):
            continue
        model = model_of(part)
        spring = model.tabulate(replace_values(part.file.values, bodies))
        start = {v.name: part.file.start_value(v.name) for v in model.inputs} | part.state
        places: list[dict[str, float]] = [{}]
        if run:
            rows = {int(np.argmax(np.abs(run[f"{name}.{w.output}"]))) for w in signals if w.source == name}
            fed = {w.input: run[f"{w.source}.{w.output}"] for w in signals if w.target == name}
            places = [{key: float(column[k]) for key, column in fed.items()} for k in rows]
        for inputs in places:
            out = model.evaluate(spring, start | inputs)
            at_once, late = (float(out.get(key, MAX_STEP)) for key, _ in STABLE_STEP_OUTPUTS)
            found.append((late or at_once, name))
    return min(found)


def _bodies(component: Component, connected: Sequence[tuple[End, End]]) -> dict[str, float]:
    """{parameter of a joint: inertia of the body on its flange}, 0 where it is held."""
    found = {
        key: 0.0
        for key in ("inertia1", "inertia2")
        if component.file and key in component.file.values_by_name
    }
    for one, other in connected:
        key = _BODIES.get(one.flange.name) if one.component is component and one.flange else None
        if key and other.component:
            inertia = other.component.values[PARTNERS[other.component.model].parameters.inertia]
            found[key] = min(inertia, found.get(key) or inertia)
    return found
