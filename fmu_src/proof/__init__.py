"""The proof inside an FMU: manifest, experiments, inputs and reference results after FMI-LS-REF."""

from dataclasses import dataclass, field
from functools import lru_cache

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, dump

from .experiments import experiments, models, study
from .files import archive

__all__ = ["proof"]


def proof(model: Model, parameters: ParameterFile, native: bool = True) -> dict[str, bytes]:
    """{path in the FMU: content}; reference results are the package's.

    native : whether of a native FMU, which has a page and model exchange; else of the python flavour
    """
    return dict(_proof(_Made(model.name, dump(parameters), native, model, parameters)))


@dataclass(frozen=True)
class _Made:
    """What the files depend on: name, text of the parameter file, kind of FMU; with the objects behind it."""

    name: str
    text: str
    native: bool
    model: Model = field(compare=False)
    parameters: ParameterFile = field(compare=False)


@lru_cache(maxsize=8)
def _proof(made: _Made) -> dict[str, bytes]:
    """The files, once for the flavours of an FMU."""
    given = made.model, made.parameters
    return archive(*given, models(*given), experiments(*given), study(*given), made.native)
