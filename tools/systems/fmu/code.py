"""C code of a system: code of each component with prefixed names, and tables of the connections."""

import re
from collections.abc import Mapping
from pathlib import Path

from jointfmu_fmu_src.joint_parts.c_text import array, string
from jointfmu_fmu_src.native.code.elementary import tables
from jointfmu_fmu_src.native.code.generate import RUNTIME, code, native_part, runtime, variables_c
from jointfmu_fmu_src.native.data import block, split

from .model import SystemComponent, SystemModel

_COMMON = runtime(("elementary",))
_LAYERS = {path.stem for path in _COMMON} - {"joint", "variables"} | {"elementary_tables"}
"""Stems of files that all components share."""
_FUNCTIONS = ("size", "tabulate", "evaluate", "derivative", "find_warnings", "describe_warning")
_DEFINITION = re.compile(
    r"^(?!static|typedef|extern|enum|return|else)[A-Za-z_][\w *]*?\b(\w+)(?:\[.*)?(?:\(| = \{)", re.M
)
_WARNINGS = 32
"""Largest number of warnings in one FMU [1]: bits of the flags of logged warnings."""


def sources(assembly: SystemModel) -> dict[str, str]:
    """{file name: text} of all C sources of a system except data.h and data.c."""
    model = assembly.model()
    code_by_prefix: dict[str, dict[str, str]] = {}
    prefixes = {}
    for component in assembly.components:
        component_code = _component_code(component)
        equal = [prefix for prefix, known in code_by_prefix.items() if known == component_code]
        prefixes[component.name] = equal[0] if equal else f"p{len(code_by_prefix) + 1}_"
        code_by_prefix.setdefault(prefixes[component.name], component_code)
    files = {
        path.name: path.read_text(encoding="utf-8")
        for path in (*_COMMON, *Path(__file__).parent.glob("*.[ch]"))
    }
    files |= {"elementary_tables.h": tables(), "variables.c": variables_c(model)}
    files |= {"model.h": _header(assembly), "components.c": _components(assembly, prefixes)}
    for prefix, component_code in code_by_prefix.items():
        files |= _prefixed(prefix, component_code)
    return dict(sorted(files.items()))


def _component_code(component: SystemComponent) -> dict[str, str]:
    """{file name: text} of a component's C, without the FMI layer and the runtime of the system."""
    parameter_split = split(component.model, component.parameters)
    count = 1 + len(component.model.inputs) + len(component.model.outputs) + len(parameter_split.exposed)
    data = block("part", "", [0.0] * count, list(parameter_split.fixed.values()), parameter_split.tables)
    files = code(component.model, component.parameters, parameter_split)
    files |= {"data.h": data.header(), "data.c": data.source()}
    return {name: text for name, text in files.items() if name.rpartition(".")[0] not in _LAYERS}


def _prefixed(prefix: str, files: Mapping[str, str]) -> dict[str, str]:
    """Add a prefix to the names of C files, and to all external names that they define."""
    names = sorted(
        {name for file, text in files.items() if file.endswith(".c") for name in _DEFINITION.findall(text)}
    )
    macros = "".join(f"#define {name} {prefix}{name}\n" for name in names)
    head = f'#include "{prefix}names.h"\n'
    prefixed_files = {f"{prefix}names.h": macros}
    for file, text in files.items():
        prefixed_text = re.sub(
            r'#include "(\w+)\.h"',
            lambda m: m[0] if f"{m[1]}.h" not in files else f'#include "{prefix}{m[1]}.h"',
            text,
        )
        prefixed_files[prefix + file] = head + prefixed_text if file.endswith(".c") else prefixed_text
    return prefixed_files


def _header(assembly: SystemModel) -> str:
    """Text of model.h: sizes of the system."""
    memory = sum(native_part(p.model).memory.size for p in assembly.components)
    events = sum(_event_count(p) for p in assembly.components)
    wires = sum(len(p.model.inputs) + len(p.model.outputs) for p in assembly.components)
    counts = {
        "N_INPUTS": len(assembly.inputs),
        "N_OUTPUTS": len(assembly.outputs),
        "N_PARAMETERS": sum(len(p.exposed) for p in assembly.components),
        "N_COMPONENTS": len(assembly.components),
        "N_CONNECTIONS": wires,
        "N_COMPONENT_VALUES": wires + len(assembly.components),
    }
    definitions = {"N_STATES": 2 * len(assembly.bodies), "IS_TIME_DEPENDENT": 1, "HAS_IMPLICIT_STEP": 1}
    definitions |= {
        name: value for name, value in (("N_TIME_EVENTS", events), ("N_HISTORY", memory)) if value
    }
    macros = "".join(f"#define {name} {value}\n" for name, value in definitions.items())
    enumerators = ", ".join(f"{name} = {value}" for name, value in counts.items())
    body = f"{macros}\nenum {{ {enumerators} }};"
    return f"#ifndef JOINTFMU_MODEL_H\n#define JOINTFMU_MODEL_H\n\n{body}\n\n#endif\n"


def _event_count(component: SystemComponent) -> int:
    """Number of time events of a component."""
    return (
        len(component.model.find_event_times(component.parameters.values))
        if component.model.find_event_times
        else 0
    )


def _components(assembly: SystemModel, prefixes: Mapping[str, str]) -> str:
    """Text of components.c: functions, sizes and connections of the components."""
    first = 1 + len(assembly.inputs)
    reference = {f"{p.name}.{v.name}": k for k, (p, v) in enumerate(assembly.inputs, start=1)}
    reference |= {f"{p.name}.{v.name}": k for k, (p, v) in enumerate(assembly.outputs, start=first)}
    declared, rows, wires = [], list[str](), list[str]()
    offset = {"parameters": 0, "memory": 0, "row": 0, "wire": 0, "warnings": 0}
    for prefix in dict.fromkeys(prefixes.values()):
        declared += _declared(prefix)
    for component in assembly.components:
        model, prefix = component.model, prefixes[component.name]
        sources = [component.feeds.get(v.name, (component.name, v.name)) for v in model.inputs]
        wires += [str(reference[".".join(feed)] if feed else 0) for feed in sources]
        wires += [str(reference[f"{component.name}.{v.name}"]) for v in model.outputs]
        events = _event_count(component)
        if events:
            declared.append(f"void {prefix}joint_event_times(Joint *joint, double *times);\n")
        functions = [f"{prefix}joint_{name}" for name in _FUNCTIONS]
        functions.append(f"{prefix}joint_event_times" if events else "NULL")
        counts = [len(model.inputs), len(model.outputs), model.state_count, events, *offset.values()]
        rows.append("{" + ", ".join([string(component.name), *functions, *map(str, counts)]) + "}")
        inputs, outputs = len(model.inputs), len(model.outputs)
        offset["parameters"] += len(component.exposed)
        offset["memory"] += native_part(model).memory.size
        offset["row"] += 1 + inputs + outputs
        offset["wire"] += inputs + outputs
        offset["warnings"] += len(model.validity_limits)
    if offset["warnings"] > _WARNINGS:
        raise ValueError(
            f"{assembly.name}: its joints have {offset['warnings']} warnings; "
            f"allowed are {_WARNINGS} in one FMU"
        )
    return (
        '#include "system.h"\n\n'
        + "".join(dict.fromkeys(declared))
        + "\n"
        + array("const unsigned short connections[N_CONNECTIONS]", wires)
        + "\n"
        + array("const Component components[N_COMPONENTS]", rows)
    )


def _declared(prefix: str) -> list[str]:
    """C declarations of the functions of the components with a prefix."""
    text = (RUNTIME / "instance" / "joint.h").read_text(encoding="utf-8")
    declarations = []
    for name in _FUNCTIONS:
        match = re.search(rf"^\w+ (joint_{name})\([^;]*;\n", text, re.M)
        assert match
        declarations.append(match[0].replace(match[1], prefix + match[1]))
    return declarations
