"""`jointfmu uncertainty`: uncertainty bands of a joint; `jointfmu sweep`: FMU runs for sampled parameters."""

import argparse
from dataclasses import replace
from pathlib import Path

from jointfmu.files.outputs import FOLDER, PICTURE
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file
from jointfmu.quantity import build_parameter_set

from ...common import columns
from ...common.pressure import judge_file
from ..command import CommandResult, Parser, SubParsers, declare_argument, declare_command, declare_settings
from ..outputs import declare_output

DISTRIBUTIONS_HELP = (
    "distributions: LOW..HIGH (uniform), VALUE+-PERCENT%, loguniform(LOW, HIGH), "
    "normal(MEAN, SD), lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH); SD and FACTOR also in %; "
    "+-5%, normal(2%), lognormal(20%) are relative to the value in the file; interval: uniform over the "
    "range that the source states; quote the parentheses for your shell"
)
"""Help text on the distributions of `--set`."""


def add(commands: SubParsers) -> None:
    """Declare the command `jointfmu uncertainty` with its options."""
    text = "compute uncertainty bands of a joint's curves from uncertain parameters"
    study = declare_command(commands, "uncertainty", _run_uncertainty, text)
    study.epilog = DISTRIBUTIONS_HELP
    declare_argument(
        study, "joint", str, f"one of {', '.join(KINDS)}", "JOINT", nargs="?", choices=list(KINDS)
    )
    declare_argument(study, "--params", Path, "parameter file of the joint (TOML)")
    _declare_sampling(study, "number of samples", 16384)
    declare_argument(study, "--to", float, "last value of the load ramp (SI)")
    declare_argument(study, "--points", int, "number of points of the ramp", default=201)
    declare_output(study, "--csv", columns.TABLE_FILE_KIND, "write the bands to a file")
    declare_output(study, "--plot", PICTURE, "draw bands and sensitivity indices (.png, .svg)")


def _declare_sampling(parser: Parser, samples_help: str, default_samples: int) -> None:
    """Declare the options for distributions, number of samples and seed."""
    declare_argument(parser, "--study", Path, "study file with the distributions (TOML)")
    declare_settings(parser)
    declare_argument(
        parser, "--samples", int, f"{samples_help}, rounded up to a power of two", default=default_samples
    )
    declare_argument(parser, "--seed", int, "seed of the Sobol' sequence", default=0)


def load_stated_file(joint: str | None, params: Path | None) -> ParameterFile:
    """Load the parameter file of `--params`, or the default of JOINT; ValueError if both are missing."""
    if params is None and joint is None:
        raise ValueError(f"JOINT or --params FILE is missing; JOINT is one of {', '.join(KINDS)}")
    return load_parameter_file(params, joint) if params else load_default(str(joint))


def _run_uncertainty(args: argparse.Namespace) -> CommandResult:
    from ...studies.uncertainty import problem, propagate, report, study
    from ...studies.uncertainty.propagate import compute_sensitivity

    file = load_stated_file(args.joint, args.params)
    count = study.round_up_to_power_of_two(args.samples)
    study.check_seed(args.seed)
    distributions = study.merge_settings(args.study, args.settings)
    task = problem.state_problem(file, distributions, args.to, args.points)
    A, B = propagate.sample_designs(task, count, args.seed)
    bands = propagate.compute_bands(task, A)
    rows = min(count, max(1024, count // 32))
    indices = (
        compute_sensitivity(task, A[:rows], B[:rows])
        if len(task.uncertain_parameters) > 1 and bands.has_scatter
        else None
    )
    if args.csv:
        write_text(args.csv, report.format_bands_csv(task, bands))
    if args.plot:
        report.draw_bands_and_indices(
            args.plot, bands, indices, f"{task.curves.load.name} [{task.curves.load.unit}]"
        )
    judgement = judge_file(
        replace(file, values=build_parameter_set(task.parameter_class, task.values)), report.table_loads(task)
    )
    lines = [report.format_table(task, bands, indices)]
    return CommandResult(document=report.as_json(task, bands, indices), lines=lines, judgement=judgement)


def add_sweep(commands: SubParsers) -> None:
    """Declare the command `jointfmu sweep` with its options."""
    many = declare_command(
        commands, "sweep", _run_sweep, "run an FMU along a load ramp for many samples of its parameters"
    )
    many.epilog = DISTRIBUTIONS_HELP
    declare_argument(many, "fmu", Path, "path of the FMU", "FMU")
    _declare_sampling(many, "number of runs", 256)
    declare_argument(many, "--input", str, "input to vary", required=True)
    declare_argument(many, "--to", float, "last value of the ramp (SI)", required=True)
    declare_argument(many, "--step", float, "step of the ramp (SI)", required=True)
    declare_output(many, "--out", FOLDER, "folder for the results", allow_force=False, required=True)
    workers = many.add_mutually_exclusive_group()
    declare_argument(workers, "--scheduler", str, "dask scheduler of a cluster, tls://HOST:PORT", "ADDRESS")
    declare_argument(workers, "--workers", int, "number of local processes (default: one per core)")


def _run_sweep(args: argparse.Namespace) -> CommandResult:
    from ...studies.uncertainty import journal, study
    from ...studies.uncertainty.sweep import plan_runs, sweep
    from ...studies.uncertainty.worker import LoadRamp

    if args.workers is not None and args.workers < 1:
        raise ValueError(f"workers = {args.workers} is outside [1, inf)")
    count = study.round_up_to_power_of_two(args.samples)
    study.check_seed(args.seed)
    drive = LoadRamp(args.input, args.to, args.step)
    distributions = study.merge_settings(args.study, args.settings)
    record, runs = plan_runs(args.fmu, drive, distributions, count, args.seed)
    try:
        with journal.claimed_folder(args.out, record):
            done = sweep(args.fmu, drive, runs, args.out, args.scheduler, args.workers)
    except KeyboardInterrupt:
        text = f"finished runs are kept in {args.out}, the same command resumes"
        raise KeyboardInterrupt(text) from None
    failure = done.first_failure
    example = failure and {key: failure[key] for key in ("run", "parameters", "error")}
    counts = {"runs": done.run_count, "now": done.new_runs, "failed": done.failed_count}
    before = done.run_count - done.new_runs
    lines = [
        f"{done.run_count} runs in {args.out}: {done.new_runs} now, {before} before, "
        f"{done.failed_count} failed"
    ]
    if failure:
        values = ", ".join(f"{k} = {v}" for k, v in failure["parameters"].items())
        lines.append(f"the first failed, run {failure['run']}: {values}: {failure['error']}")
    return CommandResult(
        document={"out": str(args.out), **counts, "first_failure": example},
        lines=lines,
        exit_status=int(done.failed_count == done.run_count),
    )
