"""All C sources of an FMU: hand-written runtime, and code generated from the variables and joint laws."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval
from jointfmu.version import __version__

from ...folders import find_fmu_build_data, find_joint_folder
from ...joint_parts.c_text import format_array_definition, format_double_literal, format_string_literal
from ...joint_parts.data import ParameterSplit
from ...joint_parts.graph import build_c_function_set
from ...joint_parts.native import NativeDefinition
from ...partners import PARTNERS
from ..data import (
    GENERATED_FILE_COMMENT,
    make_fmu_data_struct,
    make_placeholder_data_struct,
    split_parameters,
)
from .elementary import make_tables_header
from .law_c import format_law_sources

RUNTIME_FOLDER = Path(__file__).parent.with_name("runtime")
"""Folder of the hand-written C files of every FMU."""
_GENERATED_FILE_NAMES = ("law.h", "law.c", "variables.c", "model.h", "elementary_tables.h")
"""Names of the generated C files of an FMU, besides data.c."""
_cached_law_sources: dict[tuple[object, ...], tuple[str, str]] = {}
"""{structure of the parameters: (text of law.h, text of law.c)} of this process."""


def list_runtime_files(law_file_stems: Sequence[str] = ()) -> list[Path]:
    """List the hand-written C files of every FMU, and files in `runtime/law/` with given names (stems)."""
    return sorted(
        p for p in RUNTIME_FOLDER.rglob("*.[ch]") if p.parent.name != "law" or p.stem in law_file_stems
    )


def generate_sources(fmu_name: str, parameter_file: ParameterFile) -> dict[str, str]:
    """Generate all C sources of an FMU with its data, for both FMI versions: {file name: text}.

    Raises ValueError if the parameters are of another joint.
    """
    fmu_model = (MODELS | PARTNERS)[fmu_name].with_parameters(parameter_file.joint, parameter_file.values)
    parameter_split = split_parameters(fmu_model, parameter_file)
    files = generate_sources_without_data(fmu_model, parameter_file, parameter_split)
    return files | {
        "data.c": make_fmu_data_struct(fmu_model, parameter_file, parameter_split, files).make_c_source()
    }


def generate_sources_without_data(
    fmu_model: Model, parameter_file: ParameterFile, parameter_split: ParameterSplit
) -> dict[str, str]:
    """Generate all C sources of an FMU except data.c: {file name: text}.

    Parameter files that differ only in numbers in data.c give the same sources.
    """
    native = load_native_definition(fmu_model)
    files = _read_handwritten_files(fmu_model, native)
    files["law.h"], files["law.c"] = _generate_law_sources(fmu_model, parameter_split, native)
    files |= {
        "variables.c": format_variables_c(fmu_model),
        "model.h": _format_model_header(fmu_model, parameter_file.values, native.history_layout.value_count),
    }
    files |= {"elementary_tables.h": make_tables_header()}
    head = GENERATED_FILE_COMMENT.format(version=__version__, of="")
    files |= {n: head + files[n] for n in _GENERATED_FILE_NAMES}
    return dict(
        sorted(
            (
                files | {"data.h": make_placeholder_data_struct(fmu_model, parameter_split).make_c_header()}
            ).items()
        )
    )


def _generate_law_sources(
    fmu_model: Model, parameter_split: ParameterSplit, native_definition: NativeDefinition
) -> tuple[str, str]:
    """Generate the C files law.h and law.c of an FMU, once for all parameter files with the same C code."""
    key = (
        fmu_model.name,
        fmu_model.evaluate,
        fmu_model.parameter_class,
        parameter_split.parameter_class,
        parameter_split.code_structure_key,
    )
    if key not in _cached_law_sources:
        _cached_law_sources[key] = format_law_sources(
            build_c_function_set(
                fmu_model,
                parameter_split,
                native_definition.add_joint_functions,
                native_definition.is_tabulated,
            ),
            fmu_model,
            native_definition,
        )
    return _cached_law_sources[key]


def read_instantiation_token(source_texts: Mapping[str, str]) -> str:
    """Read the GUID or instantiation token of an FMU from the file data.c of its C sources."""
    line = next(line for line in source_texts["data.c"].splitlines() if ".token = " in line)
    return line.split('"')[1]


def load_native_definition(fmu_model: Model) -> NativeDefinition:
    """Import the definition of the C code of an FMU's model.

    Raises ValueError if the builder data of its joint have no such definition, or if only one of the Python
    model and the C code has history variables.
    """
    load = find_fmu_build_data(fmu_model).load_native_definition
    if load is None:
        raise ValueError(
            f"{fmu_model.name}: the joint {fmu_model.joint!r} has no module native.py; expected its list of "
            "C files"
        )
    native = load()
    if (fmu_model.initial_history is None) != (native.history_layout.value_count == 0):
        sides = ["`initial_history` in Python", "`history_layout` in native.py"]
        present, missing = sides if fmu_model.initial_history is not None else sides[::-1]
        raise ValueError(f"{fmu_model.name}: has {present}, but no {missing}; state both or neither")
    return native


def _read_handwritten_files(fmu_model: Model, native_definition: NativeDefinition) -> dict[str, str]:
    """Read the hand-written C files of a joint: {file name: text} of runtime, shared and own files."""
    paths = list_runtime_files((*native_definition.shared_file_stems, "elementary"))
    joint_files = [path for path in find_joint_folder(fmu_model).iterdir() if path.suffix in (".c", ".h")]
    header = [path.name for path in joint_files if path.suffix == ".h"]
    files = {"joint_model.h": "".join(f'#include "{name}"\n' for name in header)} if header else {}
    return files | {path.name: path.read_text(encoding="utf-8") for path in sorted([*paths, *joint_files])}


def _format_model_header(fmu_model: Model, parameter_set: object, history_size: int) -> str:
    """Format the C header model.h: numbers of variables of an FMU, and indices of its inputs."""
    macros = (
        f"#define N_STATES {fmu_model.state_count}\n#define IS_TIME_DEPENDENT 1\n"
        if fmu_model.is_time_dependent
        else ""
    )
    if fmu_model.evaluate_residuals:
        macros += "#define HAS_JACOBIAN 1\n"
    fields = list(fmu_model.parameter_fields())
    if "lag_a" in fields:
        first = 1 + len(fmu_model.inputs) + len(fmu_model.outputs)
        macros += f"#define FIRST_LAG_PARAMETER {first + fields.index('lag_a')}\n"
    if fmu_model.find_event_times:
        macros += f"#define N_TIME_EVENTS {len(fmu_model.find_event_times(parameter_set))}\n"
    names = [  # a name with dots is that of a component without C of its own
        v.name.upper() if v.name.isidentifier() else str(i) for i, v in enumerate(fmu_model.inputs)
    ]
    input_names = ", ".join(f"INPUT_{name}" for name in names)
    if history_size:
        macros += f"#define N_HISTORY {history_size}\n"
    return f"""#ifndef JOINTFMU_MODEL_H
#define JOINTFMU_MODEL_H

{macros}
enum {{ {input_names} }};

enum {{
    N_INPUTS = {len(fmu_model.inputs)},
    N_OUTPUTS = {len(fmu_model.outputs)},
    N_PARAMETERS = {len(fmu_model.parameter_fields())}
}};

#endif
"""


def format_variables_c(fmu_model: Model) -> str:
    """Format variables.c: FMU variables with allowed intervals, and the input dependencies of each output."""
    rows = [_format_variable("time", "s", "time", Interval())]
    rows += [
        _format_variable(v.name, v.unit, v.doc, v.interval, minimum_margin=v.minimum_margin)
        for v in fmu_model.inputs
    ]
    rows += [_format_variable(v.name, v.unit, v.doc, Interval()) for v in fmu_model.outputs]
    for name, item in fmu_model.parameter_fields().items():
        meta = item.metadata
        if "allowed" in meta:
            rows.append(
                _format_variable(
                    name, "1", meta["doc"], Interval.from_bounds(ge=0.0, le=1.0), is_boolean=True
                )
            )
        else:
            rows.append(_format_variable(name, meta["unit"], meta["doc"], meta["interval"], meta["whole"]))
    states = fmu_model.outputs[: fmu_model.state_count]
    links = [
        "{"
        + ", ".join(
            str(int(i.name in fmu_model.list_dependencies(o.name))) for i in (*fmu_model.inputs, *states)
        )
        + "}"
        for o in fmu_model.outputs
    ]
    nominals = format_array_definition(
        "const double state_nominals[N_STATES]", [format_double_literal(v.nominal) for v in states]
    )
    return (
        '#include "variables.h"\n\n#include <math.h>\n\n'
        + format_array_definition("const Variable variables[N_VALUES]", rows)
        + "\n"
        + format_array_definition(
            "const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS + N_STATES]", links
        )
        + (nominals if states else "")
    )


def _format_variable(
    variable_name: str,
    variable_unit: str,
    variable_description: str,
    allowed_interval: Interval,
    is_integer: bool = False,
    is_boolean: bool = False,
    minimum_margin: float = 0.0,
) -> str:
    """Format the C initializer of one FMU variable: name, unit, description, allowed interval."""
    flags = ", ".join(
        str(int(flag))
        for flag in (allowed_interval.low_open, allowed_interval.high_open, is_integer, is_boolean)
    )
    numbers = ", ".join(
        format_double_literal(x) for x in (allowed_interval.low, allowed_interval.high, minimum_margin)
    )
    allowed = "" if is_boolean else str(allowed_interval)
    texts = ", ".join(
        format_string_literal(x)
        for x in (variable_name, "" if variable_unit == "1" else variable_unit, variable_description, allowed)
    )
    return f"{{{texts}, {numbers}, {flags}}}"
