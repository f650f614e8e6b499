"""Compile the models that a wheel contains, so that users need no compiler.

    python -m jointfmu_fmu_src.native.compiled.compile_ahead [NAME ...] [--out DIR]

There is one model for each law and choice on which the C code depends. Then run `pip wheel .`.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile, load_default
from jointfmu.progress import track_progress
from jointfmu.quantity import flatten_fields

from ...partners import PARTNERS
from ...partners import load_partner_parameters as partner_parameters
from ..data import split_parameters
from .compiled_models import (
    SHIPPED_MODEL_FOLDER,
    get_compiled_model,
    make_compiled_model_file_name,
    pack_compiled_model,
)


def compile_models_ahead(fmu_names: Sequence[str], output_folder: Path) -> list[Path]:
    """Write the compiled models of FMUs into a folder and return the files; other files there are deleted.

    fmu_names : names of FMUs; empty: all

    Raises as `compiled_models.get_compiled_model`, and ValueError for an unknown name.
    """
    models = MODELS | PARTNERS
    if unknown := [name for name in fmu_names if name not in models]:
        raise ValueError(f"unknown FMU {unknown[0]!r}, allowed are {', '.join(models)}")
    jobs = [job for name in fmu_names or models for job in list_code_structures(models[name])]
    output_folder.mkdir(parents=True, exist_ok=True)
    written_files = []
    for fmu_model, parameter_file in track_progress(jobs, "compile", len(jobs)):
        parameter_split = split_parameters(fmu_model, parameter_file)
        compiled = get_compiled_model(fmu_model, parameter_file, parameter_split)
        file = output_folder / make_compiled_model_file_name(fmu_model, parameter_split)
        file.write_bytes(pack_compiled_model(compiled))
        written_files.append(file)
    for old_file in set(output_folder.iterdir()) - set(written_files):
        old_file.unlink()
    return written_files


def list_code_structures(fmu_model: Model) -> Iterator[tuple[Model, ParameterFile]]:
    """Yield (model, parameter file) of an FMU once for each law and choice that has its own C code."""
    if fmu_model.name in PARTNERS:
        yield fmu_model, partner_parameters(fmu_model.name)
        return
    for law in KINDS[fmu_model.joint].laws:
        file = load_default(fmu_model.joint, law)
        law_model = fmu_model.with_parameters(file.joint, file.values)
        for choices in _list_choice_combinations(law_model, file):
            try:
                chosen = file.with_values(choices, "user", "compiled ahead")
            except ValueError:  # the choice needs parameters that the file does not have
                continue
            yield law_model, chosen


def _list_choice_combinations(
    fmu_model: Model, parameter_file: ParameterFile
) -> Iterator[Mapping[str, object]]:
    """Yield all combinations {name: value} of those choice parameters on which the C code depends."""
    code = split_parameters(fmu_model, parameter_file).code_generation_values
    allowed = {
        name: item.metadata["allowed"]
        for name, item in flatten_fields(type(parameter_file.values))
        if name in code and "allowed" in item.metadata
    }
    for values in product(*allowed.values()):
        yield dict(zip(allowed, values, strict=True))


def main() -> None:
    """Compile the FMUs that the command line names, and print number and size of the files."""
    parser = argparse.ArgumentParser(description="Compile the models that a wheel contains.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="FMUs to compile (default: all)")
    parser.add_argument(
        "--out",
        type=Path,
        default=SHIPPED_MODEL_FOLDER,
        metavar="DIR",
        help="folder to write (default: the folder of the package)",
    )
    arguments = parser.parse_args()
    try:
        written_files = compile_models_ahead(arguments.names, arguments.out)
    except ImportError as error:
        sys.exit(f"compile_ahead: {error}; install what building needs with: pip install -e '.[build]'")
    except (RuntimeError, ValueError) as error:
        sys.exit(f"compile_ahead: {error}")
    size = sum(file.stat().st_size for file in written_files)
    print(f"{len(written_files)} files, {size / 1e6:.1f} MB in {arguments.out}")


if __name__ == "__main__":
    main()
