"""`jointfmu surface synthesize`: make a random Weierstrass-Mandelbrot surface from a seed."""

import argparse

from jointfmu.files.writing import write_text

from ....inputs.surfaces import csvfile, synthesis
from ....inputs.surfaces.heights import ArealMap, Heights
from ...command import CommandResult, SubParsers, declare_argument, declare_command
from ...outputs import declare_output

MAX_MEMORY = 2e9
"""Largest memory [B] for the heights of a surface and the text of its file."""
MEMORY_PER_MAP_POINT, MEMORY_PER_PROFILE_POINT = 64.0, 190.0
"""Memory [B] for one point of a map and of a profile, with its text (measured at a million points)."""
MAX_WAVE_DIRECTIONS = 1000
"""Largest number of superposed directions of the waves of an isotropic surface [1]."""
SURFACE_TYPES = ("isotropic", "textured", "profile")
"""Types of synthetic surfaces: the names of the option `--type`."""


def add_command(subcommands: SubParsers, subcommand_name: str) -> None:
    """Declare the command `jointfmu surface synthesize` with its options."""
    make = declare_command(
        subcommands, subcommand_name, _run_synthesize, "make a random Weierstrass-Mandelbrot surface"
    )
    text = "kind of surface (default: isotropic, Hu 2023, Eq. 1)"
    make.add_argument("--shape", choices=SURFACE_TYPES, default=SURFACE_TYPES[0], help=text)
    declare_argument(make, "--size", float, "side length [m]", "SIZE", required=True)
    declare_argument(make, "--points", int, "number of points along a side", "POINTS", required=True)
    text = "fractal dimension; isotropic: D_s (2 to 3); textured: D along x and y; profile: D (1 to 2)"
    declare_argument(make, "--D", float, text, "D", nargs="+", required=True)
    declare_argument(
        make, "--G", float, "fractal roughness [m], one value for each D", "G", nargs="+", required=True
    )
    declare_argument(make, "--gamma", float, "frequency ratio of neighbouring waves", "GAMMA", default=1.5)
    text = "number M of superposed directions of an isotropic surface"
    declare_argument(make, "--ridges", int, text, "RIDGES", default=20)
    declare_argument(make, "--seed", int, "seed of the random phases", "SEED", default=0)
    declare_output(make, "--out", csvfile.SURFACE_FILE_KIND, "file to write (.csv)", required=True)


def _run_synthesize(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu surface synthesize`: write the heights of a random surface."""
    if args.out.suffix.lower() != ".csv":
        raise ValueError(f"{args.out}: suffix {args.out.suffix!r}, allowed is .csv")
    heights = _make_heights(args)
    write_text(args.out, csvfile.csv_text(heights))
    document = {
        "file": str(args.out),
        "shape": args.shape,
        "points": heights.z.size,
        "rms": float(heights.z.std()),
        "D" if args.shape != "isotropic" else "D_s": args.D,
        "G" if args.shape != "isotropic" else "G_s": args.G,
        "gamma": args.gamma,
        "seed": args.seed,
    }
    lines = [f"wrote {args.out}: {format_size(heights)}, rms height {document['rms']:.4g} m"]
    return CommandResult(json_document=document, lines=lines)


def _check_memory(args: argparse.Namespace) -> None:
    """Raise ValueError if the points need more memory than MAX_MEMORY."""
    if args.shape == "profile":
        point_memory, count = MEMORY_PER_PROFILE_POINT, float(args.points)
        max_points = MAX_MEMORY / point_memory
    else:
        point_memory, count = MEMORY_PER_MAP_POINT, float(args.points) ** 2
        max_points = (MAX_MEMORY / point_memory) ** 0.5
    if count * point_memory > MAX_MEMORY:
        raise ValueError(
            f"points = {args.points} take {count * point_memory / 1e9:.3g} GB, allowed are "
            f"{MAX_MEMORY / 1e9:g} GB: at most {int(max_points)} points along a side of shape {args.shape}"
        )


def _make_heights(args: argparse.Namespace) -> Heights:
    """Make the heights [m] of the surface that the options describe."""
    count = 2 if args.shape == "textured" else 1
    for name, values in (("D", args.D), ("G", args.G)):
        if len(values) != count:
            raise ValueError(
                f"--{name} has {len(values)} values, a surface of shape {args.shape} takes {count}"
            )
        if name == "G" and any(not 0.0 < value < float("inf") for value in values):
            raise ValueError(f"G = {min(values):g} m is outside (0, inf): fractal roughness")
    if args.seed < 0:
        raise ValueError(f"seed = {args.seed} is negative, allowed are 0, 1, 2, ...")
    if not 1 <= args.ridges <= MAX_WAVE_DIRECTIONS:
        raise ValueError(f"ridges = {args.ridges}, allowed are 1, 2, 3, ... {MAX_WAVE_DIRECTIONS}")
    _check_memory(args)
    waves = synthesis.Waves(size=args.size, points=args.points, gamma=args.gamma)
    if args.shape == "isotropic":
        return synthesis.synthesize_isotropic(waves, args.D[0], args.G[0], args.ridges, args.seed)
    if args.shape == "textured":
        return synthesis.synthesize_textured(waves, tuple(args.D), tuple(args.G), args.seed)
    return synthesis.synthesize_profile(waves, args.D[0], args.G[0], args.seed)


def format_size(heights: Heights) -> str:
    """Format kind, number of points and side lengths of a surface."""
    points = " x ".join(str(n) for n in heights.z.shape[::-1])
    lengths = " x ".join(f"{1e3 * length:.4g}" for length in heights.lengths)
    return f"{'areal map' if isinstance(heights, ArealMap) else 'profile'}, {points} points, {lengths} mm"
