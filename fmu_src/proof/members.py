"""Verification files inside an FMU, with cached reference results."""

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, format_parameter_file

from .experiments import ReferenceExperiment, experiments, models, study
from .files import archive

_MOST_KEPT = 16
_kept: dict[tuple[str, str], tuple[ReferenceExperiment, ...]] = {}
"""{(FMU, text of its parameter file): its experiments}; the newest entry is last."""


def proof(model: Model, parameters: ParameterFile, native: bool = True) -> dict[str, bytes]:
    """Make the verification files of an FMU, {path: content}; the package computes the reference results.

    is_native : whether the FMU is native; False: python flavour, without page and model exchange
    """
    source = model, parameters
    return archive(*source, models(*source), computed(*source), study(*source), native)


def computed(model: Model, parameters: ParameterFile) -> tuple[ReferenceExperiment, ...]:
    """Experiments of an FMU, computed once for all flavours."""
    key = model.name, format_parameter_file(parameters)
    if key not in _kept:
        _kept[key] = tuple(experiments(model, parameters))
        for old_key in [*_kept][:-_MOST_KEPT]:
            del _kept[old_key]
    return _kept[key]
