"""`jointfmu sweep`: a study over an FMU, in parallel, to be interrupted and resumed at any time."""

import argparse
import json
import sys
from pathlib import Path

from ..command_line.common import Commands, command, settings
from .uncertainty import SYNTAX


def add(commands: Commands) -> None:
    """Declare the command."""
    many = command(
        commands, "sweep", _sweep, "run an FMU along a load ramp for many samples of its parameters"
    )
    many.epilog = SYNTAX
    many.add_argument("fmu", type=Path, metavar="FMU", help="path of the FMU")
    many.add_argument("--study", type=Path, metavar="FILE", help="study file with the distributions (TOML)")
    settings(many)
    many.add_argument("--input", required=True, metavar="NAME", help="input to drive")
    many.add_argument("--to", type=float, required=True, metavar="VALUE", help="end of the ramp (SI)")
    many.add_argument("--step", type=float, required=True, metavar="VALUE", help="step of the ramp (SI)")
    many.add_argument(
        "--samples",
        type=int,
        default=256,
        metavar="N",
        help="runs, rounded up to a power of two (default: 256)",
    )
    many.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the Sobol' sequence")
    many.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the results")
    where = many.add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="ADDRESS", help="dask scheduler of a cluster, tcp://HOST:PORT")
    where.add_argument("--workers", type=int, metavar="N", help="local processes (default: one per core)")


def _sweep(args: argparse.Namespace) -> int:
    from ..uncertainty import journal, study
    from ..uncertainty.cluster import leave
    from ..uncertainty.sweep import plan, sweep
    from ..uncertainty.worker import LoadRamp

    if args.workers is not None and args.workers < 1:
        raise ValueError(f"workers = {args.workers} is outside [1, inf)")
    count = study.power_of_two(args.samples)
    study.check_seed(args.seed)
    drive = LoadRamp(args.input, args.to, args.step)
    given = study.settings(args.study, args.settings)
    record, runs = plan(args.fmu, drive, given, count, args.seed)
    try:
        with journal.claimed(args.out, record):
            done = sweep(args.fmu, drive, runs, args.out, args.scheduler, args.workers)
    except KeyboardInterrupt:
        print(
            f"jointfmu sweep: interrupted; finished runs are kept in {args.out}, the same command resumes",
            file=sys.stderr,
        )
        leave(130)
    failure = done.first_failure
    if args.json:
        example = failure and {key: failure[key] for key in ("run", "parameters", "error")}
        counts = {"runs": done.runs, "now": done.now, "failed": done.failed}
        print(json.dumps({"out": str(args.out), **counts, "first_failure": example}))
    else:
        before = done.runs - done.now
        print(f"{done.runs} runs in {args.out}: {done.now} now, {before} before, {done.failed} failed")
        if failure:
            values = ", ".join(f"{k} = {v}" for k, v in failure["parameters"].items())
            print(f"the first failed, run {failure['run']}: {values}: {failure['error']}")
    return int(done.failed == done.runs)
