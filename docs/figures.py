"""Write the pictures of README and docs: `python build_fmus.py && python docs/figures.py`."""

from pathlib import Path

from jointfmu_fmus.checks import default_ramp
from jointfmu_fmus.report import figures

from jointfmu import validation
from jointfmu.parameters import write_text

ROOT = Path(__file__).resolve().parent


def main() -> None:
    """Write docs/images/*.svg."""
    folder = ROOT.parent / "dist" / "python"
    result = default_ramp("HarmonicDriveCompliance", folder)
    picture = figures.harmonic_stiffness(result, validation.validate())
    write_text(ROOT / "images" / "harmonic_drive_ramp.svg", picture)


if __name__ == "__main__":
    main()
