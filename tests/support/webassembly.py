"""WebAssembly modules of the laboratory in a runtime, and native FMUs of the same parameter files."""

import zipfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import Field
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from conftest import here_alone
from jointfmu_fmu_src.native.compiled.binary import fill_library_placeholders
from jointfmu_fmu_src.native.compiled.compiled_models import get_compiled_model
from jointfmu_fmu_src.native.compiled.compiler import make_library_file_name
from jointfmu_fmu_src.native.data import make_fmu_data_struct, make_placeholder_data_struct, split_parameters
from jointfmu_fmu_src.native.description import format_fmi3_description
from jointfmu_tools.pages.laboratory.describe import PageModule

from jointfmu.parameters import ParameterFile
from jointfmu.quantity import build_parameter_set as make
from jointfmu.quantity import flatten_parameters


def native_fmu(module: PageModule, folder: Path) -> Path:
    """FMI 3.0 FMU for the first parameter file of a module, for this machine only."""
    name, file, here = module.fmu_model.name, module.parameter_files[0], fmpy.platform_tuple
    given = split_parameters(module.fmu_model, file)
    with here_alone("3"):
        part = get_compiled_model(module.fmu_model, file, given)
    data = make_fmu_data_struct(module.fmu_model, file, given, part.source_texts)
    library = fill_library_placeholders(
        part.libraries_by_fmi_version["3"][here],
        make_placeholder_data_struct(module.fmu_model, given),
        data,
        name,
    )
    folder.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(folder / f"{name}.fmu", "w") as archive:
        archive.writestr(
            "modelDescription.xml",
            format_fmi3_description(module.fmu_model, file, data.instantiation_token, "tunable"),
        )
        archive.writestr(f"binaries/{here}/{make_library_file_name(name, here)}", library)
    return folder / f"{name}.fmu"


class Instance:
    """Instance of a module in wasmtime, with the methods of `conftest.Fmu`."""

    def __init__(self, module: PageModule, binary: bytes, file: ParameterFile | None = None) -> None:
        """file : parameter file whose hidden numbers are in the data; None: those of the module"""
        import wasmtime

        self.store = wasmtime.Store()
        compiled = wasmtime.Module(self.store.engine, binary)
        self.exports = wasmtime.Instance(self.store, compiled, []).exports(self.store)
        self("_initialize")
        fixed = np.array(
            [
                *split_parameters(
                    module.fmu_model, file or module.parameter_files[0]
                ).data_struct_values.values()
            ]
        )
        self.exports["memory"].write(self.store, fixed.tobytes(), self("lab_hidden_parameters"))
        self.it = self("lab_create")
        model = module.fmu_model
        self.outputs = [v.name for v in model.outputs]
        names = [*(v.name for v in model.inputs), *self.outputs, *model.parameter_fields()]
        self.references = {name: i for i, name in enumerate(names, start=1)}

    def __call__(self, function: str, *arguments: Any) -> Any:
        return self.exports[function](self.store, *arguments)

    def start(self, values: Mapping[str, Any]) -> bool:
        """Start in the virgin state with parameters and inputs; returns whether they are accepted."""
        self("lab_reset", self.it)
        self.set(values)
        return self("lab_initialize", self.it) == 0

    def set(self, values: Mapping[str, Any]) -> None:
        for name, value in values.items():
            self("lab_set", self.it, self.references[name], float(value))

    def step(self) -> bool:
        return self("lab_step", self.it, 1.0) == 0

    def get(self) -> dict[str, float]:
        return {name: self("lab_get", self.it, self.references[name]) for name in self.outputs}

    def derivative(self, output: str, known: str) -> float:
        return self("lab_derivative", self.it, self.references[output], self.references[known])

    def map(self) -> Any:
        """Rows (n, 4) of the pressure map: x, y, share and value."""
        at, memory = self("lab_map", self.it), self.exports["memory"]
        n = self("lab_map_size")
        return np.frombuffer(memory.read(self.store, at, at + 32 * n)).reshape(n, 4)

    @property
    def said(self) -> list[str]:
        """Messages since the last call."""
        at, memory = self("lab_take_messages"), self.exports["memory"]
        return bytes(memory.read(self.store, at, at + 768)).split(b"\0")[0].decode().splitlines()


def random_values(module: PageModule, rng: np.random.Generator, switched: bool) -> dict[str, Any]:
    """Random parameters near the parameters of the first file, inside their intervals and limits; with
    Booleans if `switched`."""
    values = module.parameter_files[0].values
    while True:
        found = _drawn(module, rng, switched)
        with suppress(ValueError):
            make(type(values), flatten_parameters(values) | found)
            return found


def refused_values(module: PageModule, rng: np.random.Generator) -> dict[str, Any]:
    """Random parameters with one number on the wrong side of its interval."""
    fields = module.fmu_model.parameter_fields()
    bounded = [name for name, item in fields.items() if np.isfinite(_ends(item)[0])]
    name = str(rng.choice(bounded))
    return random_values(module, rng, False) | {name: _ends(fields[name])[0] - rng.uniform(0.1, 1.0)}


def _ends(item: Field[Any]) -> tuple[float, float]:
    """Ends of the interval of a parameter; none for a Boolean."""
    interval = item.metadata.get("interval")
    return (interval.low, interval.high) if interval else (-np.inf, np.inf)


def _drawn(module: PageModule, rng: np.random.Generator, switched: bool) -> dict[str, Any]:
    found: dict[str, Any] = {}
    flat = module.parameter_files[0].values_by_name
    for name, item in module.fmu_model.parameter_fields().items():
        value, (low, high) = flat[name], _ends(item)
        width = 0.02 * (high - low)
        if isinstance(value, bool):
            found[name] = bool(rng.integers(2)) if switched else value
        elif item.metadata["whole"]:
            found[name] = value
        elif np.isfinite(width):
            found[name] = float(rng.uniform(max(low, value - width), min(high, value + width)))
        else:
            found[name] = float(value * np.exp(rng.normal(0.0, 0.15)))
    return found
