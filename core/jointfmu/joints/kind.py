"""Description of a joint: parameters, interface laws, models and checks. All tools loop over these."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from .model import Model, Variable


@dataclass(frozen=True, slots=True)
class RoughSurface:
    """Rough surface of a joint, whose fractal parameters can be fitted to measured heights.

    parameter_prefix  : prefix of the names of the parameters D (fractal dimension), G (fractal roughness)
    is_areal          : True: D_s and G_s of the surface; False: D and G of a profile
    profile_direction : direction of the profile on a textured surface, "x" or "y"; None: direction of less
                        scatter
    """

    parameter_prefix: str
    is_areal: bool = False
    profile_direction: str | None = None


class FlangeRating(NamedTuple):
    """Rated values at a flange of a joint, to scale the bodies and loads of a system to the joint.

    rated_load                : rated force or torque [N or N.m]
    motion_over_output_motion : motion of the flange, divided by that of the joint's output flange [1]
    static_friction_load      : dry friction at rest [N or N.m]
    """

    rated_load: float
    motion_over_output_motion: float
    static_friction_load: float


def use_parameters_as_law(parameter_set: object) -> object:
    """Return a joint's parameter set unchanged, as its interface law.

    For joints whose parameters are those of the law.
    """
    return parameter_set


def accept_any_parameters(parameter_set: object) -> Iterable[str]:
    """Return an empty list of contradictions: for a joint whose parameters are independent."""
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class JointKind:
    """Description of one kind of joint.

    name          : name of the joint's folders, and `joint = NAME` in parameter files
    package       : import name of its subpackage
    default_file_stem : stem of the file name of its default parameter file
    laws          : {name of a law: class of the joint's parameter set with this law}, the default law first.
                    Interface laws have their name in contact.laws.LAWS
    extract_law   : function, parameter set of the joint -> parameter set of its interface law; None if the
                    joint has none
    laws_without_interface : names of the laws that are not the law of an interface; `extract_law` gives None
    models        : exported models; the first is the component of the joint in a system model
    surfaces      : rough surfaces whose fractal parameters can be fitted to measured heights
    working_point : names of the inputs that fix the point of linearisation (preload, ...); the first one is
                    always required
    find_contradictions : function, parameter set -> one message per parameter that contradicts another one;
                    a parameter file with contradictions is an error
    find_flange_ratings : function, parameter set -> {flange: rated values}; empty if none are known
    """

    name: str
    package: str
    default_file_stem: str
    laws: Mapping[str, type[object]]
    extract_law: Callable[[Any], Any] = use_parameters_as_law
    laws_without_interface: Sequence[str] = ()
    models: Sequence[Model]
    surfaces: Sequence[RoughSurface] = ()
    working_point: Sequence[str] = ()
    find_contradictions: Callable[..., Iterable[str]] = accept_any_parameters
    find_flange_ratings: Callable[..., Mapping[str, FlangeRating]] = lambda parameters: {}

    @property
    def title(self) -> str:
        """Name of the joint with spaces: "gear mesh"."""
        return self.name.replace("_", " ")

    @property
    def default_parameter_class(self) -> type[object]:
        """Class of the parameter set with the default law."""
        return next(iter(self.laws.values()))

    def law_name(self, parameter_set: object) -> str:
        """Name of the law of a parameter set, a key of `laws`."""
        return next(name for name, cls in self.laws.items() if type(parameter_set) is cls)

    def find_model(self, fmu_name: str | None = None) -> Model:
        """Model with the name of an FMU; None: the first model. Raises ValueError if there is none."""
        models = {model.name: model for model in self.models}
        if fmu_name is not None and fmu_name not in models:
            raise ValueError(
                f"fmu = {fmu_name!r} is not a model of a {self.name}, allowed are {', '.join(models)}"
            )
        return models[fmu_name or next(iter(models))]

    @property
    def variables(self) -> dict[str, Variable]:
        """Inputs and outputs {name: variable} of all FMU models of the joint."""
        return {v.name: v for model in self.models for v in (*model.inputs, *model.outputs)}

    @property
    def is_builtin(self) -> bool:
        """Whether the joint is part of jointfmu, not of another package."""
        return self.package.startswith(f"{__package__}.")

    def tabulate(self, parameter_set: object) -> object:
        """Compute the load-displacement table of a parameter set; return the joint that evaluates it."""
        return self.models[0].tabulate(parameter_set)

    def default_file(self, law_name: str | None = None) -> Path:
        """Path of the joint's default parameter file with a law; None: with the default law.

        The file is models/NAME/`default_file_stem`.toml; the name of another law follows the stem after an
        underscore. A joint of another package has its files in the folder models/ of that package.
        """
        stem = (
            self.default_file_stem
            if law_name in (None, next(iter(self.laws)))
            else f"{self.default_file_stem}_{law_name}"
        )
        folder = files("jointfmu_models") / self.name if self.is_builtin else files(self.package) / "models"
        return Path(str(folder / f"{stem}.toml"))
