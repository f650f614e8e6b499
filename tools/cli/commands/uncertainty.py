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
from ...common.options import format_option_flag
from ...common.pressure import judge_joint_stiffness
from ..command import (
    CommandResult,
    Parser,
    SubParsers,
    declare_argument,
    declare_command,
    declare_settings,
    suggest_word,
)
from ..outputs import declare_output

if TYPE_CHECKING:
    from ...studies.uncertainty.problem import UncertaintyProblem
    from ...studies.uncertainty.runs import Execution, SampledOutputs

DISTRIBUTIONS_HELP = (
    "distributions: LOW..HIGH (uniform), VALUE+-PERCENT%, loguniform(LOW, HIGH), "
    "normal(MEAN, SD), lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH); SD and FACTOR also in %; "
    "+-5%, normal(2%), lognormal(20%) are relative to the value in the file; interval: uniform over the "
    "range that the source states; quote the parentheses for your shell"
)
"""Help text on the distributions of `--set`."""


DEFAULT_JOINT_SAMPLE_COUNT, DEFAULT_FMU_SAMPLE_COUNT, DEFAULT_RAMP_POINT_COUNT = 16384, 256, 201
"""Default number of samples of a joint and of an FMU, and of points of a joint's ramp."""
SWEEP_DEPRECATION_NOTE = (
    "jointfmu sweep: deprecated, and removed in the next major version; use jointfmu uncertainty FMU"
)
"""Warning that the command `sweep` prints."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu uncertainty` with its options."""
    text = "compute uncertainty bands of a joint or an FMU from uncertain parameters"
    study = declare_command(command_parsers, "uncertainty", _run_uncertainty, text)
    study.epilog = DISTRIBUTIONS_HELP
    joints = f"one of {', '.join(KINDS)}, or the path of an FMU"
    declare_argument(study, "subject", str, joints, "JOINT|FMU", nargs="?")
    declare_argument(study, "--params", Path, "parameter file of the joint (TOML)")
    _declare_sampling(study, f"default: {DEFAULT_JOINT_SAMPLE_COUNT}; of an FMU: {DEFAULT_FMU_SAMPLE_COUNT}")
    declare_argument(study, "--to", float, "last value of the load ramp (SI)")
    declare_argument(
        study, "--points", int, f"number of points of a joint's ramp (default: {DEFAULT_RAMP_POINT_COUNT})"
    )
    declare_argument(study, "--input", str, "input of the FMU to vary")
    declare_argument(study, "--step", float, "step of the ramp of an FMU (SI)")
    declare_output(study, "--csv", columns.TABLE_FILE_KIND, "write the bands to a file")
    declare_output(study, "--plot", PICTURE_FILE, "draw bands and sensitivity indices (.png, .svg)")
    _declare_execution(study, "folder that keeps all runs; the same command resumes")


def _declare_sampling(parser: Parser, defaults: str) -> None:
    """Declare the options for distributions, number of samples and seed."""
    declare_argument(parser, "--study", Path, "study file with the distributions (TOML)")
    declare_settings(parser)
    declare_argument(
        parser, "--samples", int, f"number of samples, rounded up to a power of two ({defaults})"
    )
    declare_argument(parser, "--seed", int, "seed of the Sobol' sequence", default=0)


def _declare_execution(parser: Parser, folder_help: str, **options: Any) -> None:
    """Declare the options for the folder that stores the runs, and for the processes that execute them."""
    declare_output(parser, "--out", OUTPUT_FOLDER, folder_help, allow_overwrite=False, **options)
    workers = parser.add_mutually_exclusive_group()
    declare_argument(workers, "--scheduler", str, "dask scheduler of a cluster, tls://HOST:PORT", "ADDRESS")
    declare_argument(workers, "--workers", int, "largest number of local processes (default: one per core)")


def load_parameter_file_option(joint_name: str | None, params: Path | None) -> ParameterFile:
    """Load the parameter file of `--params`, or the default of JOINT; ValueError if both are missing."""
    if params is None and joint_name is None:
        raise ValueError(f"JOINT or --params FILE is missing; JOINT is one of {', '.join(KINDS)}")
    return load_parameter_file(params, joint_name) if params else load_default(str(joint_name))


def _is_fmu(joint_or_fmu: str | None) -> bool:
    """Whether the positional argument is the path of an FMU; ValueError if it is neither FMU nor joint."""
    if joint_or_fmu is None or joint_or_fmu in KINDS:
        return False
    if joint_or_fmu.lower().endswith(".toml"):
        raise ValueError(f"{joint_or_fmu}: is no FMU; state a parameter file with --params {joint_or_fmu}")
    if joint_or_fmu.lower().endswith(".fmu") or Path(joint_or_fmu).exists():
        return True
    allowed = f"{', '.join(KINDS)}, or the path of an FMU"
    raise ValueError(
        f"unknown joint {joint_or_fmu!r}, allowed are {allowed}{suggest_word(joint_or_fmu, KINDS)}"
    )


def _check_options(args: argparse.Namespace, is_fmu: bool) -> None:
    """Raise ValueError if an option is missing, or does not apply to the subject of the study.

    is_fmu : True: the subject is an FMU. False: it is a joint
    """
    subject = "an FMU" if is_fmu else "a joint"
    for name in ("params", "points") if is_fmu else ("input", "step"):
        if getattr(args, name) is not None:
            raise ValueError(f"{format_option_flag(name)} does not apply to {subject}; leave it out")
    if missing := [name for name in ("input", "to", "step") if is_fmu and getattr(args, name) is None]:
        raise ValueError(f"{format_option_flag(missing[0])} is missing, needed for {subject}")


def _sample_count(args: argparse.Namespace, default: int) -> int:
    """Number of samples of a study, a power of two. Raises ValueError for a wrong number or seed."""
    from ...studies.uncertainty import study

    study.check_seed(args.seed)
    return study.round_up_to_power_of_two(default if args.samples is None else args.samples)


def _make_execution(args: argparse.Namespace) -> "Execution":
    """Make the execution of the runs of a study, from the options: local processes, or a dask cluster."""
    from ...studies.uncertainty.runs import Execution

    if args.workers is not None and args.workers < 1:
        raise ValueError(f"workers = {args.workers} is outside [1, inf)")
    return Execution(args.out, args.scheduler, args.workers)


@contextmanager
def _open_study_folder(
    uncertainty_problem: "UncertaintyProblem", sample_count: int, seed: int, out: Path | None
) -> Iterator[None]:
    """Context that reserves the folder `out` for the runs of this study; None: nothing is stored."""
    from ...studies.uncertainty import journal

    if out is None:
        yield
        return
    try:
        with journal.open_claimed_folder(out, uncertainty_problem.study_record(sample_count, seed)):
            yield
    except KeyboardInterrupt:
        text = f"finished runs are kept in {out}, the same command resumes"
        raise KeyboardInterrupt(text) from None


def _state_study_of_fmu(args: argparse.Namespace, fmu: Path) -> "UncertaintyProblem":
    """Define the uncertainty study of an FMU from the options: distributions, outputs, loads."""
    from ...studies.uncertainty import study
    from ...studies.uncertainty.sweep import state_fmu_problem
    from ...studies.uncertainty.worker import LoadRamp

    ramp = LoadRamp(args.input, args.to, args.step)
    return state_fmu_problem(fmu, ramp, study.merge_settings(args.study, args.settings))


def _run_uncertainty(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu uncertainty`: propagate uncertain parameters through a joint or an FMU."""
    from ...studies.uncertainty import journal, problem, propagate, report, study
    from ...studies.uncertainty.sweep import format_runs_csv
    from ...studies.uncertainty.worker import JointRamp

    is_fmu = _is_fmu(args.subject)
    _check_options(args, is_fmu)
    execution = _make_execution(args)
    count = _sample_count(args, DEFAULT_FMU_SAMPLE_COUNT if is_fmu else DEFAULT_JOINT_SAMPLE_COUNT)
    judgement = None
    if is_fmu:
        task = _state_study_of_fmu(args, Path(args.subject))
        A = study.unit_cube_points(count, len(task.uncertain_parameters), args.seed)
    else:
        file = load_parameter_file_option(args.subject, args.params)
        points = DEFAULT_RAMP_POINT_COUNT if args.points is None else args.points
        distributions = study.merge_settings(args.study, args.settings)
        task = problem.state_problem(file, distributions, args.to, points)
        A, B = propagate.sample_designs(task, count, args.seed)
        assert isinstance(task.evaluator, JointRamp)
        judgement = judge_joint_stiffness(task.evaluator.file, report.select_table_loads(task))
    indices = None
    with _open_study_folder(task, count, args.seed, args.out):
        bands = propagate.compute_bands(task, A, execution)
        if not is_fmu and len(task.uncertain_parameters) > 1 and bands.has_scatter:
            rows = min(count, max(1024, count // 32))
            indices = propagate.compute_sensitivity(task, bands, A[:rows], B[:rows], execution)
    if args.out:
        text = (
            format_runs_csv(args.out, task.variable_units) if is_fmu else report.format_bands_csv(task, bands)
        )
        write_text(args.out / journal.BANDS_FILE, text)
    if args.csv:
        write_text(args.csv, report.format_bands_csv(task, bands))
    if args.plot:
        report.draw_bands_and_indices(
            args.plot, bands, indices, f"{task.ramped_input.name} [{task.ramped_input.unit}]"
        )
    document, lines = report.study_to_json(task, bands, indices), [report.format_table(task, bands, indices)]
    if args.out:
        counts, line = _count_runs(bands.sampled_outputs, args.out)
        document |= counts
        lines.append(line)
    return CommandResult(json_document=document, lines=lines, stiffness_judgement=judgement)


def _count_runs(samples: "SampledOutputs", out: Path) -> tuple[dict[str, object], str]:
    """Numbers of runs in the folder of a study: as JSON object, and as a line of text."""
    count, failed = samples.accepted.size, len(samples.errors)
    new = samples.new_run_count
    line = f"{count} runs in {out}: {new} now, {count - new} before, {failed} failed"
    return {"out": str(out), "runs": count, "now": new, "failed": failed}, line


def add_sweep_command(command_parsers: SubParsers) -> None:
    """Declare the deprecated command `jointfmu sweep` with its options."""
    text = "deprecated name of jointfmu uncertainty FMU --out FOLDER"
    many = declare_command(command_parsers, "sweep", _run_sweep, text)
    many.epilog = DISTRIBUTIONS_HELP
    declare_argument(many, "fmu", Path, "path of the FMU", "FMU")
    _declare_sampling(many, f"default: {DEFAULT_FMU_SAMPLE_COUNT}")
    declare_argument(many, "--input", str, "input to vary", required=True)
    declare_argument(many, "--to", float, "last value of the ramp (SI)", required=True)
    declare_argument(many, "--step", float, "step of the ramp (SI)", required=True)
    _declare_execution(many, "folder for the results", required=True)


def _run_sweep(args: argparse.Namespace) -> CommandResult:
    """Do the runs of an FMU for the deprecated command `sweep`; print how many are done and failed.

    The runs are those of `_run_uncertainty`.
    """
    from ...studies.uncertainty import journal, study
    from ...studies.uncertainty.runs import evaluate_runs
    from ...studies.uncertainty.sweep import format_runs_csv

    execution = _make_execution(args)
    count = _sample_count(args, DEFAULT_FMU_SAMPLE_COUNT)
    task = _state_study_of_fmu(args, args.fmu)
    runs = task.list_runs(study.unit_cube_points(count, len(task.uncertain_parameters), args.seed))
    with _open_study_folder(task, count, args.seed, args.out):
        samples = evaluate_runs(task.evaluator, runs, task.units, task.loads.size, execution)
    if len(samples.errors) < count:
        write_text(args.out / journal.BANDS_FILE, format_runs_csv(args.out, task.variable_units))
    print(SWEEP_DEPRECATION_NOTE, file=sys.stderr)
    document, line = _count_runs(samples, args.out)
    lines, failure = [line], None
    if samples.errors:
        first, error = next(iter(samples.errors.items()))
        failure = {"run": first, "parameters": runs[first], "error": error}
        values = ", ".join(f"{k} = {v}" for k, v in runs[first].items())
        lines.append(f"the first failed, run {first}: {values}: {error}")
    return CommandResult(
        json_document={**document, "first_failure": failure},
        lines=lines,
        exit_status=int(len(samples.errors) == count),
    )
