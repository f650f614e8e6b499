"""Write the pictures of README and docs: `python build_fmus.py && python docs/figures.py`."""

from pathlib import Path
from tempfile import TemporaryDirectory

from jointfmu_fmu_src import ringing, ssp
from jointfmu_fmu_src.checks import default_ramp
from jointfmu_fmu_src.joints.harmonic_drive import figures
from jointfmu_fmu_src.report.systems import SIZE, draw

from jointfmu import plots, validation
from jointfmu.parameters import load, write_text

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"


def main() -> None:
    """Write docs/images."""
    result = default_ramp("HarmonicDriveCompliance", ROOT / "dist" / "python")
    picture = figures.stiffness(result, validation.validate())
    write_text(IMAGES / "harmonic_drive_ramp.svg", picture)
    resonance(IMAGES / "tutorial_resonance.png")


def resonance(path: Path) -> None:
    """Draw the plot in which the tutorial ends."""
    drive = load(ROOT / "models" / "catalogue" / "size_14_ratio_80.toml")
    with TemporaryDirectory() as folder:
        ssp.build_systems(Path(folder), drive)
        points = ringing.ring("robot_joint", Path(folder) / "fmi2")
    with plots.drawing(path, SIZE) as canvas:
        draw(canvas, points, ringing.body_on(drive.joint))


if __name__ == "__main__":
    main()
