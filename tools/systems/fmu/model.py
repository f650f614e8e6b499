"""Model of a system for its FMU: components in the order of evaluation, and the sources of their inputs."""

from collections.abc import Mapping, Sequence
from dataclasses import Field, dataclass, fields, make_dataclass, replace
from typing import Any, NamedTuple

from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import flatten_fields
from jointfmu.quantity.declaration import group_field

SYSTEM_KIND = "system"
"""Value of `Model.joint` for the model of a system, which has no kind of joint."""
FORCE_LAG_PARAMETERS = ("lag_a", "lag_b")
"""Parameters of bodies that are needed only if joints and bodies are separate FMUs."""


def full_name(component_name: str, variable_name: str) -> str:
    """Name of a component's variable in the system: COMPONENT.VARIABLE.

    A component without a name gives the names of its variables directly.
    """
    return f"{component_name}.{variable_name}" if component_name else variable_name


class InputSource(NamedTuple):
    """Source of a component's input: an output of another component, or an input of the system."""

    component: str
    variable: str


@dataclass(frozen=True, slots=True)
class SystemComponent:
    """Component of a system: load, joint or body.

    name            : empty for a component whose variables have no prefix
    fmu_model       : model of its FMU; that of a body lacks the parameters in FORCE_LAG_PARAMETERS
    source_by_input : {input: its source}; None: the input is zero. Inputs without an entry are inputs of the
        system
    start_values    : {input of the system: start value} if it is not zero
    """

    name: str
    fmu_model: Model
    parameter_file: ParameterFile
    source_by_input: Mapping[str, InputSource | None]
    start_values: Mapping[str, float]

    def full_name(self, variable_name: str) -> str:
        """Name of a variable or parameter of the component in the system: COMPONENT.VARIABLE."""
        return full_name(self.name, variable_name)

    @property
    def system_inputs(self) -> list[Variable]:
        """Inputs of the component that no other component drives: they are inputs of the system's FMU."""
        return [v for v in self.fmu_model.inputs if v.name not in self.source_by_input]

    @property
    def degree_of_freedom_count(self) -> int:
        """Number of degrees of freedom of the component."""
        return self.fmu_model.state_count // 2

    @property
    def exposed_parameters(self) -> list[str]:
        """Names of the component's parameters that are FMU variables of the system."""
        return [*self.fmu_model.parameter_fields()]


@dataclass(frozen=True, slots=True)
class SystemModel:
    """Model of a system, for one FMU: its components, and times of the default experiment.

    components         : loads, then joints, then bodies, so that the inputs of a component depend only on
        states and on components before it
    stop_time          : stop time [s] of the default experiment
    communication_step : communication step [s] of the default experiment
    separate_fmu_step  : communication step [s] that separate FMUs would need
    step_tolerance     : tolerance of the speeds of an implicit step [1], if the host states none
    """

    name: str
    description: str
    components: Sequence[SystemComponent]
    stop_time: float
    communication_step: float
    separate_fmu_step: float
    step_tolerance: float = 1e-5

    @property
    def bodies(self) -> list[SystemComponent]:
        """Bodies of the system: components with states."""
        return [component for component in self.components if component.fmu_model.state_count]

    @property
    def inputs(self) -> list[tuple[SystemComponent, Variable]]:
        """Inputs of the system as (component, variable)."""
        return [(component, v) for component in self.components for v in component.system_inputs]

    @property
    def outputs(self) -> list[tuple[SystemComponent, Variable]]:
        """Outputs of the system as (component, variable).

        First positions, speeds and accelerations of bodies, then the others.
        """
        moving = [
            (component, v)
            for k in range(3)
            for component in self.bodies
            for v in component.fmu_model.outputs[
                k * component.degree_of_freedom_count : (k + 1) * component.degree_of_freedom_count
            ]
        ]
        return moving + [
            (component, v)
            for component in self.components
            for v in component.fmu_model.outputs[3 * component.degree_of_freedom_count :]
        ]

    def make_fmu_model(self) -> Model:
        """Make the model of the FMU, whose variables are called COMPONENT.VARIABLE."""
        sets = [part for p in self.components for part in _list_parameter_groups(p)]
        hidden = [
            p.full_name(name)
            for p in self.components
            for name, _ in flatten_fields(type(p.parameter_file.values))
            if name not in p.exposed_parameters
        ]
        return Model(
            name=self.name,
            joint=SYSTEM_KIND,
            doc=self.description,
            parameter_class=make_dataclass(
                "SystemParameters",
                [(f"group{k}", cls, item) for k, (cls, item, _) in enumerate(sets)],
                frozen=True,
                kw_only=True,
            ),
            tabulate=lambda values: values,
            inputs=[prefix_component_name(component, v) for component, v in self.inputs],
            outputs=[prefix_component_name(component, v) for component, v in self.outputs],
            evaluate=_raise_not_in_python,
            validity_limits=(),
            ramp=LoadRamp("", self.stop_time, self.communication_step, self.communication_step),
            dependencies=self._find_dependencies(),
            fixed_parameters=hidden,
            state_count=sum(p.fmu_model.state_count for p in self.components),
            is_time_dependent=True,
            initial_history=_raise_not_in_python
            if any(p.fmu_model.initial_history for p in self.components)
            else None,
            advance=_raise_not_in_python
            if any(p.fmu_model.initial_history for p in self.components)
            else None,
        )

    def make_system_parameter_file(self, system_fmu_model: Model) -> ParameterFile:
        """Make the parameter file of the system from the parameter files of all components."""

        def collect_entries(mapping_name: str) -> dict[str, Any]:
            """{name in the system: entry} of a mapping of all parameter files, as values or sources."""
            return {
                p.full_name(name): value
                for p in self.components
                for name, value in getattr(p.parameter_file, mapping_name).items()
            }

        groups = [value for p in self.components for *_, value in _list_parameter_groups(p)]
        values = system_fmu_model.parameter_class(**{f"group{k}": value for k, value in enumerate(groups)})
        starts = {p.full_name(v.name): p.start_values.get(v.name, v.start) for p, v in self.inputs}
        return ParameterFile(
            SYSTEM_KIND, self.name, values, collect_entries("origins"), collect_entries("sources"), starts
        )

    def _find_dependencies(self) -> dict[str, list[str]]:
        """{output: inputs of the system and states on which it depends}."""
        dependencies: dict[str, dict[str, None]] = {}
        states = [(p, v) for p in self.bodies for v in p.fmu_model.outputs[: p.fmu_model.state_count]]
        for component, v in (*states, *self.inputs):
            dependencies[component.full_name(v.name)] = {component.full_name(v.name): None}
        for component in self.components:
            for v in component.fmu_model.outputs[component.fmu_model.state_count :]:
                sources: dict[str, None] = {}
                for name in component.fmu_model.list_dependencies(v.name):
                    feed = component.source_by_input.get(name, InputSource(component.name, name))
                    if feed:
                        sources |= dependencies[full_name(*feed)]
                dependencies[component.full_name(v.name)] = sources
        inputs = {component.full_name(v.name) for component, v in self.inputs}
        return {name: [*sources] for name, sources in dependencies.items() if name not in inputs}


def _list_parameter_groups(component: SystemComponent) -> list[tuple[type, Any, Any]]:
    """List (class, field, value) of the groups of a component's parameters.

    The names are those in the system.
    """
    values = component.parameter_file.values
    if component.name:
        return [
            (type(values), group_field(component.fmu_model.doc, **{component.name: type(values)}), values)
        ]
    return [
        (type(getattr(values, item.name)), _copy_parameter_group(item), getattr(values, item.name))
        for item in fields(values)
    ]


def _copy_parameter_group(parameter_group: Field[Any]) -> Any:
    """New dataclass field for a group of parameters, for the class of another component."""
    return group_field(parameter_group.metadata["doc"], **parameter_group.metadata["alternatives"])


def prefix_component_name(component: SystemComponent, variable: Variable) -> Variable:
    """Copy of a variable with the name COMPONENT.VARIABLE."""
    return replace(
        variable,
        name=component.full_name(variable.name),
        doc=f"{variable.doc} ({component.name})" if component.name else variable.doc,
    )


def _raise_not_in_python(*arguments: object) -> Any:
    """Raise NotImplementedError: replaces the Python functions of a system's model, which exist only in C."""
    raise NotImplementedError("a system has no Python functions; run its FMU (fmi2 or fmi3)")
