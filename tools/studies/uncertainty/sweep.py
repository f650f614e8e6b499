"""Uncertainty study of an FMU: a load ramp in the importer for each sample."""

from collections.abc import Mapping
from dataclasses import asdict
from fnmatch import fnmatch
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from jointfmu_fmu_src.proof.standard import REFERENCE_FILE_FOLDER

from jointfmu.files import archives
from jointfmu.files.reading import read_bytes
from jointfmu.joints.model import Variable
from jointfmu.parameters import ParameterFile, load_parameter_file
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from ...common import columns
from ...run.host import unpack_fmu
from ...run.ramps import ramp
from . import journal
from .problem import INTERVAL_SETTING, UncertaintyStudy, resolve_interval_setting
from .propagate import QUANTILES
from .study import split_settings
from .worker import FmuRampEvaluator, LoadRamp


def define_fmu_study(
    fmu_path: Path, load_ramp: LoadRamp, study_settings: Mapping[str, object]
) -> UncertaintyStudy:
    """State the uncertainty study of an FMU: load ramp, and settings with distributions.

    study_settings : {name: value or text of a distribution} of parameters and inputs

    Raises ValueError for a file that is not an FMU, an unknown name, a wrong distribution or ramp.
    """
    loads = ramp.ramp_points(load_ramp.to, load_ramp.step)
    with unpack_fmu(fmu_path) as (_, description):
        variables = {v.name: v for v in description.modelVariables}
    inputs = [v.name for v in variables.values() if v.causality == "input"]
    settable = [v.name for v in variables.values() if v.causality in ("input", "parameter")]
    if load_ramp.input not in inputs:
        raise ValueError(f"{fmu_path}: unknown input {load_ramp.input!r}, allowed are {', '.join(inputs)}")
    for name in study_settings:
        if name not in settable:
            raise ValueError(f"{fmu_path}: unknown name {name!r}, allowed are {', '.join(settable)}")
        if name == load_ramp.input:
            raise ValueError(f"{fmu_path}: {name} is the input of the ramp; do not set it too")
    if INTERVAL_SETTING in study_settings.values():
        file = load_contained_parameter_file(fmu_path)
        study_settings = {
            name: resolve_interval_setting(name, value, file) for name, value in study_settings.items()
        }
    real = [name for name in settable if variables[name].type in ("Real", "Float64")]
    plain, uncertain = split_settings(
        study_settings, {name: float(variables[name].start or 0.0) for name in real}
    )
    if not uncertain:
        raise InputRefusal(
            "no parameter has a distribution; expected NAME=LOW..HIGH or a study file", "settings"
        )
    if wrong := [parameter for parameter in uncertain if parameter.name not in real]:
        raise ValueError(
            f"{fmu_path}: {wrong[0].name} = {wrong[0].distribution_text}: is not a real number and "
            "cannot be uncertain"
        )
    record = {
        "fmu": fmu_path.name,
        "fmu_sha256": journal.sha256_hex(read_bytes(fmu_path, "an FMU")),
        **asdict(load_ramp),
    }
    driven = variables[load_ramp.input]
    load = Variable(driven.name, driven.unit or "1", driven.description or "")
    units = {v.name: v.unit or "1" for v in variables.values() if v.causality == "output"}
    return UncertaintyStudy(
        fmu_path.name, load, loads, units, uncertain, plain, FmuRampEvaluator(fmu_path, load_ramp), record
    )


def load_contained_parameter_file(fmu_path: Path) -> ParameterFile:
    """Load the parameter file that an FMU contains with its experiments.

    Raises ValueError if the FMU contains none.
    """
    with archives.open_archive(fmu_path) as archive, TemporaryDirectory() as folder:
        members = [
            name for name in archive.namelist() if fnmatch(name, f"{REFERENCE_FILE_FOLDER}/parameters/*.toml")
        ]
        if parameter_files := [name for name in members if Path(name).name != "study.toml"]:
            file = Path(folder, Path(parameter_files[0]).name)
            file.write_bytes(archives.read_member(archive, parameter_files[0]))
            return load_parameter_file(file)
    raise ValueError(
        f"{fmu_path}: contains no parameter file; state LOW..HIGH in place of {INTERVAL_SETTING}"
    )


def format_quantiles_csv(study_folder: Path, variable_units: Mapping[str, str]) -> str:
    """CSV text of a study: quantiles of each output at each point of the ramp.

    The quantiles are taken over all runs that did not fail.
    """
    runs: dict[str, list[Array]] = {}
    for entry in journal.read_journal_entries(study_folder):
        for name, values in entry.get("columns", {}).items():
            runs.setdefault(name, []).append(np.asarray(values, dtype=np.float64))
    driven, *outputs = runs
    heads: list[columns.ColumnHead] = [(driven, variable_units[driven])]
    table = [runs[driven][0]]
    for name in outputs:
        heads += [(f"{name} {100 * q:g} %", variable_units[name]) for q in QUANTILES]
        table += list(np.quantile(np.stack(runs[name]), QUANTILES, axis=0))
    return columns.format_table(heads, table)
