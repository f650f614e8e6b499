"""C of a system: each component's own code with names of its own, and the tables that connect them."""

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
"""Files of which components have none of their own."""
_FUNCTIONS = ("size", "tabulate", "evaluate", "derivative", "outside", "warning")
_DEFINITION = re.compile(
    r"^(?!static|typedef|extern|enum|return|else)[A-Za-z_][\w *]*?\b(\w+)(?:\[.*)?(?:\(| = \{)", re.M
)
_WARNINGS = 32
"""Bits of what a host was warned of."""


def sources(assembly: SystemModel) -> dict[str, str]:
    """{file name: text} of all C but the data."""
    model = assembly.model()
    parts: dict[str, dict[str, str]] = {}  # by prefix
    prefixes = {}
    for part in assembly.components:
        own = _component_code(part)
        same = [prefix for prefix, known in parts.items() if known == own]
        prefixes[part.name] = same[0] if same else f"p{len(parts) + 1}_"
        parts.setdefault(prefixes[part.name], own)
    files = {
        path.name: path.read_text(encoding="utf-8")
        for path in (*_COMMON, *Path(__file__).parent.glob("*.[ch]"))
    }
    files |= {"elementary_tables.h": tables(), "variables.c": variables_c(model)}
    files |= {"model.h": _header(assembly), "components.c": _components(assembly, prefixes)}
    for prefix, own in parts.items():
        files |= _prefixed(prefix, own)
    return dict(sorted(files.items()))


def _component_code(component: SystemComponent) -> dict[str, str]:
    """The C of a component without the layers of FMI, which the system has."""
    given = split(component.model, component.parameters)
    count = 1 + len(component.model.inputs) + len(component.model.outputs) + len(given.exposed)
    own = block("part", "", [0.0] * count, list(given.fixed.values()), given.tables)
    files = code(component.model, component.parameters, given) | {
        "data.h": own.header(),
        "data.c": own.source(),
    }
    return {name: text for name, text in files.items() if name.rpartition(".")[0] not in _LAYERS}


def _prefixed(prefix: str, files: Mapping[str, str]) -> dict[str, str]:
    """The same files with a prefix before their names, and before what they define for each other."""
    names = sorted(
        {name for file, text in files.items() if file.endswith(".c") for name in _DEFINITION.findall(text)}
    )
    defined = "".join(f"#define {name} {prefix}{name}\n" for name in names)
    head = f'#include "{prefix}names.h"\n'
    found = {f"{prefix}names.h": defined}
    for file, text in files.items():
        own = re.sub(
            r'#include "(\w+)\.h"',
            lambda m: m[0] if f"{m[1]}.h" not in files else f'#include "{prefix}{m[1]}.h"',
            text,
        )
        found[prefix + file] = head + own if file.endswith(".c") else own
    return found


def _header(assembly: SystemModel) -> str:
    memory = sum(native_part(p.model).memory.size for p in assembly.components)
    events = sum(_event_count(p) for p in assembly.components)
    wires = sum(len(p.model.inputs) + len(p.model.outputs) for p in assembly.components)
    counts = {
        "N_INPUTS": len(assembly.inputs),
        "N_OUTPUTS": len(assembly.outputs),
        "N_PARAMETERS": sum(len(p.exposed) for p in assembly.components),
        "N_COMPONENTS": len(assembly.components),
        "N_WIRES": wires,
        "N_ROWS": wires + len(assembly.components),
    }
    defined = {"N_STATES": 2 * len(assembly.bodies), "MOVES": 1, "IMPLICIT": 1}
    defined |= {name: value for name, value in (("N_EVENTS", events), ("N_MEMORY", memory)) if value}
    macros = "".join(f"#define {name} {value}\n" for name, value in defined.items())
    listed = ", ".join(f"{name} = {value}" for name, value in counts.items())
    return f"#ifndef JOINTFMU_MODEL_H\n#define JOINTFMU_MODEL_H\n\n{macros}\nenum {{ {listed} }};\n\n#endif\n"


def _event_count(component: SystemComponent) -> int:
    return (
        len(component.model.find_event_times(component.parameters.values))
        if component.model.find_event_times
        else 0
    )


def _components(assembly: SystemModel, prefixes: Mapping[str, str]) -> str:
    """components.c."""
    first = 1 + len(assembly.inputs)
    reference = {f"{p.name}.{v.name}": k for k, (p, v) in enumerate(assembly.inputs, start=1)}
    reference |= {f"{p.name}.{v.name}": k for k, (p, v) in enumerate(assembly.outputs, start=first)}
    declared, rows, wires = [], list[str](), list[str]()
    place = {"parameters": 0, "memory": 0, "row": 0, "wire": 0, "warnings": 0}
    for prefix in dict.fromkeys(prefixes.values()):
        declared += _declared(prefix)
    for part in assembly.components:
        model, prefix = part.model, prefixes[part.name]
        fed = [part.feeds.get(v.name, (part.name, v.name)) for v in model.inputs]
        wires += [str(reference[".".join(feed)] if feed else 0) for feed in fed]
        wires += [str(reference[f"{part.name}.{v.name}"]) for v in model.outputs]
        events = _event_count(part)
        if events:
            declared.append(f"void {prefix}joint_events(Joint *joint, double *times);\n")
        functions = [f"{prefix}joint_{name}" for name in _FUNCTIONS]
        functions.append(f"{prefix}joint_events" if events else "NULL")
        counts = [len(model.inputs), len(model.outputs), model.state_count, events, *place.values()]
        rows.append("{" + ", ".join([string(part.name), *functions, *map(str, counts)]) + "}")
        inputs, outputs = len(model.inputs), len(model.outputs)
        place["parameters"] += len(part.exposed)
        place["memory"] += native_part(model).memory.size
        place["row"] += 1 + inputs + outputs
        place["wire"] += inputs + outputs
        place["warnings"] += len(model.validity_limits)
    if place["warnings"] > _WARNINGS:
        raise ValueError(
            f"{assembly.name}: its joints have {place['warnings']} warnings; "
            f"allowed are {_WARNINGS} in one FMU"
        )
    return (
        '#include "system.h"\n\n'
        + "".join(dict.fromkeys(declared))
        + "\n"
        + array("const unsigned short wires[N_WIRES]", wires)
        + "\n"
        + array("const Component components[N_COMPONENTS]", rows)
    )


def _declared(prefix: str) -> list[str]:
    text = (RUNTIME / "instance" / "joint.h").read_text(encoding="utf-8")
    found = []
    for name in _FUNCTIONS:
        match = re.search(rf"^\w+ (joint_{name})\([^;]*;\n", text, re.M)
        assert match
        found.append(match[0].replace(match[1], prefix + match[1]))
    return found
