"""A system as its FMU is made of it: components in the order of their evaluation, and what feeds them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, make_dataclass, replace
from typing import Any, NamedTuple

from jointfmu.joints.model import LoadRamp, Model, Variable
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import flat_fields
from jointfmu.quantity.declaration import group_field

SYSTEM = "system"
"""What stands for the kind of joint in the model of a system."""
LAGS = ("lag_a", "lag_b")
"""Parameters of bodies that only a master of separate FMUs needs."""


class Feed(NamedTuple):
    """An output that feeds an input."""

    component: str
    output: str


@dataclass(frozen=True, slots=True)
class SystemComponent:
    """A load, joint or body.

    model : of a body without LAGS
    feeds : {input: what feeds it}; None: nothing, it is zero. Inputs without an entry are the system's
    start : {input of the system: start value} where it is not zero
    """

    name: str
    model: Model
    parameters: ParameterFile
    feeds: Mapping[str, Feed | None]
    start: Mapping[str, float]

    @property
    def free(self) -> list[Variable]:
        """Inputs that are the system's."""
        return [v for v in self.model.inputs if v.name not in self.feeds]

    @property
    def exposed(self) -> list[str]:
        """Its parameters that are the system's."""
        return [*self.model.parameter_fields()]


@dataclass(frozen=True, slots=True)
class SystemModel:
    """A system.

    components : loads, then joints, then bodies: each takes from those before it, and the states of bodies
    stop, interval : of the default experiment [s]
    own_interval : step [s] that its motion asks of separate FMUs
    """

    name: str
    doc: str
    components: Sequence[SystemComponent]
    stop: float
    interval: float
    own_interval: float

    @property
    def bodies(self) -> list[SystemComponent]:
        """Components with states."""
        return [part for part in self.components if part.model.state_count]

    @property
    def inputs(self) -> list[tuple[SystemComponent, Variable]]:
        """Inputs of the system, by component."""
        return [(part, v) for part in self.components for v in part.free]

    @property
    def outputs(self) -> list[tuple[SystemComponent, Variable]]:
        """Outputs: places, speeds, accelerations of all bodies; then those of loads and joints."""
        bodies = self.bodies
        moving = [(part, part.model.outputs[k]) for k in range(3) for part in bodies]
        return moving + [
            (part, v) for part in self.components if not part.model.state_count for v in part.model.outputs
        ]

    def model(self) -> Model:
        """What is exported; variables are called COMPONENT.VARIABLE."""
        sets = [(p.name, type(p.parameters.values), group_field(p.model.doc)) for p in self.components]
        hidden = [
            f"{p.name}.{name}"
            for p in self.components
            for name, _ in flat_fields(type(p.parameters.values))
            if name not in p.exposed
        ]
        return Model(
            name=self.name,
            joint=SYSTEM,
            doc=self.doc,
            parameters=make_dataclass("SystemParameters", sets, frozen=True, kw_only=True),
            tabulate=lambda values: values,
            inputs=[with_component_name(part, v) for part, v in self.inputs],
            outputs=[with_component_name(part, v) for part, v in self.outputs],
            evaluate=_not_in_python,
            validity_limits=(),
            ramp=LoadRamp("", self.stop, self.interval, self.interval),
            dependencies=self._dependencies(),
            fixed_parameters=hidden,
            state_count=2 * len(self.bodies),
            is_time_dependent=True,
            initial_history=_not_in_python if any(p.model.initial_history for p in self.components) else None,
            advance=_not_in_python if any(p.model.initial_history for p in self.components) else None,
        )

    def parameters(self, model: Model) -> ParameterFile:
        """Of all components, in the form of a joint's."""

        def every(of: str) -> dict[str, Any]:
            return {
                f"{p.name}.{name}": value
                for p in self.components
                for name, value in getattr(p.parameters, of).items()
            }

        values = model.parameters(**{p.name: p.parameters.values for p in self.components})
        starts = {f"{part.name}.{v.name}": part.start.get(v.name, v.start) for part, v in self.inputs}
        return ParameterFile(SYSTEM, self.name, values, every("origins"), every("sources"), starts)

    def _dependencies(self) -> dict[str, list[str]]:
        """{output: inputs of the system and states that it depends on}."""
        found: dict[str, dict[str, None]] = {}
        for part in self.bodies:
            for v in part.model.outputs[:2]:
                found[f"{part.name}.{v.name}"] = {f"{part.name}.{v.name}": None}
        for part in self.components:
            states = {v.name for v in part.model.outputs[: part.model.state_count]}
            for v in part.model.outputs[part.model.state_count :]:
                reached: dict[str, None] = {}
                for name in part.model.list_dependencies(v.name):
                    feed = part.feeds.get(name)
                    if name in states or name not in part.feeds:
                        reached[f"{part.name}.{name}"] = None
                    elif feed:
                        reached |= found[f"{feed.component}.{feed.output}"]
                found[f"{part.name}.{v.name}"] = reached
        return {name: [*reached] for name, reached in found.items()}


def with_component_name(component: SystemComponent, v: Variable) -> Variable:
    """A variable of a component with the component's name before its own."""
    return replace(v, name=f"{component.name}.{v.name}", doc=f"{v.doc} ({component.name})")


def _not_in_python(*given: object) -> Any:
    raise NotImplementedError("a system is evaluated in C alone")
