"""`jointfmu surface synthesize`: a seeded Weierstrass-Mandelbrot surface."""

import argparse

from jointfmu.files.writing import write_text

from ...command_line.common import Answer, Commands, argument, command
from ...command_line.outputs import output
from ...surfaces import csvfile, synthesis
from ...surfaces.heights import Areal, Heights

MEMORY = 2e9
"""Memory [B] that making a surface and its file may take."""
MAP_POINT, PROFILE_POINT = 64.0, 190.0
"""Memory [B] for a point of a map and of a profile, with its text (measured at a million points)."""
MOST_RIDGES = 1000
SHAPES = ("isotropic", "textured", "profile")


def add(steps: Commands, name: str) -> None:
    """Declare the sub-command."""
    make = command(steps, name, _synthesize, "make a Weierstrass-Mandelbrot surface")
    make.add_argument(
        "--shape", choices=SHAPES, default=SHAPES[0], help="default: isotropic (Hu 2023, Eq. 1)"
    )
    argument(make, "--size", float, "side length [m]", "SIZE", required=True)
    argument(make, "--points", int, "points along a side", "POINTS", required=True)
    text = "isotropic: D_s of the surface (2 to 3); textured: D along x and y; profile: D (1 to 2)"
    argument(make, "--D", float, text, "D", nargs="+", required=True)
    argument(make, "--G", float, "[m], as many as D", "G", nargs="+", required=True)
    argument(make, "--gamma", float, "frequency ratio", "GAMMA", default=1.5)
    argument(make, "--ridges", int, "M of an isotropic surface, superposed directions", "RIDGES", default=20)
    argument(make, "--seed", int, "of the random phases", "SEED", default=0)
    output(make, "--out", csvfile.SCAN, "file to write (.csv)", required=True)


def _synthesize(args: argparse.Namespace) -> Answer:
    if args.out.suffix.lower() != ".csv":
        raise ValueError(f"{args.out}: suffix {args.out.suffix!r}, allowed is .csv")
    heights = _made(args)
    write_text(args.out, csvfile.text(heights))
    shown = {
        "file": str(args.out),
        "shape": args.shape,
        "points": heights.z.size,
        "rms": float(heights.z.std()),
        "D" if args.shape != "isotropic" else "D_s": args.D,
        "G" if args.shape != "isotropic" else "G_s": args.G,
        "gamma": args.gamma,
        "seed": args.seed,
    }
    lines = [f"wrote {args.out}: {size(heights)}, rms height {shown['rms']:.4g} m"]
    return Answer(document=shown, lines=lines)


def _check_memory(args: argparse.Namespace) -> None:
    """Refuse more points than MEMORY holds."""
    if args.shape == "profile":
        each, number = PROFILE_POINT, float(args.points)
        most = MEMORY / each
    else:
        each, number = MAP_POINT, float(args.points) ** 2
        most = (MEMORY / each) ** 0.5
    if number * each > MEMORY:
        raise ValueError(
            f"points = {args.points} take {number * each / 1e9:.3g} GB, allowed are {MEMORY / 1e9:g} GB: "
            f"at most {int(most)} points along a side of shape {args.shape}"
        )


def _made(args: argparse.Namespace) -> Heights:
    count = 2 if args.shape == "textured" else 1
    for name, given in (("D", args.D), ("G", args.G)):
        if len(given) != count:
            raise ValueError(
                f"--{name} has {len(given)} values, a surface of shape {args.shape} takes {count}"
            )
        if name == "G" and any(not 0.0 < value < float("inf") for value in given):
            raise ValueError(f"G = {min(given):g} m is outside (0, inf): fractal roughness")
    if args.seed < 0:
        raise ValueError(f"seed = {args.seed} is negative, allowed are 0, 1, 2, ...")
    if not 1 <= args.ridges <= MOST_RIDGES:
        raise ValueError(f"ridges = {args.ridges}, allowed are 1, 2, 3, ... {MOST_RIDGES}")
    _check_memory(args)
    waves = synthesis.Waves(size=args.size, points=args.points, gamma=args.gamma)
    if args.shape == "isotropic":
        return synthesis.isotropic(waves, args.D[0], args.G[0], args.ridges, args.seed)
    if args.shape == "textured":
        return synthesis.textured(waves, tuple(args.D), tuple(args.G), args.seed)
    return synthesis.profile(waves, args.D[0], args.G[0], args.seed)


def size(heights: Heights) -> str:
    """Kind, points and lengths in words."""
    points = " x ".join(str(n) for n in heights.z.shape[::-1])
    lengths = " x ".join(f"{1e3 * length:.4g}" for length in heights.lengths)
    return f"{'areal map' if isinstance(heights, Areal) else 'profile'}, {points} points, {lengths} mm"
