"""All C sources of an FMU: hand-written runtime, and code generated from the variables and joint laws."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from jointfmu import __version__
from jointfmu.joints import MODELS
from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval

from ...folders import own_folder, parts_of
from ...joint_parts.c_text import array, number, string
from ...joint_parts.data import Split
from ...joint_parts.graph import graph
from ...joint_parts.native import NativePart
from ...partners import PARTNERS
from ..data import GENERATED, data_of, placeholder, split
from .elementary import tables
from .law_c import law_c

RUNTIME = Path(__file__).parent.with_name("runtime")
_GENERATED = ("law.h", "law.c", "variables.c", "model.h", "elementary_tables.h")
_laws: dict[tuple[object, ...], tuple[str, str]] = {}


def runtime(law: Sequence[str] = ()) -> list[Path]:
    """Paths of the hand-written C files of every FMU, and of files in `runtime/law/` with given stems."""
    return sorted(p for p in RUNTIME.rglob("*.[ch]") if p.parent.name != "law" or p.stem in law)


def sources(name: str, parameters: ParameterFile) -> dict[str, str]:
    """{file name: text} of all C sources of an FMU with its data, for both FMI versions.

    Raises ValueError if the parameters are of another joint.
    """
    model = (MODELS | PARTNERS)[name].with_parameters(parameters.joint, parameters.values)
    parameter_split = split(model, parameters)
    files = code(model, parameters, parameter_split)
    return files | {"data.c": data_of(model, parameters, parameter_split, files).source()}


def code(model: Model, parameters: ParameterFile, split: Split) -> dict[str, str]:
    """{file name: text} of all C sources but data.c, the same for all parameter files of one structure."""
    native = native_part(model)
    files = _handwritten(model, native)
    files["law.h"], files["law.c"] = _law(model, split, native)
    files |= {
        "variables.c": variables_c(model),
        "model.h": _model(model, parameters.values, native.memory.size),
    }
    files |= {"elementary_tables.h": tables()}
    head = GENERATED.format(version=__version__, of="")
    files |= {n: head + files[n] for n in _GENERATED}
    return dict(sorted((files | {"data.h": placeholder(model, split).header()}).items()))


def _law(model: Model, split: Split, native: NativePart) -> tuple[str, str]:
    """Texts of law.h and law.c, generated once for all parameter files of one structure."""
    key = model.name, model.parameters, split.of, split.structure
    if key not in _laws:
        _laws[key] = law_c(graph(model, split, native.functions, native.tabulated), model, native)
    return _laws[key]


def token(files: Mapping[str, str]) -> str:
    """GUID or instantiation token in the file data.c of C sources."""
    line = next(line for line in files["data.c"].splitlines() if ".token = " in line)
    return line.split('"')[1]


def native_part(model: Model) -> NativePart:
    """Definition of the C code of a model.

    Raises ValueError if the builder data of its joint have none, or if only one of the Python model and the
    C definition has history variables.
    """
    load = parts_of(model).native
    if load is None:
        raise ValueError(f"{model.name}: the joint {model.joint!r} has no part `native`; expected its C")
    native = load()
    if (model.initial_history is None) != (native.memory.size == 0):
        raise ValueError(f"{model.name}: one of `rest` and the memory in C is given, expected both or none")
    return native


def _handwritten(model: Model, native: NativePart) -> dict[str, str]:
    """{file name: text} of hand-written C: runtime, shared files of the joint, its own files."""
    paths = runtime((*native.shared, "elementary"))
    joint_files = [path for path in own_folder(model).iterdir() if path.suffix in (".c", ".h")]
    header = [path.name for path in joint_files if path.suffix == ".h"]
    files = {"joint_model.h": "".join(f'#include "{name}"\n' for name in header)} if header else {}
    return files | {path.name: path.read_text(encoding="utf-8") for path in sorted([*paths, *joint_files])}


def _model(model: Model, parameters: object, memory: int) -> str:
    """Text of model.h: sizes of the model and indices of its inputs."""
    macros = (
        f"#define N_STATES {model.state_count}\n#define IS_TIME_DEPENDENT 1\n"
        if model.is_time_dependent
        else ""
    )
    fields = list(model.parameter_fields())
    if "lag_a" in fields:
        first = 1 + len(model.inputs) + len(model.outputs)
        macros += f"#define FIRST_LAG_PARAMETER {first + fields.index('lag_a')}\n"
    if model.find_event_times:
        macros += f"#define N_TIME_EVENTS {len(model.find_event_times(parameters))}\n"
    input_names = ", ".join(f"INPUT_{v.name.upper()}" for v in model.inputs)
    if memory:
        macros += f"#define N_HISTORY {memory}\n"
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


def variables_c(model: Model) -> str:
    """Text of variables.c: variables with their intervals, and the inputs that each output depends on."""
    rows = [_row("time", "s", "time", Interval())]
    rows += [_row(v.name, v.unit, v.doc, v.interval) for v in model.inputs]
    rows += [_row(v.name, v.unit, v.doc, Interval()) for v in model.outputs]
    for name, item in model.parameter_fields().items():
        meta = item.metadata
        if "allowed" in meta:
            rows.append(_row(name, "1", meta["doc"], Interval.from_bounds(ge=0.0, le=1.0), boolean=True))
        else:
            rows.append(_row(name, meta["unit"], meta["doc"], meta["interval"], meta["whole"]))
    states = model.outputs[: model.state_count]
    links = [
        "{"
        + ", ".join(str(int(i.name in model.list_dependencies(o.name))) for i in (*model.inputs, *states))
        + "}"
        for o in model.outputs
    ]
    nominals = array("const double state_nominals[N_STATES]", [number(v.nominal) for v in states])
    return (
        '#include "variables.h"\n\n#include <math.h>\n\n'
        + array("const Variable variables[N_VALUES]", rows)
        + "\n"
        + array("const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS + N_STATES]", links)
        + (nominals if states else "")
    )


def _row(
    name: str,
    unit: str,
    doc: str,
    interval: Interval,
    whole: bool = False,
    boolean: bool = False,
) -> str:
    """C initializer of one variable."""
    flags = ", ".join(str(int(flag)) for flag in (interval.low_open, interval.high_open, whole, boolean))
    numbers = ", ".join(number(x) for x in (interval.low, interval.high))
    allowed = "" if boolean else str(interval)
    texts = ", ".join(string(x) for x in (name, "" if unit == "1" else unit, doc, allowed))
    return f"{{{texts}, {numbers}, {flags}}}"
