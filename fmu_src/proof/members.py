"""Verification files inside an FMU, with cached reference results."""

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, format_parameter_file

from .experiments import (
    ReferenceExperiment,
    compute_experiments,
    list_shipped_variants,
    make_uncertainty_study,
)
from .files import make_reference_files

_MAX_CACHED_RESULTS = 16
"""Largest number of FMUs whose experiments are kept in this process [1]."""
_cached_experiments: dict[tuple[str, str], tuple[ReferenceExperiment, ...]] = {}
"""{(FMU, text of its parameter file): its experiments}; the newest entry is last."""


def make_proof_files(model: Model, parameters: ParameterFile, is_native: bool = True) -> dict[str, bytes]:
    """Make the verification files of an FMU, {path: content}; the package computes the reference results.

    is_native : whether the FMU is native; False: python flavour, without page and model exchange
    """
    source = model, parameters
    return make_reference_files(
        *source,
        list_shipped_variants(*source),
        get_experiments(*source),
        make_uncertainty_study(*source),
        is_native,
    )


def get_experiments(model: Model, parameters: ParameterFile) -> tuple[ReferenceExperiment, ...]:
    """Experiments of an FMU, computed once for all flavours."""
    key = model.name, format_parameter_file(parameters)
    if key not in _cached_experiments:
        _cached_experiments[key] = tuple(compute_experiments(model, parameters))
        for old_key in [*_cached_experiments][:-_MAX_CACHED_RESULTS]:
            del _cached_experiments[old_key]
    return _cached_experiments[key]
