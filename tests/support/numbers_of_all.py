"""Print all numbers in the FMUs and Modelica components of parameter files as JSON.

python tests/support/numbers_of_all.py FOLDER [FILE ...]

The Modelica library is written into the folder. FILE: parameter files in addition to the shipped ones.
"""

import json
import sys
from contextlib import redirect_stdout
from importlib.resources import files
from pathlib import Path

import pytest
from jointfmu_fmu_src.native.code.generate import generate_sources
from jointfmu_fmu_src.proof import experiments
from jointfmu_fmu_src.proof.members import make_proof_files
from jointfmu_tools.cli import main

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import load_parameter_file

GENERATED = ("data.c", "law.c", "law.h", "variables.c")


def texts(paths: list[Path]) -> dict[str, str]:
    """Texts {file: text} of sources and of proof results.

    The proofs of the files that are not shipped have the load ramp and loops alone: elastic plates take 20 ms
    a point, and the shipped files have all varied parameters.
    """
    shipped = files("jointfmu_models")
    found = texts_of([Path(str(p)) for kind in KINDS for p in sorted((shipped / kind).glob("*.toml"))])
    with pytest.MonkeyPatch.context() as patch:
        for varied in ("_compute_boundary_experiments", "_compute_sampled_experiments"):
            patch.setattr(experiments, varied, lambda model, parameters: ())
        return found | texts_of(paths)


def texts_of(paths: list[Path]) -> dict[str, str]:
    """Texts {file: text} of sources and of the results of all experiments."""
    found: dict[str, str] = {}
    for path in paths:
        file = load_parameter_file(path)
        for name in (name for name, model in MODELS.items() if model.joint == file.joint):
            model = MODELS[name].with_parameters(file.joint, file.values)
            made = {k: v for k, v in generate_sources(name, file).items() if k in GENERATED}
            made |= {k: v.decode() for k, v in make_proof_files(model, file).items() if k.endswith(".csv")}
            found |= {f"{path.stem}/{name}/{k}": text for k, text in made.items()}
    return found


def components(folder: Path) -> dict[str, str]:
    """Texts {path: text} of the Modelica library in a folder."""
    return {str(p.relative_to(folder)): p.read_text(encoding="utf-8") for p in sorted(folder.rglob("*.mo"))}


if __name__ == "__main__":
    out = Path(sys.argv[1])
    with redirect_stdout(sys.stderr):
        assert main(["modelica", "--out", str(out)]) == 0
    json.dump(texts([Path(path) for path in sys.argv[2:]]) | components(out), sys.stdout)
