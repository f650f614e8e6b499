"""Write the pictures of README and docs: `python build_fmus.py && python docs/figures.py`.

Three arguments write single pictures and need no FMUs: `house` (packages and layers from pyproject.toml),
`examples` (pictures of the scripts in `examples`) and `elastic` (the arm on its drives).
"""

import io
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from jointfmu_fmu_src.python.build import collect_runtime_sources
from jointfmu_tools import cli
from jointfmu_tools.common import plots
from jointfmu_tools.common.plots import BLUE, GREY, RED
from jointfmu_tools.joints.harmonic_drive import job
from jointfmu_tools.joints.harmonic_drive.fit import catalogue
from jointfmu_tools.joints.harmonic_drive.fit.drive import CatalogueRow
from jointfmu_tools.pages.report.figure import draw_panels
from jointfmu_tools.pages.report.systems import RESONANCE_FIGURE_SIZE, resonance_charts
from jointfmu_tools.studies.checks import run_default_ramp
from jointfmu_tools.studies.published import validation
from jointfmu_tools.systems import ringing, ssp
from jointfmu_tools.systems.system import load_system
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from jointfmu.files.writing import write_bytes, write_text
from jointfmu.joints import KINDS

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))

WIDTH, LAYER_WIDTH, ROW, HEAD, EDGE = 9.4, 6.5, 0.29, 0.36, 0.08
"""Sizes in the architecture picture [inch]: width, width of the layers, height of a layer and of a title,
margin."""
PACKAGES = {"jointfmu_tools": "tools", "jointfmu_fmu_src": "fmu_src", "jointfmu": "core/jointfmu"}
"""{import name: folder} of the packages, from above."""
LETTER = 0.078
"""Approximate width of a letter in the style of the figures [inch]."""


def main() -> None:
    """Draw the pictures in docs/images."""
    if sys.argv[1:] in ([], ["house"]):
        write_text(IMAGES / "house.svg", draw_architecture())
    if sys.argv[1:] in ([], ["examples"]):
        for script in EXAMPLES:
            draw_example(script)
    if sys.argv[1:] in ([], ["elastic"]):
        draw_robot_frequencies(IMAGES / "robot_frequencies.png")
    if sys.argv[1:]:
        return
    result = run_default_ramp("HarmonicDriveCompliance", ROOT / "dist" / "python")
    panels = job.make_stiffness_charts(result, validation.validate_published_numbers())
    write_text(
        IMAGES / "harmonic_drive_ramp.svg",
        svg(lambda canvas: draw_panels(canvas, panels), RESONANCE_FIGURE_SIZE),
    )
    draw_tutorial_resonance(IMAGES / "tutorial_resonance.png")


def draw_robot_frequencies(path: Path) -> None:
    """Draw the natural frequencies of the six-axis arm over its poses, with the shipped drives."""
    sizes = ("CSG-32-100", "CSG-40-100", "CSG-25-100", "CSG-20-100", "CSG-17-100", "CSG-14-100")
    drives = [f"joint{i}={size}" for i, size in enumerate(sizes, 1)]
    robot = ROOT / "models" / "robots" / "six_axis.xml"
    with TemporaryDirectory() as folder:
        cli.main(["robot", str(robot), "--drive", *drives, "--payload", "3", "--out", folder])
        write_bytes(path, (Path(folder) / "frequencies.png").read_bytes())


def draw_example(script: Path) -> None:
    """Run an example in an empty folder and keep its picture."""
    environment = os.environ | {"MPLBACKEND": "agg"}
    with TemporaryDirectory() as folder:
        subprocess.run([sys.executable, script], cwd=folder, env=environment, check=True)
        picture = Path(folder) / f"{script.stem}.png"
        write_bytes(IMAGES / f"example_{picture.name}", picture.read_bytes())


def draw_tutorial_resonance(path: Path) -> None:
    """Draw the plot at the end of the tutorial."""
    row = CatalogueRow(K1=4700.0, K2=6100.0, K3=7100.0, T1=2.0, T2=6.9, rated_torque=6.9)
    drive = catalogue.make_drive_with_catalogue_law_from_row(
        row, sourced_numbers=catalogue.make_sourced_numbers(row, speed_ratio=100.0)
    ).parameters
    with TemporaryDirectory() as folder:
        ssp.build_system_archives(Path(folder), parameter_file=drive)
        one = ringing.find_vibrating_joint(load_system("robot_joint"))
        points = ringing.simulate_vibrations(one, Path(folder) / "fmi2")
        with plots.open_figure(path, RESONANCE_FIGURE_SIZE) as canvas:
            draw_panels(canvas, resonance_charts(points, one, Path(folder) / "fmi2"))


def draw_architecture() -> str:
    """Draw the architecture as SVG: three packages one above the other, with the layers of the import
    contracts."""
    storeys = [(title, _layers(package)) for package, title in PACKAGES.items()]
    height = 2.0 * EDGE + sum(HEAD + ROW * len(layers) for _, layers in storeys)
    running = _inside()

    def draw(canvas: Figure) -> None:
        axes = canvas.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(0.0, WIDTH)
        axes.set_ylim(0.0, height)
        top = height - EDGE
        for title, layers in storeys:
            axes.text(EDGE, top - 0.7 * HEAD, title, weight="bold", size=12)
            _storey(axes, top - HEAD, layers, set() if title == "tools" else running)
            top -= HEAD + ROW * len(layers)
        _legend(axes, height - EDGE)

    return svg(draw, (WIDTH, height), layout=None) + "\n"


def svg(draw: Callable[[Figure], None], size: tuple[float, float], layout: str | None = "constrained") -> str:
    """Context with a figure of a size [inch], saved as small SVG: coordinates in hundredths of a point, no
    metadata."""
    with plots.apply_plot_style():
        figure, text = Figure(figsize=size, layout=layout), io.StringIO()
        draw(figure)
        figure.savefig(text, format="svg", metadata={"Date": None})
    found = text.getvalue()[text.getvalue().index("<svg") :]
    found = re.sub(r"<metadata>.*?</metadata>", "", found, flags=re.DOTALL)
    found = re.sub(r' transform="rotate\(-0 [^"]*"', "", found)
    found = re.sub(r"-?\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), found)
    return re.sub(r"\s*\n\s*", "\n", found)


def _layers(package: str) -> list[list[str]]:
    """Layers of the package from the top; each row has the names of modules of one layer."""
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    contract = next(c for c in tools["importlinter"]["contracts"] if c.get("containers") == [package])
    rows = [layer.split(" | ") for layer in contract["layers"]]
    return [names for names in rows if not names[0].startswith("_")]


def _inside() -> set[str]:
    """Names of the modules and packages that are part of a Python FMU."""
    files = [Path(name) for kind in KINDS.values() for name in collect_runtime_sources(kind)]
    return {name for file in files for name in (*file.parent.parts, file.stem)}


def _storey(axes: Axes, top: float, layers: Sequence[Sequence[str]], running: set[str]) -> None:
    """Draw a package: a row for each layer, from y = `top` downwards."""
    for i, names in enumerate(layers):
        y = top - ROW * (i + 1)
        colours = [RED if name == "joints" else BLUE if name in running else "black" for name in names]
        face = "#fbeeea" if RED in colours else "#e8f0fa" if BLUE in colours else "#f4f4f4"
        axes.add_patch(
            Rectangle((EDGE, y), LAYER_WIDTH, ROW, facecolor=face, edgecolor="white", linewidth=2.0)
        )
        _words(axes, EDGE + 0.5 * LAYER_WIDTH, y + 0.5 * ROW, list(zip(names, colours, strict=True)))


def _words(axes: Axes, x: float, y: float, words: Sequence[tuple[str, str]]) -> None:
    """Draw coloured words in a row centred at x."""
    widths = [LETTER * (len(word) + 2) for word, _ in words]
    start = x - 0.5 * sum(widths)
    for (word, colour), width in zip(words, widths, strict=True):
        axes.text(start + 0.5 * width, y, word, ha="center", va="center", color=colour)
        start += width


def _legend(axes: Axes, top: float) -> None:
    """Draw the legend: meaning of arrow and colours."""
    x = EDGE + LAYER_WIDTH + 0.35
    arrow = {"arrowstyle": "->", "color": GREY, "lw": 1.5}
    axes.annotate("", (x - 0.18, EDGE), (x - 0.18, top), arrowprops=arrow)
    lines = (
        ("imports run downwards", GREY),
        ("red: a folder for each joint,", RED),
        *((f"    {name}", RED) for name, kind in KINDS.items() if kind.is_builtin),
        ("blue: runs inside a Python FMU,", BLUE),
        ("needs numpy only", BLUE),
        ("C FMUs: generated from the same", "black"),
        ("functions by fmu_src/native", "black"),
    )
    for i, (line, colour) in enumerate(lines):
        axes.text(x, top - 0.28 - 0.3 * i, line, va="center", color=colour)


if __name__ == "__main__":
    main()
