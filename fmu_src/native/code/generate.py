"""All C sources of an FMU: hand-written runtime, and code generated from the variables and joint laws."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from jointfmu.joints import MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval
from jointfmu.version import __version__

from ...folders import find_fmu_parts, find_source_folder
from ...joint_parts.c_text import format_array, format_number, format_string
from ...joint_parts.data import ParameterSplit
from ...joint_parts.graph import build_graph
from ...joint_parts.native import NativeDefinition
from ...partners import PARTNERS
from ..data import GENERATED_COMMENT, make_fmu_data, make_placeholder, split_parameters
from .elementary import make_tables_header
from .law_c import format_law

RUNTIME_FOLDER = Path(__file__).parent.with_name("runtime")
"""Folder of the hand-written C files of every FMU."""
_GENERATED_FILES = ("law.h", "law.c", "variables.c", "model.h", "elementary_tables.h")
"""Names of the generated C files of an FMU, besides data.c."""
_cached_law_texts: dict[tuple[object, ...], tuple[str, str]] = {}
"""{structure of the parameters: (text of law.h, text of law.c)} of this process."""


def list_runtime_files(law_file_stems: Sequence[str] = ()) -> list[Path]:
    """Paths of the hand-written C files of every FMU, and of files in `runtime/law/` with given stems."""
    return sorted(
        p for p in RUNTIME_FOLDER.rglob("*.[ch]") if p.parent.name != "law" or p.stem in law_file_stems
    )


def generate_sources(fmu_name: str, parameters: ParameterFile) -> dict[str, str]:
    """Generate all C sources of an FMU with its data, for both FMI versions: {file name: text}.

    Raises ValueError if the parameters are of another joint.
    """
    model = (MODELS | PARTNERS)[fmu_name].with_parameters(parameters.joint, parameters.values)
    parameter_split = split_parameters(model, parameters)
    files = generate_code(model, parameters, parameter_split)
    return files | {"data.c": make_fmu_data(model, parameters, parameter_split, files).make_source()}


def generate_code(model: Model, parameters: ParameterFile, parameter_split: ParameterSplit) -> dict[str, str]:
    """Generate all C sources of an FMU except data.c: {file name: text}.

    The sources are the same for all parameter files of one structure: files with the same generated code.
    """
    native = load_native_definition(model)
    files = _read_handwritten_files(model, native)
    files["law.h"], files["law.c"] = _generate_law_sources(model, parameter_split, native)
    files |= {
        "variables.c": format_variables_c(model),
        "model.h": _format_model_header(model, parameters.values, native.history_layout.size),
    }
    files |= {"elementary_tables.h": make_tables_header()}
    head = GENERATED_COMMENT.format(version=__version__, of="")
    files |= {n: head + files[n] for n in _GENERATED_FILES}
    return dict(sorted((files | {"data.h": make_placeholder(model, parameter_split).make_header()}).items()))


def _generate_law_sources(
    model: Model, parameter_split: ParameterSplit, native_definition: NativeDefinition
) -> tuple[str, str]:
    """Generate the texts of law.h and law.c, once for all parameter files with the same structure."""
    key = (
        model.name,
        model.evaluate,
        model.parameter_class,
        parameter_split.parameter_class,
        parameter_split.code_structure_key,
    )
    if key not in _cached_law_texts:
        _cached_law_texts[key] = format_law(
            build_graph(
                model, parameter_split, native_definition.add_functions, native_definition.is_tabulated
            ),
            model,
            native_definition,
        )
    return _cached_law_texts[key]


def read_instantiation_token(source_texts: Mapping[str, str]) -> str:
    """Read the GUID or instantiation token in the file data.c of C sources."""
    line = next(line for line in source_texts["data.c"].splitlines() if ".token = " in line)
    return line.split('"')[1]


def load_native_definition(model: Model) -> NativeDefinition:
    """Import the definition of the C code of a model.

    Raises ValueError if the builder data of its joint have none, or if only one of the Python model and the
    C definition has history variables.
    """
    load = find_fmu_parts(model).native
    if load is None:
        raise ValueError(f"{model.name}: the joint {model.joint!r} has no part `native`; expected its C")
    native = load()
    if (model.initial_history is None) != (native.history_layout.size == 0):
        raise ValueError(
            f"{model.name}: one of `initial_history` and the history in C is missing; state both or neither"
        )
    return native


def _read_handwritten_files(model: Model, definition: NativeDefinition) -> dict[str, str]:
    """Read the hand-written C of a joint, {file name: text}: runtime, shared files, files of its own."""
    paths = list_runtime_files((*definition.shared_file_stems, "elementary"))
    joint_files = [path for path in find_source_folder(model).iterdir() if path.suffix in (".c", ".h")]
    header = [path.name for path in joint_files if path.suffix == ".h"]
    files = {"joint_model.h": "".join(f'#include "{name}"\n' for name in header)} if header else {}
    return files | {path.name: path.read_text(encoding="utf-8") for path in sorted([*paths, *joint_files])}


def _format_model_header(model: Model, parameters: object, history_size: int) -> str:
    """Text of model.h: sizes of the model and indices of its inputs."""
    macros = (
        f"#define N_STATES {model.state_count}\n#define IS_TIME_DEPENDENT 1\n"
        if model.is_time_dependent
        else ""
    )
    if model.evaluate_residuals:
        macros += "#define HAS_JACOBIAN 1\n"
    fields = list(model.parameter_fields())
    if "lag_a" in fields:
        first = 1 + len(model.inputs) + len(model.outputs)
        macros += f"#define FIRST_LAG_PARAMETER {first + fields.index('lag_a')}\n"
    if model.find_event_times:
        macros += f"#define N_TIME_EVENTS {len(model.find_event_times(parameters))}\n"
    names = [  # a name with dots is that of a component without C of its own
        v.name.upper() if v.name.isidentifier() else str(i) for i, v in enumerate(model.inputs)
    ]
    input_names = ", ".join(f"INPUT_{name}" for name in names)
    if history_size:
        macros += f"#define N_HISTORY {history_size}\n"
    return f"""#ifndef JOINTFMU_MODEL_H
#define JOINTFMU_MODEL_H

{macros}
enum {{ {input_names} }};

enum {{
    N_INPUTS = {len(model.inputs)},
    N_OUTPUTS = {len(model.outputs)},
    N_PARAMETERS = {len(model.parameter_fields())}
}};

#endif
"""


def format_variables_c(model: Model) -> str:
    """Text of variables.c: variables with their intervals, and the inputs that each output depends on."""
    rows = [_format_variable("time", "s", "time", Interval())]
    rows += [
        _format_variable(v.name, v.unit, v.doc, v.interval, margin=v.minimum_margin) for v in model.inputs
    ]
    rows += [_format_variable(v.name, v.unit, v.doc, Interval()) for v in model.outputs]
    for name, item in model.parameter_fields().items():
        meta = item.metadata
        if "allowed" in meta:
            rows.append(
                _format_variable(
                    name, "1", meta["doc"], Interval.from_bounds(ge=0.0, le=1.0), is_boolean=True
                )
            )
        else:
            rows.append(_format_variable(name, meta["unit"], meta["doc"], meta["interval"], meta["whole"]))
    states = model.outputs[: model.state_count]
    links = [
        "{"
        + ", ".join(str(int(i.name in model.list_dependencies(o.name))) for i in (*model.inputs, *states))
        + "}"
        for o in model.outputs
    ]
    nominals = format_array(
        "const double state_nominals[N_STATES]", [format_number(v.nominal) for v in states]
    )
    return (
        '#include "variables.h"\n\n#include <math.h>\n\n'
        + format_array("const Variable variables[N_VALUES]", rows)
        + "\n"
        + format_array("const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS + N_STATES]", links)
        + (nominals if states else "")
    )


def _format_variable(
    variable_name: str,
    unit: str,
    doc: str,
    interval: Interval,
    is_integer: bool = False,
    is_boolean: bool = False,
    margin: float = 0.0,
) -> str:
    """Format the C initializer of one variable: name, unit, description, interval."""
    flags = ", ".join(
        str(int(flag)) for flag in (interval.low_open, interval.high_open, is_integer, is_boolean)
    )
    numbers = ", ".join(format_number(x) for x in (interval.low, interval.high, margin))
    allowed = "" if is_boolean else str(interval)
    texts = ", ".join(format_string(x) for x in (variable_name, "" if unit == "1" else unit, doc, allowed))
    return f"{{{texts}, {numbers}, {flags}}}"
