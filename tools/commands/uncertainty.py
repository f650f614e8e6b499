"""`jointfmu uncertainty`: uncertainty bands of a joint; `jointfmu sweep`: FMU runs for sampled parameters."""

import argparse
from dataclasses import replace
from pathlib import Path

from jointfmu.files.outputs import FOLDER, PICTURE
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, default, load
from jointfmu.quantity import build

from .. import columns
from ..command_line.common import Answer, Commands, Parser, argument, command, settings
from ..command_line.outputs import output
from ..pressure import judge_file

SYNTAX = (
    "distributions: LOW..HIGH (uniform), VALUE+-PERCENT%, loguniform(LOW, HIGH), "
    "normal(MEAN, SD), lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH); SD and FACTOR also in %; "
    "+-5%, normal(2%), lognormal(20%) are relative to the value in the file; interval: uniform over the "
    "range that the source states; quote the parentheses for your shell"
)
"""Help text on the distributions of `--set`."""


def add(commands: Commands) -> None:
    """Declare the command `jointfmu uncertainty` with its options."""
    text = "compute uncertainty bands of a joint's curves from uncertain parameters"
    study = command(commands, "uncertainty", _uncertainty, text)
    study.epilog = SYNTAX
    argument(study, "joint", str, f"one of {', '.join(KINDS)}", "JOINT", nargs="?", choices=list(KINDS))
    argument(study, "--params", Path, "parameter file of the joint (TOML)")
    _drawn(study, "number of samples", 16384)
    argument(study, "--to", float, "last value of the load ramp (SI)")
    argument(study, "--points", int, "number of points of the ramp", default=201)
    output(study, "--csv", columns.TABLE, "write the bands to a file")
    output(study, "--plot", PICTURE, "draw bands and sensitivity indices (.png, .svg)")


def _drawn(sub: Parser, what: str, samples: int) -> None:
    """Declare the options for distributions, number of samples and seed."""
    argument(sub, "--study", Path, "study file with the distributions (TOML)")
    settings(sub)
    argument(sub, "--samples", int, f"{what}, rounded up to a power of two", default=samples)
    argument(sub, "--seed", int, "seed of the Sobol' sequence", default=0)


def chosen(joint: str | None, params: Path | None) -> ParameterFile:
    """Load the parameter file of `--params`, or the default of JOINT; ValueError if both are missing."""
    if params is None and joint is None:
        raise ValueError(f"JOINT or --params FILE is missing; JOINT is one of {', '.join(KINDS)}")
    return load(params, joint) if params else default(str(joint))


def _uncertainty(args: argparse.Namespace) -> Answer:
    from ..uncertainty import problem, propagate, report, study
    from ..uncertainty.propagate import sensitivity

    file = chosen(args.joint, args.params)
    count = study.power_of_two(args.samples)
    study.check_seed(args.seed)
    distributions = study.settings(args.study, args.settings)
    task = problem.pose(file, distributions, args.to, args.points)
    A, B = propagate.design(task, count, args.seed)
    bands = propagate.bands(task, A)
    rows = min(count, max(1024, count // 32))
    indices = sensitivity(task, A[:rows], B[:rows]) if len(task.uncertain) > 1 and bands.moved else None
    if args.csv:
        write_text(args.csv, report.bands_csv(task, bands))
    if args.plot:
        report.draw(args.plot, bands, indices, f"{task.reduced.load.name} [{task.reduced.load.unit}]")
    judgement = judge_file(replace(file, values=build(task.parameters, task.values)), report.loads(task))
    lines = [report.table(task, bands, indices)]
    return Answer(document=report.as_json(task, bands, indices), lines=lines, judgement=judgement)


def add_sweep(commands: Commands) -> None:
    """Declare the command `jointfmu sweep` with its options."""
    many = command(
        commands, "sweep", _sweep, "run an FMU along a load ramp for many samples of its parameters"
    )
    many.epilog = SYNTAX
    argument(many, "fmu", Path, "path of the FMU", "FMU")
    _drawn(many, "number of runs", 256)
    argument(many, "--input", str, "input to vary", required=True)
    argument(many, "--to", float, "last value of the ramp (SI)", required=True)
    argument(many, "--step", float, "step of the ramp (SI)", required=True)
    output(many, "--out", FOLDER, "folder for the results", forcible=False, required=True)
    workers = many.add_mutually_exclusive_group()
    argument(workers, "--scheduler", str, "dask scheduler of a cluster, tls://HOST:PORT", "ADDRESS")
    argument(workers, "--workers", int, "number of local processes (default: one per core)")


def _sweep(args: argparse.Namespace) -> Answer:
    from ..uncertainty import journal, study
    from ..uncertainty.sweep import plan, sweep
    from ..uncertainty.worker import LoadRamp

    if args.workers is not None and args.workers < 1:
        raise ValueError(f"workers = {args.workers} is outside [1, inf)")
    count = study.power_of_two(args.samples)
    study.check_seed(args.seed)
    drive = LoadRamp(args.input, args.to, args.step)
    distributions = study.settings(args.study, args.settings)
    record, runs = plan(args.fmu, drive, distributions, count, args.seed)
    try:
        with journal.claimed(args.out, record):
            done = sweep(args.fmu, drive, runs, args.out, args.scheduler, args.workers)
    except KeyboardInterrupt:
        text = f"finished runs are kept in {args.out}, the same command resumes"
        raise KeyboardInterrupt(text) from None
    failure = done.first_failure
    example = failure and {key: failure[key] for key in ("run", "parameters", "error")}
    counts = {"runs": done.runs, "now": done.now, "failed": done.failed}
    before = done.runs - done.now
    lines = [f"{done.runs} runs in {args.out}: {done.now} now, {before} before, {done.failed} failed"]
    if failure:
        values = ", ".join(f"{k} = {v}" for k, v in failure["parameters"].items())
        lines.append(f"the first failed, run {failure['run']}: {values}: {failure['error']}")
    return Answer(
        document={"out": str(args.out), **counts, "first_failure": example},
        lines=lines,
        status=int(done.failed == done.runs),
    )
