"""Conversion of a system to models with their connections, in the order of evaluation."""

from dataclasses import replace

from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters

from ..system import System
from ..wiring import find_connections, find_model, find_signals
from .arm_links import ArmLinks
from .model import FORCE_LAG_PARAMETERS, InputSource, SystemComponent, SystemModel

MIN_COMMUNICATION_INTERVAL = 1e-3
"""Smallest communication step [s] of the default experiment.

The implicit step of the system needs no smaller one."""
ARM_STEP_TOLERANCE = 1e-6
"""Tolerance of an arm [1]: its oscillations are slow beside the prescribed motion, which sets the scale."""


def assemble_system(system: System) -> SystemModel:
    """Make the model of a system: components in the order of evaluation, with the source of each input.

    All links of an arm are one component with coupled equations of motion.

    Raises ValueError for invalid connections, and for a system without a body.
    """
    feeds: dict[str, dict[str, InputSource | None]] = {name: {} for name in system.components}
    for wire in find_signals(system):
        feeds[wire.target_component][wire.target_input] = InputSource(
            wire.source_component, wire.source_output
        )
    for first, second in find_connections(system):
        if first.is_joint and first.component and second.component is None:  # fixed to the ground
            zero_inputs = {
                variable: None for m, variable in first.variables_by_member.items() if m != first.force_member
            }
            feeds[first.component.name] |= zero_inputs
    components, replaced = [], set[str]()
    if system.arm:  # one component replaces the links and the torques on them
        components.append(ArmLinks(system.arm).make_component())
        replaced = {f"{name}_{part}" for name in system.arm.axis_names for part in ("link", "load")}
    for name, component in system.components.items():
        if name in replaced:
            continue
        model = find_model(component)
        if model.state_count:
            model = replace(model, fixed_parameters=FORCE_LAG_PARAMETERS)
        file = component.parameter_file or partner_parameters(component.model_name).with_values(
            component.parameters, "user", system.name
        )
        start = {v.name: file.start_value(v.name) for v in model.inputs} | component.constant_inputs
        components.append(SystemComponent(name, model, file, feeds[name], start))
    if not any(component.fmu_model.state_count for component in components):
        raise ValueError(
            f"{system.name}: no component is a body; one FMU of a system needs at least one body"
        )
    components.sort(
        key=lambda component: (component.fmu_model.state_count > 0, not component.fmu_model.is_time_dependent)
    )
    interval = max(system.output_interval, MIN_COMMUNICATION_INTERVAL)
    described = SystemModel(
        system.name, system.description, components, system.stop_time, interval, system.output_interval
    )
    return replace(described, step_tolerance=ARM_STEP_TOLERANCE) if system.arm else described
