"""`jointfmu uncertainty`: bands of a joint or an FMU; `jointfmu sweep`: deprecated name for an FMU."""

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import OUTPUT_FOLDER, PICTURE_FILE
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file

from ...common import columns
from ...common.names import suggest_names
from ...common.options import format_option_flag
from ...common.pressure import find_nominal_pressure_model, judge_joint_stiffness
from ..command import (
    CommandResult,
    Parser,
    SubParsers,
    declare_argument,
    declare_command,
    declare_set_option,
)
from ..outputs import declare_output

if TYPE_CHECKING:
    from ...studies.uncertainty.problem import UncertaintyStudy
    from ...studies.uncertainty.propagate import UncertaintyBands
    from ...studies.uncertainty.runs import SampledOutputs, StudyExecution

DISTRIBUTIONS_HELP = (
    "distributions: LOW..HIGH (uniform), VALUE+-PERCENT% (uniform), loguniform(LOW, HIGH), normal(MEAN, "
    "SD), lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH); SD and FACTOR also in %; +-5%, "
    "normal(2%), lognormal(20%) are relative to the value in the file; interval: uniform over the range in "
    "the parameter file; put words with parentheses in quotation marks, as in 'mu=normal(0.2, 0.02)'"
)
"""Help text on the distributions of `--set`."""


DEFAULT_JOINT_SAMPLE_COUNT, DEFAULT_FMU_SAMPLE_COUNT, DEFAULT_RAMP_POINT_COUNT = 16384, 256, 201
"""Default number of samples of a joint and of an FMU, and of points of a joint's ramp."""
MAX_REFUSED_SHARE = 0.01
"""Share of refused samples [1] above which the command warns: that of the outermost quantile of the bands."""
SWEEP_DEPRECATION_NOTE = (
    "jointfmu sweep: deprecated, and removed in the next major version; use jointfmu uncertainty FMU"
)
"""Warning that the command `sweep` prints."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu uncertainty` with its options."""
    text = "compute uncertainty bands of a joint or an FMU from uncertain parameters"
    study = declare_command(command_parsers, "uncertainty", _run_uncertainty, text)
    study.epilog = DISTRIBUTIONS_HELP
    joints = f"joint ({', '.join(KINDS)}), parameter file (.toml) or FMU; without it, the joint of --params"
    declare_argument(study, "subject", str, joints, "JOINT|FILE", nargs="?")
    declare_argument(
        study, "--params", Path, "parameter file of the joint, in place of its default parameters (TOML)"
    )
    _declare_sampling_options(
        study, f"default: {DEFAULT_JOINT_SAMPLE_COUNT}; for an FMU: {DEFAULT_FMU_SAMPLE_COUNT}"
    )
    text = (
        "last load of the ramp (SI unit, as in 30e3 for 30 kN), needed for an FMU (default for a joint: the "
        "load of --params, else a typical load)"
    )
    declare_argument(study, "--to", float, text)
    declare_argument(
        study,
        "--points",
        int,
        f"joint: number of points of the load ramp (default: {DEFAULT_RAMP_POINT_COUNT})",
    )
    declare_argument(study, "--input", str, "FMU: input to vary along the ramp")
    declare_argument(study, "--step", float, "FMU: step of the ramp (SI unit)")
    declare_output(study, "--csv", columns.TABLE_FILE_KIND, "write the bands over the load (.csv)")
    declare_output(study, "--plot", PICTURE_FILE, "draw bands and sensitivity indices (.png, .svg)")
    _declare_run_options(
        study, "new or empty folder that keeps all runs; after a stop, the same command continues there"
    )


def _declare_sampling_options(parser: Parser, default_sample_count_help: str) -> None:
    """Declare the options for distributions, number of samples and seed."""
    declare_argument(
        parser, "--study", Path, "file with distributions and fixed values (TOML); --set takes precedence"
    )
    declare_set_option(parser, "distribution of a parameter, or a fixed value (SI units), as in mu=0.1..0.3")
    declare_argument(
        parser,
        "--samples",
        int,
        f"number of samples, rounded up to a power of two ({default_sample_count_help})",
    )
    declare_argument(
        parser,
        "--seed",
        int,
        "seed of the random samples (Sobol' sequence): the same seed gives the same numbers",
        default=0,
    )


def _declare_run_options(parser: Parser, folder_help: str, **options: Any) -> None:
    """Declare the options for the folder that stores the runs, and for the processes that execute them."""
    declare_output(parser, "--out", OUTPUT_FOLDER, folder_help, allow_overwrite=False, **options)
    workers = parser.add_mutually_exclusive_group()
    declare_argument(
        workers,
        "--scheduler",
        str,
        "run on a dask cluster: address of its scheduler, tls://HOST:PORT",
        "ADDRESS",
    )
    declare_argument(workers, "--workers", int, "largest number of local processes (default: one per core)")


def load_parameter_file_option(joint_name: str | None, parameter_path: Path | None) -> ParameterFile:
    """Load the parameter file of `--params`, or the default of JOINT; ValueError if both are missing."""
    if parameter_path is None and joint_name is None:
        raise ValueError(f"JOINT or --params FILE is missing; JOINT is one of {', '.join(KINDS)}")
    return (
        load_parameter_file(parameter_path, joint_name) if parameter_path else load_default(str(joint_name))
    )


def _is_fmu(joint_or_fmu: str | None) -> bool:
    """Whether the positional argument is the path of an FMU; ValueError if it is neither FMU nor joint."""
    if joint_or_fmu is None or joint_or_fmu in KINDS:
        return False
    if joint_or_fmu.lower().endswith(".toml"):
        raise ValueError(f"{joint_or_fmu}: a parameter file is stated twice; leave out --params")
    if joint_or_fmu.lower().endswith(".fmu") or Path(joint_or_fmu).exists():
        return True
    allowed = f"{', '.join(KINDS)}, or the path of an FMU"
    raise ValueError(
        f"unknown joint {joint_or_fmu!r}, allowed are {allowed}{suggest_names(joint_or_fmu, KINDS)}"
    )


def _check_options(args: argparse.Namespace, is_fmu_study: bool) -> None:
    """Raise ValueError if an option is missing, or does not apply to the subject of the study.

    is_fmu_study : True: the subject is an FMU. False: it is a joint
    """
    subject = "an FMU" if is_fmu_study else "a joint"
    for name in ("params", "points") if is_fmu_study else ("input", "step"):
        if getattr(args, name) is not None:
            raise ValueError(f"{format_option_flag(name)} does not apply to {subject}; leave it out")
    if missing := [name for name in ("input", "to", "step") if is_fmu_study and getattr(args, name) is None]:
        raise ValueError(f"{format_option_flag(missing[0])} is missing, needed for {subject}")


def _read_sample_count(args: argparse.Namespace, default_sample_count: int) -> int:
    """Number of samples of a study, a power of two. Raises ValueError for a wrong number or seed."""
    from ...studies.uncertainty import study

    study.check_seed(args.seed)
    return study.round_up_to_power_of_two(default_sample_count if args.samples is None else args.samples)


def _create_run_executor(args: argparse.Namespace) -> "StudyExecution":
    """Make the object that executes the runs of a study: in local processes, or on a dask cluster."""
    from ...studies.uncertainty.runs import StudyExecution

    if args.workers is not None and args.workers < 1:
        raise ValueError(f"workers = {args.workers} is outside [1, inf)")
    return StudyExecution(args.out, args.scheduler, args.workers)


@contextmanager
def _open_study_folder(
    uncertainty_study: "UncertaintyStudy", sample_count: int, seed: int, study_folder: Path | None
) -> Iterator[None]:
    """Reserve the folder `study_folder` for the runs of this study (context manager); None: store nothing."""
    from ...studies.uncertainty import journal

    if study_folder is None:
        yield
        return
    try:
        with journal.open_claimed_folder(
            study_folder, uncertainty_study.make_study_record(sample_count, seed)
        ):
            yield
    except KeyboardInterrupt:
        text = f"finished runs are kept in {study_folder}, the same command resumes"
        raise KeyboardInterrupt(text) from None


def _define_fmu_study(args: argparse.Namespace, fmu: Path) -> "UncertaintyStudy":
    """Define the uncertainty study of an FMU from the options: distributions, outputs, loads."""
    from ...studies.uncertainty import study
    from ...studies.uncertainty.sweep import define_fmu_study
    from ...studies.uncertainty.worker import LoadRamp

    ramp = LoadRamp(args.input, args.to, args.step)
    return define_fmu_study(fmu, ramp, study.merge_settings(args.study, args.settings))


def _run_uncertainty(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu uncertainty`: propagate uncertain parameters through a joint or an FMU."""
    import numpy as np

    from ...studies.uncertainty import journal, problem, propagate, report, study
    from ...studies.uncertainty.sweep import format_quantiles_csv
    from ...studies.uncertainty.worker import JointRampEvaluator

    if args.subject and args.subject.lower().endswith(".toml") and args.params is None:
        args.subject, args.params = None, Path(args.subject)
    is_fmu = _is_fmu(args.subject)
    _check_options(args, is_fmu)
    execution = _create_run_executor(args)
    count = _read_sample_count(args, DEFAULT_FMU_SAMPLE_COUNT if is_fmu else DEFAULT_JOINT_SAMPLE_COUNT)
    judgement = None
    if is_fmu:
        task = _define_fmu_study(args, Path(args.subject))
        A = study.draw_unit_cube_points(count, len(task.uncertain_parameters), args.seed)
    else:
        file = load_parameter_file_option(args.subject, args.params)
        points = DEFAULT_RAMP_POINT_COUNT if args.points is None else args.points
        distributions = study.merge_settings(args.study, args.settings)
        task = problem.define_joint_study(file, distributions, args.to, points)
        A, B = propagate.draw_independent_point_sets(task, count, args.seed)
    indices = None
    with _open_study_folder(task, count, args.seed, args.out):
        bands = propagate.compute_bands(task, A, execution)
        if not is_fmu and len(task.uncertain_parameters) > 1 and bands.scattered_outputs:
            rows = min(count, max(1024, count // 32))
            indices = propagate.compute_sensitivity(task, bands, A[:rows], B[:rows], execution)
    if args.out:
        text = (
            format_quantiles_csv(args.out, task.variable_units)
            if is_fmu
            else report.format_bands_csv(task, bands)
        )
        write_text(args.out / journal.BANDS_FILE, text)
    if args.csv:
        write_text(args.csv, report.format_bands_csv(task, bands))
    if args.plot:
        report.draw_bands_and_indices(
            args.plot, bands, indices, f"{task.ramped_input.name} [{task.ramped_input.unit}]"
        )
    if isinstance(task.run_evaluator, JointRampEvaluator):
        file = task.run_evaluator.parameter_file
        nominal = find_nominal_pressure_model(KINDS[file.joint])
        loads = report.select_table_loads(task)
        if nominal and nominal.load_variable != task.ramped_input.name:  # gear mesh: force over the angle
            output = bands.nominal_outputs[nominal.load_variable]
            loads = np.interp(loads, task.loads, output).tolist()
        judgement = judge_joint_stiffness(file, loads).prepend_warnings(_warn_truncation(bands))
    document, lines = (
        report.study_to_json(task, bands, indices),
        [report.format_study_table(task, bands, indices)],
    )
    if args.out:
        counts, line = _count_stored_runs(bands.sampled_outputs, args.out)
        document |= counts
        lines.append(line)
    return CommandResult(json_document=document, output_lines=lines, stiffness_judgement=judgement)


def _warn_truncation(uncertainty_bands: "UncertaintyBands") -> list[str]:
    """Warn if the law refuses so many samples that the quantiles of the bands are of other distributions."""
    count, refused = uncertainty_bands.sample_count, uncertainty_bands.refused_samples.refused_count
    if refused <= MAX_REFUSED_SHARE * count:
        return []
    return [
        f"{refused} of {count} samples ({100.0 * refused / count:.0f} %) are outside the range of the law, "
        "and left out; so the bands are of truncated distributions; state distributions within the range, as "
        "lognormal(20%) for a positive parameter"
    ]


def _count_stored_runs(
    sampled_outputs: "SampledOutputs", study_folder: Path
) -> tuple[dict[str, object], str]:
    """Count the runs stored in the folder of a study; returns a JSON object and a line of text."""
    count, failed = sampled_outputs.accepted_mask.size, len(sampled_outputs.error_messages)
    new = sampled_outputs.new_run_count
    line = f"{count} runs in {study_folder}: {new} now, {count - new} before, {failed} failed"
    return {"out": str(study_folder), "runs": count, "now": new, "failed": failed}, line


def add_sweep_command(command_parsers: SubParsers) -> None:
    """Declare the deprecated command `jointfmu sweep` with its options."""
    text = "deprecated name of jointfmu uncertainty FMU --out FOLDER"
    many = declare_command(command_parsers, "sweep", _run_sweep, text)
    many.epilog = DISTRIBUTIONS_HELP
    declare_argument(many, "fmu", Path, "path of the FMU (.fmu)", "FMU")
    _declare_sampling_options(many, f"default: {DEFAULT_FMU_SAMPLE_COUNT}")
    declare_argument(many, "--input", str, "input to vary along the ramp", required=True)
    declare_argument(many, "--to", float, "last value of the ramp (SI unit)", required=True)
    declare_argument(many, "--step", float, "step of the ramp (SI unit)", required=True)
    _declare_run_options(many, "folder for the results", required=True)


def _run_sweep(args: argparse.Namespace) -> CommandResult:
    """Do the runs of an FMU for the deprecated command `sweep`; print how many are done and failed.

    The runs are those of `_run_uncertainty`.
    """
    from ...studies.uncertainty import journal, study
    from ...studies.uncertainty.runs import evaluate_runs
    from ...studies.uncertainty.sweep import format_quantiles_csv

    execution = _create_run_executor(args)
    count = _read_sample_count(args, DEFAULT_FMU_SAMPLE_COUNT)
    task = _define_fmu_study(args, args.fmu)
    runs = task.list_run_settings(
        study.draw_unit_cube_points(count, len(task.uncertain_parameters), args.seed)
    )
    with _open_study_folder(task, count, args.seed, args.out):
        samples = evaluate_runs(task.run_evaluator, runs, task.output_units, task.loads.size, execution)
    if len(samples.error_messages) < count:
        write_text(args.out / journal.BANDS_FILE, format_quantiles_csv(args.out, task.variable_units))
    print(SWEEP_DEPRECATION_NOTE, file=sys.stderr)
    document, line = _count_stored_runs(samples, args.out)
    lines, failure = [line], None
    if samples.error_messages:
        first, error = next(iter(samples.error_messages.items()))
        failure = {"run": first, "parameters": runs[first], "error": error}
        values = ", ".join(f"{k} = {v}" for k, v in runs[first].items())
        lines.append(f"the first failed, run {first}: {values}: {error}")
    return CommandResult(
        json_document={**document, "first_failure": failure},
        output_lines=lines,
        exit_status=int(len(samples.error_messages) == count),
    )
