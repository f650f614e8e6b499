"""Write the pictures of README and docs: `python build_fmus.py && python docs/figures.py`.

`python docs/figures.py house` needs no FMUs: it draws the packages and layers from pyproject.toml.
"""

import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from jointfmu_fmu_src import cosimulation, ringing, ssp
from jointfmu_fmu_src.checks import default_ramp
from jointfmu_fmu_src.drawing import BLUE, GREY, RED, short, svg
from jointfmu_fmu_src.joints.harmonic_drive import figures
from jointfmu_fmu_src.python.build import runtime_sources
from jointfmu_fmu_src.report import motion
from jointfmu_fmu_src.report.systems import SIZE, draw
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from jointfmu import plots, validation
from jointfmu.joints import KINDS
from jointfmu.joints.harmonic_drive.fit import lines
from jointfmu.joints.harmonic_drive.fit.row import Row
from jointfmu.parameters import write_text
from jointfmu.systems import system

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"

WIDTH, LEFT, RIGHT, ROW, BAND, EDGE = 8.0, 4.3, 3.2, 0.29, 0.86, 0.08
"""Sizes of the house [inch]: width, that of its two columns, height of a layer and of the joints, margin."""
LETTER = 0.078
"""Width of a letter of the figures' style [inch], about."""


def main() -> None:
    """Write docs/images."""
    write_text(IMAGES / "house.svg", house())
    if sys.argv[1:] == ["house"]:
        return
    result = default_ramp("HarmonicDriveCompliance", ROOT / "dist" / "python")
    picture = figures.stiffness(result, validation.validate())
    write_text(IMAGES / "harmonic_drive_ramp.svg", picture)
    resonance(IMAGES / "tutorial_resonance.png")
    robot(IMAGES / "six_axis_robot.png")


def robot(path: Path) -> None:
    """Draw what the robot of the systems does."""
    found = system("six_axis_robot")
    with TemporaryDirectory() as folder:
        ssp.build_systems(Path(folder), [found])
        run = cosimulation.simulate(found, Path(folder) / "fmi2")
    with plots.drawing(path, motion.SIZE) as canvas:
        motion.draw(canvas, found, run)


def resonance(path: Path) -> None:
    """Draw the plot in which the tutorial ends."""
    row = Row(K1=4700.0, K2=6100.0, K3=7100.0, T1=2.0, T2=6.9, rated=6.9)
    drive = lines.fit(row, ratio=100.0).parameters
    with TemporaryDirectory() as folder:
        ssp.build_systems(Path(folder), parameters=drive)
        one = ringing.rung(system("robot_joint"))
        points = ringing.ring(one, Path(folder) / "fmi2")
        with plots.drawing(path, SIZE) as canvas:
            draw(canvas, points, one, Path(folder) / "fmi2")


def house() -> str:
    """The house as SVG: layers as the import contracts have them, and the joints through both packages."""
    core, builder = (_layers(package) for package in ("jointfmu", "jointfmu_fmu_src"))
    place = next(i for i, names in enumerate(core) if "joints" in names)
    above, below = core[:place], core[place + 1 :]
    rooms = [[name for name in names if name != "joints"] for names in builder]
    joints = EDGE + ROW * len(below)
    roof, eaves = (joints + BAND + ROW * len(rows) for rows in (above, rooms))
    left, right = (EDGE, LEFT), (WIDTH - EDGE - RIGHT, RIGHT)
    inside = _inside()

    def draw(canvas: Figure) -> None:
        axes = canvas.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(0.0, WIDTH)
        axes.set_ylim(0.0, roof + 0.4)
        _storeys(axes, left, roof, above, inside)
        _storeys(axes, left, joints, below, inside)
        _storeys(axes, right, eaves, rooms, inside)
        for (x, width), y, title in ((left, roof, "core/jointfmu"), (right, eaves, "fmu_src")):
            axes.text(x + 0.5 * width, y + 0.12, title, ha="center", weight="bold", size=12)
        _joints(axes, joints)
        _legend(axes, right[0], joints)

    return short(svg(draw, (WIDTH, roof + 0.4), layout=None)) + "\n"


def _layers(package: str) -> list[list[str]]:
    """Layers of a package from above, the names that stand beside each other in a row."""
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    contract = next(c for c in tools["importlinter"]["contracts"] if c.get("containers") == [package])
    rows = [layer.split(" | ") for layer in contract["layers"]]
    return [names for names in rows if not names[0].startswith("_")]


def _inside() -> set[str]:
    """Names of the modules and packages of which something runs inside a Python FMU."""
    files = [Path(name) for kind in KINDS.values() for name in runtime_sources(kind)]
    return {name for file in files for name in (*file.parent.parts, file.stem)}


def _storeys(
    axes: Axes, column: tuple[float, float], top: float, layers: Sequence[Sequence[str]], inside: set[str]
) -> None:
    """A row for each layer, downwards from `top`, in a column (x, width)."""
    x, width = column
    for i, names in enumerate(layers):
        y = top - ROW * (i + 1)
        face = "#e8f0fa" if inside & set(names) else "#f4f4f4"
        axes.add_patch(Rectangle((x, y), width, ROW, facecolor=face, edgecolor="white", linewidth=2.0))
        words = [(name, BLUE if name in inside else "black") for name in names]
        _words(axes, x + 0.5 * width, y + 0.5 * ROW, words)


def _words(axes: Axes, x: float, y: float, words: Sequence[tuple[str, str]]) -> None:
    """Coloured words in a row about x."""
    widths = [LETTER * (len(word) + 2) for word, _ in words]
    start = x - 0.5 * sum(widths)
    for (word, colour), width in zip(words, widths, strict=True):
        axes.text(start + 0.5 * width, y, word, ha="center", va="center", color=colour)
        start += width


def _joints(axes: Axes, y: float) -> None:
    """The joints: a folder of one name in both packages and in models."""
    place, width = (EDGE, y), WIDTH - 2.0 * EDGE
    axes.add_patch(Rectangle(place, width, BAND, facecolor="#fbeeea", edgecolor=RED, linewidth=1.2))
    names = ["core/jointfmu/joints/KIND", "fmu_src/joints/KIND", "models/KIND", "tests/KIND"]
    axes.text(0.5 * WIDTH, y + 0.68 * BAND, "     ".join(names), ha="center", va="center", color=RED)
    kinds = "   ".join(name for name, kind in KINDS.items() if kind.own)
    axes.text(0.5 * WIDTH, y + 0.3 * BAND, f"KIND:  {kinds}", ha="center", va="center", weight="bold")


def _legend(axes: Axes, x: float, top: float) -> None:
    """What arrow and colours mean."""
    arrow = {"arrowstyle": "->", "color": GREY, "lw": 1.5}
    axes.annotate("", (x - 0.18, EDGE), (x - 0.18, top - 0.1), arrowprops=arrow)
    lines = (
        ("imports run downwards", GREY),
        ("blue: runs inside a Python FMU,", BLUE),
        ("needs numpy only", BLUE),
        ("C FMUs: generated from the same", "black"),
        ("functions by fmu_src/native", "black"),
    )
    for i, (line, colour) in enumerate(lines):
        axes.text(x, top - 0.28 - 0.3 * i, line, va="center", color=colour)


if __name__ == "__main__":
    main()
