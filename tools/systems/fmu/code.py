"""C code of a system: code of each component with prefixed names, and tables of the connections."""

import re
from collections.abc import Mapping
from itertools import count
from pathlib import Path
from typing import NamedTuple

from jointfmu_fmu_src.joint_parts.c_text import format_array_definition, format_string_literal
from jointfmu_fmu_src.native.code.elementary import make_tables_header
from jointfmu_fmu_src.native.code.generate import (
    RUNTIME_FOLDER,
    format_variables_c,
    generate_sources_without_data,
    list_runtime_files,
    load_native_definition,
)
from jointfmu_fmu_src.native.data import make_data_struct, split_parameters

from .model import SystemComponent, SystemModel, full_name

_COMMON_C_FILES = list_runtime_files(("elementary",))
"""C files that all components of a system share."""
_SHARED_FILE_STEMS = {path.stem for path in _COMMON_C_FILES} - {"joint", "variables"} | {"elementary_tables"}
"""File names, without suffix, of the C files that all components share."""
_JOINT_C_FUNCTIONS = (
    "size",
    "free_tables",
    "tabulate",
    "evaluate",
    "derivative",
    "find_warnings",
    "describe_warning",
)
"""C functions that each component defines, under names with its prefix."""
_C_DEFINITION_PATTERN = re.compile(
    r"^(?!static|typedef|extern|enum|return|else)[A-Za-z_][\w *]*?\b(\w+)(?:\[.*)?(?:\(| = \{)", re.M
)
"""Pattern of the definition of an external name in C."""
_DATA_MEMBER_PATTERN = re.compile(r'(?<!")\bdata\.[a-z]')
"""Pattern of C that reads a member of the object `data`, which is the data of one component."""
_MAX_WARNINGS_PER_FMU = 32
"""Largest number of warnings in one FMU [1]: bits of the flags of logged warnings."""


class _ComponentCode(NamedTuple):
    """C source code of a component of a system; components with the same code share it.

    text_by_file_name : {file name: text} of all files except data.c
    data_source_texts : texts of data.c of the components that share the files
    has_fixed_data    : whether the files read the object `data`; otherwise the data are only the argument
        `joint_data` of `joint_tabulate`, and components with other data share the files
    """

    text_by_file_name: dict[str, str]
    data_source_texts: list[str]
    has_fixed_data: bool

    def is_shared_with(self, other_code: "_ComponentCode") -> bool:
        """Whether this code can also be used for the component that `other_code` was generated for."""
        return self.text_by_file_name == other_code.text_by_file_name and (
            not self.has_fixed_data or self.data_source_texts == other_code.data_source_texts
        )


def generate_sources(system_model: SystemModel) -> dict[str, str]:
    """{file name: text} of all C sources of a system except data.h and data.c."""
    model = system_model.make_fmu_model()
    code_by_prefix: dict[str, _ComponentCode] = {}
    prefixes, data_names = {}, {}
    for component in system_model.components:
        code = _generate_component_code(component)
        prefix = next((p for p, known in code_by_prefix.items() if known.is_shared_with(code)), None)
        if prefix is None:
            candidates = (_append_index_to_name(component.fmu_model.name, k) + "_" for k in count())
            prefix = next(p for p in candidates if p not in code_by_prefix)
            code_by_prefix[prefix] = code
        known_sources = code_by_prefix[prefix].data_source_texts
        if code.data_source_texts[0] not in known_sources:
            known_sources += code.data_source_texts
        prefixes[component.name] = prefix
        index = known_sources.index(code.data_source_texts[0])
        data_names[component.name] = prefix + _append_index_to_name("data", index)
    files = {
        path.name: path.read_text(encoding="utf-8")
        for path in (*_COMMON_C_FILES, *Path(__file__).parent.glob("*.[ch]"))
    }
    files |= {"elementary_tables.h": make_tables_header(), "variables.c": format_variables_c(model)}
    files |= {
        "model.h": _format_model_header(system_model),
        "components.c": _format_components_c(system_model, prefixes, data_names),
    }
    for prefix, code in code_by_prefix.items():
        files |= _prefix_external_names(prefix, code)
    return dict(sorted(files.items()))


def _generate_component_code(component: SystemComponent) -> _ComponentCode:
    """C of a component, without the FMI functions and the runtime of the system."""
    parameter_split = split_parameters(component.fmu_model, component.parameter_file)
    value_count = (
        1
        + len(component.fmu_model.inputs)
        + len(component.fmu_model.outputs)
        + len(parameter_split.variable_names)
    )
    data = make_data_struct(
        "part",
        "",
        [0.0] * value_count,
        list(parameter_split.data_struct_values.values()),
        parameter_split.data_tables,
    )
    generated_files = generate_sources_without_data(
        component.fmu_model, component.parameter_file, parameter_split
    )
    files = {
        name: text
        for name, text in generated_files.items()
        if name.rpartition(".")[0] not in _SHARED_FILE_STEMS
    }
    has_fixed_data = any(_DATA_MEMBER_PATTERN.search(text) for text in files.values())
    return _ComponentCode(files | {"data.h": data.make_c_header()}, [data.make_c_source()], has_fixed_data)


def _append_index_to_name(base_name: str, object_index: int) -> str:
    """Name of an object by its index, so that names differ: NAME, NAME2, NAME3."""
    return f"{base_name}{object_index + 1}" if object_index else base_name


def _prefix_external_names(name_prefix: str, component_code: _ComponentCode) -> dict[str, str]:
    """Add a prefix to the names of C files of components, and to all external names that they define."""
    names = sorted(
        {
            "data",
            *(
                name
                for file, text in component_code.text_by_file_name.items()
                if file.endswith(".c")
                for name in _C_DEFINITION_PATTERN.findall(text)
            ),
        }
    )

    def add_prefix_to_includes(c_text: str) -> str:
        """Add the prefix to the names of included files of the component."""
        return re.sub(
            r'#include "(\w+)\.h"',
            lambda m: (
                m[0]
                if f"{m[1]}.h" not in component_code.text_by_file_name
                else f'#include "{name_prefix}{m[1]}.h"'
            ),
            c_text,
        )

    macros = "".join(f"#define {name} {name_prefix}{name}\n" for name in names)
    head = f'#include "{name_prefix}names.h"\n'
    prefixed_files = {f"{name_prefix}names.h": macros}
    for file, text in component_code.text_by_file_name.items():
        prefixed_text = add_prefix_to_includes(text)
        prefixed_files[name_prefix + file] = head + prefixed_text if file.endswith(".c") else prefixed_text
    for index, text in enumerate(component_code.data_source_texts):
        name = name_prefix + _append_index_to_name("data", index)
        prefixed_files[f"{name}.c"] = f"#define data {name}\n{add_prefix_to_includes(text)}"
    return prefixed_files


def _format_model_header(system_model: SystemModel) -> str:
    """Text of model.h: sizes of the system's model."""
    memory = sum(
        load_native_definition(p.fmu_model).history_layout.value_count for p in system_model.components
    )
    events = sum(_count_time_events(p) for p in system_model.components)
    wires = sum(len(p.fmu_model.inputs) + len(p.fmu_model.outputs) for p in system_model.components)
    counts = {
        "N_INPUTS": len(system_model.inputs),
        "N_OUTPUTS": len(system_model.outputs),
        "N_PARAMETERS": sum(len(p.exposed_parameters) for p in system_model.components),
        "N_COMPONENTS": len(system_model.components),
        "N_CONNECTIONS": wires,
        "N_COMPONENT_VALUES": wires + len(system_model.components),
    }
    states = sum(p.fmu_model.state_count for p in system_model.bodies)
    definitions: dict[str, float] = {"N_STATES": states, "IS_TIME_DEPENDENT": 1, "HAS_IMPLICIT_STEP": 1}
    definitions["DEFAULT_TOLERANCE"] = system_model.step_tolerance
    definitions |= {
        name: value for name, value in (("N_TIME_EVENTS", events), ("N_HISTORY", memory)) if value
    }
    macros = "".join(f"#define {name} {value}\n" for name, value in definitions.items())
    enumerators = ", ".join(f"{name} = {value}" for name, value in counts.items())
    body = f"{macros}\nenum {{ {enumerators} }};"
    return f"#ifndef JOINTFMU_MODEL_H\n#define JOINTFMU_MODEL_H\n\n{body}\n\n#endif\n"


def _count_time_events(component: SystemComponent) -> int:
    """Number of time events of a component, at which a load has a corner."""
    return (
        len(component.fmu_model.find_event_times(component.parameter_file.values))
        if component.fmu_model.find_event_times
        else 0
    )


def _count_motion_outputs(system_model: SystemModel, component: SystemComponent) -> int:
    """Number of leading outputs of a component on which the motion of the system depends.

    The last of them is the last acceleration of a body, or the last output that is the source of an input.
    """
    used = {feed for p in system_model.components for feed in p.source_by_input.values()}
    indices = [k for k, v in enumerate(component.fmu_model.outputs, 1) if (component.name, v.name) in used]
    return max([3 * component.degree_of_freedom_count, *indices])


def _format_components_c(
    system_model: SystemModel,
    prefix_by_component: Mapping[str, str],
    data_name_by_component: Mapping[str, str],
) -> str:
    """Text of components.c: functions, data, sizes and connections of the components of a system.

    prefix_by_component    : {component: prefix of its C functions}
    data_name_by_component : {component: name of its data in C}
    """
    first = 1 + len(system_model.inputs)
    reference = {p.full_name(v.name): k for k, (p, v) in enumerate(system_model.inputs, start=1)}
    reference |= {p.full_name(v.name): k for k, (p, v) in enumerate(system_model.outputs, start=first)}
    declared, rows, wires = [], list[str](), list[str]()
    offset = {"parameters": 0, "memory": 0, "row": 0, "wire": 0, "warnings": 0}
    for prefix in dict.fromkeys(prefix_by_component.values()):
        declared += _list_c_declarations(prefix)
    declared += [f"extern const Data {name};\n" for name in data_name_by_component.values()]
    for component in system_model.components:
        model, prefix = component.fmu_model, prefix_by_component[component.name]
        sources = [component.source_by_input.get(v.name, (component.name, v.name)) for v in model.inputs]
        wires += [str(reference[full_name(*feed)] if feed else 0) for feed in sources]
        wires += [str(reference[component.full_name(v.name)]) for v in model.outputs]
        events = _count_time_events(component)
        if events:
            declared.append(f"void {prefix}joint_event_times(Joint *joint, double *times);\n")
        functions = [f"{prefix}joint_{name}" for name in _JOINT_C_FUNCTIONS]
        functions.append(f"{prefix}joint_event_times" if events else "NULL")
        counts = [len(model.inputs), len(model.outputs), model.state_count, events]
        counts += [_count_motion_outputs(system_model, component), *offset.values()]
        names = [format_string_literal(component.name), f"&{data_name_by_component[component.name]}"]
        rows.append("{" + ", ".join([*names, *functions, *map(str, counts)]) + "}")
        inputs, outputs = len(model.inputs), len(model.outputs)
        offset["parameters"] += len(component.exposed_parameters)
        offset["memory"] += load_native_definition(model).history_layout.value_count
        offset["row"] += 1 + inputs + outputs
        offset["wire"] += inputs + outputs
        offset["warnings"] += len(model.validity_limits)
    if offset["warnings"] > _MAX_WARNINGS_PER_FMU:
        raise ValueError(
            f"{system_model.name}: its joints have {offset['warnings']} warnings; "
            f"allowed are {_MAX_WARNINGS_PER_FMU} in one FMU"
        )
    return (
        '#include "system.h"\n\n'
        + "".join(dict.fromkeys(declared))
        + "\n"
        + format_array_definition("const unsigned short connections[N_CONNECTIONS]", wires)
        + "\n"
        + format_array_definition("const Component components[N_COMPONENTS]", rows)
    )


def _list_c_declarations(name_prefix: str) -> list[str]:
    """C declarations of the functions that each component defines, with a prefix of their names."""
    text = (RUNTIME_FOLDER / "instance" / "joint.h").read_text(encoding="utf-8")
    declarations = []
    for name in _JOINT_C_FUNCTIONS:
        match = re.search(rf"^\w+ (joint_{name})\([^;]*;\n", text, re.M)
        assert match
        declarations.append(match[0].replace(match[1], name_prefix + match[1]))
    return declarations
