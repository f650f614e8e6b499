"""The proof inside an FMU: manifest, experiments, inputs and reference results after FMI-LS-REF."""

from dataclasses import dataclass, field
from functools import lru_cache

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, dump

from .experiments import ReferenceExperiment, experiments, models, study
from .files import archive

__all__ = ["computed", "proof"]


def proof(model: Model, parameters: ParameterFile, native: bool = True) -> dict[str, bytes]:
    """{path in the FMU: content}; reference results are the package's.

    native : whether of a native FMU, which has a page and model exchange; else of the python flavour
    """
    given = model, parameters
    return archive(*given, models(*given), computed(*given), study(*given), native)


def computed(model: Model, parameters: ParameterFile) -> tuple[ReferenceExperiment, ...]:
    """All experiments, computed once for the flavours of an FMU."""
    return _computed(_Given(model.name, dump(parameters), model, parameters))


@dataclass(frozen=True)
class _Given:
    """What experiments depend on: name and text of the parameter file; with the objects behind it."""

    name: str
    text: str
    model: Model = field(compare=False)
    parameters: ParameterFile = field(compare=False)


@lru_cache(maxsize=16)
def _computed(given: _Given) -> tuple[ReferenceExperiment, ...]:
    return tuple(experiments(given.model, given.parameters))
