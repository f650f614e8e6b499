"""What a joint's folder says of the joint; everything that knows joints loops over these."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from .model import Model, Variable


@dataclass(frozen=True, slots=True)
class RoughSurface:
    """Parameters `PREFIX.D` and `PREFIX.G` that a measured surface decides.

    areal     : they are D_s and G_s of the surface, else D and G of a profile
    direction : of the profile on a textured surface, "x" or "y"; None: whichever is surer
    """

    prefix: str
    areal: bool = False
    direction: str | None = None


def itself(parameters: object) -> object:
    """The interface law of a joint whose parameter set is one."""
    return parameters


def none(parameters: object) -> Iterable[str]:
    """No contradictions: each parameter stands for itself."""
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """A joint.

    name          : of its folders, and `joint = NAME` in parameter files
    package       : import name of its folder
    default       : stem of its default parameter file
    laws          : {interface law: its parameter set with this law}, the default first; a name of
                    contact.laws.LAWS, or any other if it has no interface law
    law_of        : the law's parameter set out of the joint's; None with a law that is of no interface
    models        : what it is exported as; the first is its component in a system model
    surfaces      : its rough surfaces
    working_point : names of inputs that its linearisations need (preload, ...), the first always
    contradictions : of a parameter set: a line for each parameter that contradicts another; what a parameter
                    file must not have
    """

    name: str
    package: str
    default: str
    laws: Mapping[str, type[object]]
    law_of: Callable[[Any], Any] = itself
    models: Sequence[Model]
    surfaces: Sequence[RoughSurface] = ()
    working_point: Sequence[str] = ()
    contradictions: Callable[..., Iterable[str]] = none

    @property
    def title(self) -> str:
        """Its name as words."""
        return self.name.replace("_", " ")

    @property
    def parameters(self) -> type[object]:
        """Its parameter set with the default law."""
        return next(iter(self.laws.values()))

    def law(self, parameters: object) -> str:
        """Name of the interface law of a parameter set."""
        return next(name for name, cls in self.laws.items() if type(parameters) is cls)

    def model(self, name: str | None = None) -> Model:
        """The model of an FMU, of the first without a name. Raises ValueError if it has none of that name."""
        models = {model.name: model for model in self.models}
        if name is not None and name not in models:
            raise ValueError(f"fmu = {name!r} is none of a {self.name}, allowed are {', '.join(models)}")
        return models[name or next(iter(models))]

    @property
    def variables(self) -> dict[str, Variable]:
        """Inputs and outputs of all its models by name."""
        return {v.name: v for model in self.models for v in (*model.inputs, *model.outputs)}

    @property
    def own(self) -> bool:
        """Whether it comes with this package, and not from another one."""
        return self.package.startswith(f"{__package__}.")

    def spring(self, parameters: object) -> object:
        """The tabulated joint of a parameter set."""
        return self.models[0].spring(parameters)

    def default_file(self, law: str | None = None) -> Path:
        """Its default parameter file, models/NAME/DEFAULT.toml, with another law DEFAULT_LAW.toml; of another
        package models/ in its folder."""
        stem = self.default if law in (None, next(iter(self.laws))) else f"{self.default}_{law}"
        folder = files("jointfmu_models") / self.name if self.own else files(self.package) / "models"
        return Path(str(folder / f"{stem}.toml"))
