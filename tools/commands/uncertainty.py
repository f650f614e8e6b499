"""`jointfmu uncertainty`: from uncertain parameters to bands of stiffness, damping and displacement."""

import argparse
import json
from dataclasses import replace
from pathlib import Path

from jointfmu.files.writing import check_writable, write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, default, load
from jointfmu.quantity import build

from ..command_line.common import Commands, command, settings, tell
from ..pressure import judge_file

SYNTAX = (
    "distributions: LOW..HIGH (any value alike), VALUE+-PERCENT%, loguniform(LOW, HIGH), "
    "normal(MEAN, SD), lognormal(MEDIAN, FACTOR), triangular(LOW, MODE, HIGH); SD and FACTOR also in %; "
    "+-5%, normal(2%), lognormal(20%) lie about the parameter file's value; quote the parentheses"
)


def add(commands: Commands) -> None:
    """Declare the command."""
    study = command(
        commands, "uncertainty", _uncertainty, "bands of a joint's curves from uncertain parameters"
    )
    study.epilog = f"{SYNTAX}; NAME=interval: between the ends that the source in the file states"
    study.add_argument(
        "joint", nargs="?", choices=list(KINDS), metavar="JOINT", help=f"one of {', '.join(KINDS)}"
    )
    study.add_argument("--params", type=Path, metavar="FILE", help="parameter file of the joint (TOML)")
    study.add_argument("--study", type=Path, metavar="FILE", help="study file with the distributions (TOML)")
    settings(study)
    study.add_argument("--to", type=float, metavar="VALUE", help="end of the load ramp (SI)")
    study.add_argument(
        "--points", type=int, default=201, metavar="N", help="points of the ramp (default: 201)"
    )
    study.add_argument(
        "--samples",
        type=int,
        default=16384,
        metavar="N",
        help="samples, rounded up to a power of two (default: 16384)",
    )
    study.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the Sobol' sequence")
    study.add_argument("--csv", type=Path, metavar="FILE", help="write the bands to a file")
    study.add_argument("--plot", type=Path, metavar="FILE", help="draw bands and indices, .png or .svg")


def chosen(joint: str | None, params: Path | None) -> ParameterFile:
    """The parameter file of JOINT or --params, either of which must be given."""
    if params is None and joint is None:
        raise ValueError(f"JOINT or --params FILE is missing; JOINT is one of {', '.join(KINDS)}")
    return load(params, joint) if params else default(str(joint))


def _uncertainty(args: argparse.Namespace) -> int:
    from ..uncertainty import problem, propagate, report, study
    from ..uncertainty.sensitivity import sensitivity

    file = chosen(args.joint, args.params)
    count = study.power_of_two(args.samples)
    study.check_seed(args.seed)
    if args.csv:
        check_writable(args.csv)
    if args.plot:
        from .. import plots

        plots.check(args.plot)
    given = study.settings(args.study, args.settings)
    task = problem.pose(file, given, args.to, args.points)
    A, B = propagate.design(task, count, args.seed)
    bands = propagate.bands(task, A)
    rows = min(count, max(1024, count // 32))
    indices = sensitivity(task, A[:rows], B[:rows]) if len(task.uncertain) > 1 else None
    if args.csv:
        write_text(args.csv, report.bands_csv(task, bands))
    if args.plot:
        from ..uncertainty import figure

        figure.draw(args.plot, bands, indices, f"{task.reduced.load.name} [{task.reduced.load.unit}]")
    found = judge_file(replace(file, values=build(task.parameters, task.values)), report.loads(task))
    if args.json:
        print(json.dumps(report.as_json(task, bands, indices) | found.document()))
    else:
        print(report.table(task, bands, indices))
        tell(found)
    return 0
