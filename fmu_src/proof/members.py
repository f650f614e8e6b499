"""Files of the proof inside an FMU."""

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, dump

from .experiments import ReferenceExperiment, experiments, models, study
from .files import archive

_MOST_KEPT = 16
_kept: dict[tuple[str, str], tuple[ReferenceExperiment, ...]] = {}
"""{(FMU, text of its parameter file): its experiments}, the latest last."""


def proof(model: Model, parameters: ParameterFile, native: bool = True) -> dict[str, bytes]:
    """{path in the FMU: content}; reference results are the package's.

    native : whether of a native FMU, which has a page and model exchange; else of the python flavour
    """
    given = model, parameters
    return archive(*given, models(*given), computed(*given), study(*given), native)


def computed(model: Model, parameters: ParameterFile) -> tuple[ReferenceExperiment, ...]:
    """All experiments, computed once for the flavours of an FMU."""
    key = model.name, dump(parameters)
    if key not in _kept:
        _kept[key] = tuple(experiments(model, parameters))
        for old in [*_kept][:-_MOST_KEPT]:
            del _kept[old]
    return _kept[key]
