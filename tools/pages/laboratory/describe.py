"""Description of the laboratory's modules as JSON: variables, parameter sets, curves, published points."""

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import MISSING, dataclass
from pathlib import Path
from threading import Lock
from typing import Any

from jointfmu_fmu_src.native.compiled.compiled_models import get_cached_result
from jointfmu_fmu_src.native.compiled.compiler import compile_webassembly
from jointfmu_fmu_src.native.data import split_parameters
from jointfmu_fmu_src.native.page import find_load_ramp_panels
from jointfmu_fmu_src.xml_parts import ListedVariable, list_variables

from jointfmu.joints import KINDS
from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import Model
from jointfmu.parameters import (
    ParameterFile,
    declared_entries,
    format_parameter_file,
    is_combined_height,
    load_parameter_file,
)
from jointfmu.quantity import units
from jointfmu.quantity.interval import Interval

from ...common.joint_parts import load_tool_module
from ...common.shown import choose_display_unit
from ...run.ramps.loops import variable_suffix
from ...studies.published.computed import load_published_numbers
from ...studies.published.reference import POINT_ROLES, read_points
from .joint_additions import LaboratoryModel

_LABORATORY_SOURCE_NAME = "laboratory.c"
"""C file with the functions that the page calls."""
_CONTACT_MAP_SOURCE_NAME = "map.c"
"""C file of a joint for the map of the contact."""
_CODE_GENERATION_LOCK = Lock()
"""Lock for the generation of C code, which several threads must not do at once."""


@dataclass(frozen=True, slots=True)
class PageModule:
    """WebAssembly module of the page: a model, and the parameter files that share its C code.

    parameter_files : parameter files; the first one gives the start values
    """

    fmu_model: Model
    parameter_files: Sequence[ParameterFile]

    @property
    def contact_map_source(self) -> Path | None:
        """Path of the C source that computes the pressure map of the contact; None: the joint has no map.

        A joint has no map if it has no module `laboratory`. The file at the path need not exist.
        """
        module = load_tool_module(KINDS[self.fmu_model.joint], "laboratory")
        return Path(str(module.__file__)).with_name(_CONTACT_MAP_SOURCE_NAME) if module else None

    def collect_sources(self) -> dict[str, str]:
        """Collect all C sources of the module: {file name: text}.

        The sources are those of the FMU and of the functions that the page calls.
        """
        # imported here because it needs casadi, which pages of the report do not need
        from jointfmu_fmu_src.native.code.generate import generate_sources, read_instantiation_token

        files = generate_sources(self.fmu_model.name, self.parameter_files[0])
        return (
            files
            | self._list_page_function_sources()
            | {"token.h": f'#define TOKEN "{read_instantiation_token(files)}"\n'}
        )

    def compile_module(self) -> bytes:
        """Compile the module to WebAssembly (a WASI reactor without imports), or read it from the cache.

        The module exports the functions of laboratory.c. Raises ImportError if ziglang is missing,
        RuntimeError with the first error of the compiler.
        """
        return get_cached_result(
            f"{format_parameter_file(self.parameter_files[0])} {self._list_page_function_sources()}",
            self.fmu_model,
            self._compile_uncached,
        )

    def _list_page_function_sources(self) -> dict[str, str]:
        """C sources of the functions that the page calls: {file name: text}."""
        paths = [
            Path(__file__).with_name(_LABORATORY_SOURCE_NAME),
            *(
                [self.contact_map_source]
                if self.contact_map_source and self.contact_map_source.is_file()
                else []
            ),
        ]
        return {path.name: path.read_text(encoding="utf-8") for path in paths}

    def _compile_uncached(self) -> bytes:
        """Compile the module to WebAssembly."""
        with _CODE_GENERATION_LOCK:  # casadi is not thread-safe
            files = self.collect_sources()
        units = [name for name in files if name.endswith(".c") and not name.startswith("fmi")]
        return compile_webassembly(self.fmu_model.name, files, units)


def list_modules() -> list[PageModule]:
    """List the WebAssembly modules of all joints and shipped parameter files, in display order."""
    return [
        module
        for kind in KINDS.values()
        for model in kind.models
        for module in _group_files_by_c_code(kind, model)
    ]


def compile_modules(page_modules: Sequence[PageModule]) -> list[bytes]:
    """Compile the C code of the laboratory page's joints to WebAssembly in parallel; returns the binaries."""
    with ThreadPoolExecutor() as pool:
        return list(pool.map(PageModule.compile_module, page_modules))


def _group_files_by_c_code(joint_kind: JointKind, fmu_model: Model) -> Iterator[PageModule]:
    """Group the shipped parameter files of a joint into modules with the same C code.

    Files share the C code if they have the same law and the same values of all parameters that the FMU does
    not expose.
    """
    groups: dict[tuple[object, ...], list[ParameterFile]] = {}
    for file in _load_shipped_files(joint_kind):
        exposed = fmu_model.with_parameters(joint_kind.name, file.values).parameter_fields()
        fixed = tuple((name, value) for name, value in file.values_by_name.items() if name not in exposed)
        groups.setdefault((file.law, fixed), []).append(file)
    for files in groups.values():
        yield PageModule(fmu_model.with_parameters(joint_kind.name, files[0].values), files)


def _load_shipped_files(joint_kind: JointKind) -> list[ParameterFile]:
    """Load the shipped parameter files of a joint, the default file first."""
    default = joint_kind.default_file()
    return [
        load_parameter_file(path, joint_kind.name)
        for path in sorted(default.parent.glob("*.toml"), key=lambda p: p != default)
    ]


_INPUT_SLIDER_END_OVER_NOMINAL = 2.0
"""Largest value of an input's slider on the page, over the nominal value of the input [1]."""
_PARAMETER_SLIDER_END_OVER_START = 10.0
"""Factor between start value and both ends of a parameter's slider, if no interval is known [1]."""


def describe_module(page_module: PageModule) -> dict[str, object]:
    """Describe a module of the page as a JSON object: all of its content except the WebAssembly binary."""
    model, first = page_module.fmu_model, page_module.parameter_files[0]
    kind, bench = KINDS[model.joint], _load_page_additions(model)
    bound = set(_list_compiled_parameters(first))
    curves = (
        *find_load_ramp_panels(model),
        *bench.additional_panels,
    )  # the panels of the documentation come first
    rows = [
        _variable_to_json(v, model, bench) | {"bound": v.variable_name in bound}
        for v in list_variables(model, first)
    ]
    return {
        "name": model.name,
        "joint": kind.name,
        "title": kind.title,
        "law": first.law,
        "default": first.law == next(iter(kind.laws)),
        "entries": _entries_to_json(model, first),
        "fixed": list(split_parameters(model, first).data_struct_values),
        "height": next(filter(is_combined_height, first.values_by_name), None),
        "doc": model.doc,
        "variables": rows,
        "surfaces": [surface.parameter_prefix for surface in kind.surfaces],
        "sets": [_parameter_set_to_json(file, model) for file in page_module.parameter_files],
        "ramp": {"input": model.ramp.input_name, "end": model.ramp.end_value},
        "panels": [{"over": p.abscissa_variable, "quantities": list(p.ordinate_variables)} for p in curves],
        "pairs": pair_conjugate_variables(model),
        "path": list(bench.pointer_inputs or (model.ramp.input_name,)),
        "points": list(_list_published_points(model, bench)),
        "measured": [m._asdict() for m in bench.measured_curves],
        "map": _contact_map_to_json(bench, first),
        "turn": bench.transmission_view and bench.transmission_view._asdict(),
        "example": bench.example_values and bench.example_values._asdict(),
    }


def pair_conjugate_variables(fmu_model: Model) -> dict[str, str]:
    """Energy-conjugate pairs of inputs and outputs of a model: {input: output}.

    Their units are N and m, or N.m and rad, and their suffixes are equal (`f_x` and `s_rel_x`). If the input
    of the load ramp has no suffix, it is paired with the first output with a matching unit.
    """
    conjugates = {}
    for i in fmu_model.inputs:
        candidates = [o.name for o in fmu_model.outputs if {i.unit, o.unit} in ({"N", "m"}, {"N.m", "rad"})]
        same = [name for name in candidates if variable_suffix(name) == variable_suffix(i.name)]
        if same or (candidates and not variable_suffix(i.name) and i.name == fmu_model.ramp.input_name):
            conjugates[i.name] = (same or candidates)[0]
    return conjugates


def _load_page_additions(fmu_model: Model) -> LaboratoryModel:
    """Additions to the laboratory page of a model, from the module `laboratory` of its joint.

    A model for which the module defines no additions has a default `LaboratoryModel`.
    """
    module = load_tool_module(KINDS[fmu_model.joint], "laboratory")
    benches: dict[str, LaboratoryModel] = module.LABORATORY_MODELS if module else {}
    return benches.get(fmu_model.name, LaboratoryModel())


def _variable_to_json(
    listed_variable: ListedVariable, fmu_model: Model, laboratory_model: LaboratoryModel
) -> dict[str, object]:
    """JSON object of a variable of the model: name, unit, meaning, slider."""
    unit = listed_variable.xml_attributes.get("unit", "1")
    row: dict[str, object] = {
        "name": listed_variable.variable_name,
        "causality": listed_variable.causality,
        "doc": listed_variable.variable_description,
        "start": listed_variable.start_value,
        "boolean": listed_variable.is_boolean,
    }
    typical = float(listed_variable.xml_attributes.get("nominal", 0.0))
    if listed_variable.causality != "output":
        row |= {
            "low": _read_interval_end(listed_variable, "min"),
            "high": _read_interval_end(listed_variable, "max"),
        }
        field = fmu_model.parameter_fields().get(listed_variable.variable_name)
        row["whole"] = bool(field and field.metadata.get("whole"))
        row["span"] = span = laboratory_model.slider_spans.get(listed_variable.variable_name) or _slider_span(
            listed_variable, fmu_model, row
        )
        row["log"] = listed_variable.causality == "parameter" and span[0] > 0.0 and span[1] > 5.0 * span[0]
        typical = (
            span[1]
            if listed_variable.causality == "input" or not listed_variable.start_value
            else float(listed_variable.start_value)
        )
    shown = choose_display_unit(unit, typical)
    return row | {"unit": unit, "shown": shown, "factor": units.conversion_factor(unit, shown)}


def _read_interval_end(listed_variable: ListedVariable, attribute_name: str) -> float | None:
    """Lower or upper end of the interval in which an input is valid; None if it has none."""
    return (
        float(listed_variable.xml_attributes[attribute_name])
        if attribute_name in listed_variable.xml_attributes
        else None
    )


def _slider_span(
    listed_variable: ListedVariable, fmu_model: Model, variable_json: dict[str, Any]
) -> tuple[float, float]:
    """Lower and upper end of the slider of a variable on the page [SI]."""
    if listed_variable.is_boolean:
        return 0.0, 1.0
    start = float(listed_variable.start_value or 0.0)
    low = -math.inf if variable_json["low"] is None else variable_json["low"]
    high = math.inf if variable_json["high"] is None else variable_json["high"]
    if listed_variable.causality == "input":
        driven = {i.name: i.unit for i in fmu_model.inputs}[fmu_model.ramp.input_name]
        unit = listed_variable.xml_attributes["unit"]
        end = (
            fmu_model.ramp.end_value
            if unit == driven
            else _INPUT_SLIDER_END_OVER_NOMINAL * float(listed_variable.xml_attributes["nominal"])
        )
        return max(low, -end), end
    if start == 0.0:
        return 0.0, high if math.isfinite(high) else 1.0
    if abs(low) > 1e-300 and math.isfinite(high - low) and high - low <= 1.0 + abs(low):
        margin = 0.02 * (high - low)
        return max(low + margin, 0.0), high - margin
    if variable_json["whole"]:
        return low, 4.0 * start
    return max(start / _PARAMETER_SLIDER_END_OVER_START, low), min(
        start * _PARAMETER_SLIDER_END_OVER_START, high
    )


def _list_compiled_parameters(parameter_file: ParameterFile) -> Iterator[str]:
    """Yield the parameters that the page must not change: values compiled into the C code depend on them."""
    kind = KINDS[parameter_file.joint]
    for name, value in parameter_file.values_by_name.items():
        if isinstance(value, float):
            try:
                changed = parameter_file.with_values({name: value + 1.0}, "user", "").values
            except ValueError:
                continue
            if any(line.startswith(name) for line in kind.find_contradictions(changed)):
                yield name


def _entries_to_json(fmu_model: Model, parameter_file: ParameterFile) -> dict[str, dict[str, object]]:
    """JSON object of the entries of a parameter file: {structured name: {unit, value, default, interval}}.

    value    : value in the module's first file; roughnesses and start values of inputs have none
    default  : value if a file does not have the entry
    interval : lower and upper end, and whether they are open, of numbers that the C code does not check
    """
    exposed, flat, variables = (
        fmu_model.parameter_fields(),
        parameter_file.values_by_name,
        KINDS[fmu_model.joint].variables,
    )
    rows: dict[str, dict[str, object]] = {}
    for name, item in declared_entries(fmu_model.joint, type(parameter_file.values)).items():
        section, _, leaf = name.partition(".")
        if section not in ("inputs", "roughness", "comparison") and name not in flat:
            continue  # the entry belongs to another alternative of a group
        meta = item.metadata
        rows[name] = row = {"unit": meta.get("unit")}
        if name in flat:
            row["value"] = flat[name]
            if item.default is not MISSING:
                row["default"] = item.default
        elif section == "inputs":
            row["default"] = variables[leaf].start
        if "interval" in meta and name not in exposed and "series" not in meta:
            row["interval"] = _interval_to_json(meta["interval"])
    return rows


def _interval_to_json(value_interval: Interval) -> list[float | bool | None]:
    """JSON of an interval: lower end, upper end (None if infinite), whether each of them is excluded."""
    ends = [end if math.isfinite(end) else None for end in (value_interval.low, value_interval.high)]
    return [*ends, value_interval.low_open, value_interval.high_open]


def _parameter_set_to_json(parameter_file: ParameterFile, fmu_model: Model) -> dict[str, object]:
    """JSON object of a parameter file: values of exposed parameters, start values of inputs, TOML text."""
    names = fmu_model.parameter_fields()
    values = {name: value for name, value in parameter_file.values_by_name.items() if name in names}
    inputs = {v.name: parameter_file.start_value(v.name) for v in fmu_model.inputs}
    return {
        "name": parameter_file.name,
        "values": values,
        "fixed": {},
        "inputs": inputs,
        "toml": format_parameter_file(parameter_file),
    }


def _list_published_points(
    fmu_model: Model, laboratory_model: LaboratoryModel
) -> Iterator[dict[str, object]]:
    """JSON list of the published points that the page compares with the model."""
    outputs = {v.name: v for v in fmu_model.outputs}
    known = {v.name for v in fmu_model.inputs} | set(fmu_model.parameter_fields())
    for paper in load_published_numbers(KINDS[fmu_model.joint]).paper_names:
        for point in read_points(paper):
            shown = laboratory_model.published_points.get(point.quantity)
            if shown is None or not set(point.where) <= set(shown.variable_by_argument):
                continue
            at = {shown.variable_by_argument[name]: value for name, value in point.where.items()}
            if not set(at) <= known:  # the law does not have this parameter
                continue
            factor = units.conversion_factor(point.unit, outputs[shown.output_name].unit)
            yield {
                "id": f"{paper}: {point.id}",
                "place": point.place,
                "role": point.role,
                "doc": POINT_ROLES[point.role],
                "output": shown.output_name,
                "value": factor * float(point.value),
                "at": at,
            }


def _contact_map_to_json(
    laboratory_model: LaboratoryModel, parameter_file: ParameterFile
) -> dict[str, object] | None:
    """JSON object of the pressure map of the contact (unit, meaning, marks); None if there is no map."""
    picture = laboratory_model.contact_map
    if picture is None:
        return None
    marks, what = picture.compute_mark_positions(parameter_file.values)
    row = {
        "name": picture.quantity_name,
        "doc": picture.meaning,
        "shown": picture.display_unit,
        "marks": marks,
        "what": what,
    }
    return row | {"factor": units.conversion_factor(picture.si_unit, picture.display_unit)}
