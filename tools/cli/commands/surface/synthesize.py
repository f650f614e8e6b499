"""`jointfmu surface synthesize`: make a random Weierstrass-Mandelbrot surface from a seed."""

import argparse

from jointfmu.files.writing import write_text

from ....inputs.surfaces import csvfile, synthesis
from ....inputs.surfaces.heights import ArealMap, ScanHeights
from ...command import CommandResult, SubParsers, declare_argument, declare_command
from ...outputs import declare_output

MAX_SURFACE_MEMORY = 2e9
"""Largest memory [B] for the heights of a surface and the text of its file."""
MEMORY_PER_MAP_POINT, MEMORY_PER_PROFILE_POINT = 64.0, 190.0
"""Memory [B] for one point of a map and of a profile, with its text (measured at a million points)."""
MAX_WAVE_DIRECTIONS = 1000
"""Largest number of superposed directions of the waves of an isotropic surface [1]."""
SURFACE_TYPES = ("isotropic", "textured", "profile")
"""Types of synthetic surfaces: the names of the option `--type`."""


def add_command(subcommand_parsers: SubParsers, subcommand_name: str) -> None:
    """Declare the command `jointfmu surface synthesize` with its options."""
    make = declare_command(
        subcommand_parsers,
        subcommand_name,
        _run_synthesize,
        "make a random fractal surface (Weierstrass-Mandelbrot)",
    )
    text = "isotropic map (Hu 2023, Eq. 1), map textured along x and y, or profile (default: isotropic)"
    make.add_argument("--shape", choices=SURFACE_TYPES, default=SURFACE_TYPES[0], help=text)
    declare_argument(
        make, "--size", float, "length of the profile, or side of the square map [m]", "SIZE", required=True
    )
    declare_argument(
        make,
        "--points",
        int,
        "number of points along the profile, or along each side of the map",
        "POINTS",
        required=True,
    )
    text = "fractal dimension; isotropic: D_s (2 to 3); textured: D along x and y; profile: D (1 to 2)"
    declare_argument(make, "--D", float, text, "D", nargs="+", required=True)
    declare_argument(
        make,
        "--G",
        float,
        "fractal roughness [m], one value for each value of --D",
        "G",
        nargs="+",
        required=True,
    )
    declare_argument(
        make, "--gamma", float, "frequency ratio of neighbouring waves [1]", "GAMMA", default=1.5
    )
    text = "isotropic: number M of superposed directions of the waves"
    declare_argument(make, "--ridges", int, text, "RIDGES", default=20)
    declare_argument(
        make,
        "--seed",
        int,
        "seed of the random phases: the same seed gives the same surface",
        "SEED",
        default=0,
    )
    declare_output(make, "--out", csvfile.SURFACE_FILE_KIND, "file of heights to write (.csv)", required=True)


def _run_synthesize(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu surface synthesize`: write the heights of a random surface."""
    if args.out.suffix.lower() != ".csv":
        raise ValueError(f"{args.out}: suffix {args.out.suffix!r}, allowed is .csv")
    heights = _synthesize_heights(args)
    write_text(args.out, csvfile.format_scan_csv(heights))
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
    lines = [f"wrote {args.out}: {format_surface_size(heights)}, rms height {document['rms']:.4g} m"]
    return CommandResult(json_document=document, output_lines=lines)


def _check_surface_memory(args: argparse.Namespace) -> None:
    """Raise ValueError if the points need more memory than MAX_SURFACE_MEMORY."""
    if args.shape == "profile":
        point_memory, count = MEMORY_PER_PROFILE_POINT, float(args.points)
        max_points = MAX_SURFACE_MEMORY / point_memory
    else:
        point_memory, count = MEMORY_PER_MAP_POINT, float(args.points) ** 2
        max_points = (MAX_SURFACE_MEMORY / point_memory) ** 0.5
    if count * point_memory > MAX_SURFACE_MEMORY:
        raise ValueError(
            f"points = {args.points} take {count * point_memory / 1e9:.3g} GB, allowed are "
            f"{MAX_SURFACE_MEMORY / 1e9:g} GB: at most {int(max_points)} points along a side of shape "
            f"{args.shape}"
        )


def _synthesize_heights(args: argparse.Namespace) -> ScanHeights:
    """Make the heights [m] of the surface that the options describe."""
    count = 2 if args.shape == "textured" else 1
    for name, values in (("D", args.D), ("G", args.G)):
        if len(values) != count:
            raise ValueError(
                f"--{name} has {len(values)} values, expected {count} for the shape {args.shape}"
            )
        if name == "G" and any(not 0.0 < value < float("inf") for value in values):
            raise ValueError(f"G = {min(values):g} m is outside (0, inf): fractal roughness")
    if args.seed < 0:
        raise ValueError(f"seed = {args.seed} is negative, allowed are 0, 1, 2, ...")
    if not 1 <= args.ridges <= MAX_WAVE_DIRECTIONS:
        raise ValueError(f"ridges = {args.ridges}, allowed are 1, 2, 3, ... {MAX_WAVE_DIRECTIONS}")
    _check_surface_memory(args)
    waves = synthesis.FractalWaves(size=args.size, points=args.points, gamma=args.gamma)
    if args.shape == "isotropic":
        return synthesis.synthesize_isotropic(waves, args.D[0], args.G[0], args.ridges, args.seed)
    if args.shape == "textured":
        return synthesis.synthesize_textured(waves, tuple(args.D), tuple(args.G), args.seed)
    return synthesis.synthesize_profile(waves, args.D[0], args.G[0], args.seed)


def format_surface_size(surface_heights: ScanHeights) -> str:
    """Format kind, number of points and side lengths of a surface."""
    points = " x ".join(str(n) for n in surface_heights.z.shape[::-1])
    lengths = " x ".join(f"{1e3 * length:.4g}" for length in surface_heights.side_lengths)
    kind = "areal map" if isinstance(surface_heights, ArealMap) else "profile"
    return f"{kind}, {points} points, {lengths} mm"
