"""A system's file as a system of models, in the order of their evaluation."""

from dataclasses import replace

from jointfmu_fmu_src.partners import parameters as partner_parameters

from ..system import System
from ..wiring import ends, model_of, wires
from .model import LAGS, Feed, SystemComponent, SystemModel

LEAST_INTERVAL = 1e-3
"""Communication step [s] of the default experiment, where the system's own is shorter: it need not be."""


def assembly(system: System) -> SystemModel:
    """Components in the order of their evaluation, with what feeds them.

    Raises ValueError as `wiring.ends`, and for a system without a body.
    """
    feeds: dict[str, dict[str, Feed | None]] = {name: {} for name in system.components}
    for wire in wires(system):
        feeds[wire.target][wire.input] = Feed(wire.source, wire.output)
    for one, other in ends(system):
        if one.joint and one.component and other.component is None:  # held by the ground
            feeds[one.component.name] |= {one.members[m]: None for m in one.members if m != one.flow}
    parts = []
    for name, part in system.components.items():
        model = model_of(part)
        if model.state_count:
            model = replace(model, fixed_parameters=LAGS)
        file = part.file or partner_parameters(part.model).with_values(part.parameters, "user", system.name)
        start = {v.name: file.start_value(v.name) for v in model.inputs} | part.state
        parts.append(SystemComponent(name, model, file, feeds[name], start))
    if not any(part.model.state_count for part in parts):
        raise ValueError(
            f"{system.name}: no component is a body; allowed in one FMU are systems with one or more"
        )
    parts.sort(key=lambda part: (part.model.state_count > 0, not part.model.is_time_dependent))
    interval = max(system.interval, LEAST_INTERVAL)
    return SystemModel(system.name, system.description, parts, system.stop_time, interval, system.interval)
