"""Verification files inside an FMU, with cached reference results."""

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, format_parameter_file

from .experiments import (
    ReferenceExperiment,
    compute_reference_experiments,
    list_shipped_variants,
    make_uncertainty_study,
)
from .files import make_reference_files

_MAX_FMUS_WITH_CACHED_EXPERIMENTS = 16
"""Largest number of FMUs whose experiments are kept in this process [1]."""
_cached_experiments: dict[tuple[str, str], tuple[ReferenceExperiment, ...]] = {}
"""{(FMU, text of its parameter file): its experiments}; the newest entry is last."""


def make_proof_files(
    fmu_model: Model, parameter_file: ParameterFile, is_native: bool = True
) -> dict[str, bytes]:
    """Make the verification files of an FMU, {path: content}: experiments with results of the package.

    is_native : whether the FMU is native; False: python flavour, without documentation page and model
        exchange
    """
    source = fmu_model, parameter_file
    return make_reference_files(
        *source,
        list_shipped_variants(*source),
        get_reference_experiments(*source),
        make_uncertainty_study(*source),
        is_native,
    )


def get_reference_experiments(
    fmu_model: Model, parameter_file: ParameterFile
) -> tuple[ReferenceExperiment, ...]:
    """Compute the reference experiments of an FMU, or get the cached ones: all flavours have the same."""
    key = fmu_model.name, format_parameter_file(parameter_file)
    if key not in _cached_experiments:
        _cached_experiments[key] = tuple(compute_reference_experiments(fmu_model, parameter_file))
        for old_key in [*_cached_experiments][:-_MAX_FMUS_WITH_CACHED_EXPERIMENTS]:
            del _cached_experiments[old_key]
    return _cached_experiments[key]
