"""Model of a system for its FMU: components in the order of evaluation, and the sources of their inputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, make_dataclass, replace
from typing import Any, NamedTuple

from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import flatten_fields
from jointfmu.quantity.declaration import group_field

SYSTEM_KIND = "system"
"""Value of `Model.joint` for the model of a system."""
LAG_PARAMETERS = ("lag_a", "lag_b")
"""Parameters of bodies that are needed only if joints and bodies are separate FMUs."""


class InputSource(NamedTuple):
    """Source of an input: an output of another component."""

    component: str
    output: str


@dataclass(frozen=True, slots=True)
class SystemComponent:
    """Component of a system: load, joint or body.

    model        : model of its FMU; that of a body lacks the parameters in LAG_PARAMETERS
    sources      : {input: its source}; None: the input is zero. Inputs without an entry are inputs of the
        system
    start_values : {input of the system: start value} if it is not zero
    """

    name: str
    model: Model
    parameters: ParameterFile
    sources: Mapping[str, InputSource | None]
    start_values: Mapping[str, float]

    @property
    def system_inputs(self) -> list[Variable]:
        """Inputs that are inputs of the system."""
        return [v for v in self.model.inputs if v.name not in self.sources]

    @property
    def variable_parameters(self) -> list[str]:
        """Names of the parameters that are FMU variables of the system."""
        return [*self.model.parameter_fields()]


@dataclass(frozen=True, slots=True)
class SystemModel:
    """Model of a system: its components, and times of the default experiment.

    components        : loads, then joints, then bodies: the inputs of each depend on those before and on
        states
    stop_time         : stop time [s] of the default experiment
    interval          : communication step [s] of the default experiment
    separate_interval : communication step [s] that separate FMUs would need
    """

    name: str
    doc: str
    components: Sequence[SystemComponent]
    stop_time: float
    interval: float
    separate_interval: float

    @property
    def bodies(self) -> list[SystemComponent]:
        """Bodies of the system: components with states."""
        return [component for component in self.components if component.model.state_count]

    @property
    def inputs(self) -> list[tuple[SystemComponent, Variable]]:
        """(component, variable) of the inputs of the system."""
        return [(component, v) for component in self.components for v in component.system_inputs]

    @property
    def outputs(self) -> list[tuple[SystemComponent, Variable]]:
        """(component, variable) of the outputs: positions, speeds, accelerations of bodies; then others."""
        bodies = self.bodies
        moving = [(component, component.model.outputs[k]) for k in range(3) for component in bodies]
        return moving + [
            (component, v)
            for component in self.components
            if not component.model.state_count
            for v in component.model.outputs
        ]

    def make_model(self) -> Model:
        """Make the model of the FMU, whose variables are called COMPONENT.VARIABLE."""
        sets = [(p.name, type(p.parameters.values), group_field(p.model.doc)) for p in self.components]
        hidden = [
            f"{p.name}.{name}"
            for p in self.components
            for name, _ in flatten_fields(type(p.parameters.values))
            if name not in p.variable_parameters
        ]
        return Model(
            name=self.name,
            joint=SYSTEM_KIND,
            doc=self.doc,
            parameter_class=make_dataclass("SystemParameters", sets, frozen=True, kw_only=True),
            tabulate=lambda values: values,
            inputs=[with_component_name(component, v) for component, v in self.inputs],
            outputs=[with_component_name(component, v) for component, v in self.outputs],
            evaluate=_raise_not_in_python,
            validity_limits=(),
            ramp=LoadRamp("", self.stop_time, self.interval, self.interval),
            dependencies=self._find_dependencies(),
            fixed_parameters=hidden,
            state_count=2 * len(self.bodies),
            is_time_dependent=True,
            initial_history=_raise_not_in_python
            if any(p.model.initial_history for p in self.components)
            else None,
            advance=_raise_not_in_python if any(p.model.initial_history for p in self.components) else None,
        )

    def make_parameters(self, model: Model) -> ParameterFile:
        """Make the parameter file of the system from those of all components."""

        def collect(attribute: str) -> dict[str, Any]:
            return {
                f"{p.name}.{name}": value
                for p in self.components
                for name, value in getattr(p.parameters, attribute).items()
            }

        values = model.parameter_class(**{p.name: p.parameters.values for p in self.components})
        starts = {f"{p.name}.{v.name}": p.start_values.get(v.name, v.start) for p, v in self.inputs}
        return ParameterFile(SYSTEM_KIND, self.name, values, collect("origins"), collect("sources"), starts)

    def _find_dependencies(self) -> dict[str, list[str]]:
        """{output: inputs of the system and states on which it depends}."""
        dependencies: dict[str, dict[str, None]] = {}
        for component in self.bodies:
            for v in component.model.outputs[:2]:
                dependencies[f"{component.name}.{v.name}"] = {f"{component.name}.{v.name}": None}
        for component in self.components:
            states = {v.name for v in component.model.outputs[: component.model.state_count]}
            for v in component.model.outputs[component.model.state_count :]:
                sources: dict[str, None] = {}
                for name in component.model.list_dependencies(v.name):
                    feed = component.sources.get(name)
                    if name in states or name not in component.sources:
                        sources[f"{component.name}.{name}"] = None
                    elif feed:
                        sources |= dependencies[f"{feed.component}.{feed.output}"]
                dependencies[f"{component.name}.{v.name}"] = sources
        return {name: [*sources] for name, sources in dependencies.items()}


def with_component_name(component: SystemComponent, variable: Variable) -> Variable:
    """Copy of a variable with the name COMPONENT.VARIABLE."""
    return replace(
        variable, name=f"{component.name}.{variable.name}", doc=f"{variable.doc} ({component.name})"
    )


def _raise_not_in_python(*arguments: object) -> Any:
    """Raise NotImplementedError: replaces the functions of a model that exist only in C."""
    raise NotImplementedError("a system is evaluated in C alone")
