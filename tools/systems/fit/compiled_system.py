"""Compiled system: the equations and the implicit step of the system's FMU in a library, for simulations."""

import ctypes
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from jointfmu_fmu_src.joint_parts.data import NO_DATA_TABLES, ParameterSplit
from jointfmu_fmu_src.native.compiled.compiler import compile_libraries, select_source_files
from jointfmu_fmu_src.native.data import make_placeholder_data_struct
from jointfmu_fmu_src.native.library import JointLibrary, find_machine_platform

from jointfmu.progress import set_status_text
from jointfmu.quantity import Array

from ...run.engine import LoadedFmuLibrary
from ..fmu.code import generate_sources
from ..fmu.model import SystemModel

SIMULATION_TOLERANCE = 1e-7
"""Relative tolerance of a simulation [1]: its error must not disturb the numerical derivatives of a fit."""


class CompiledSystem(LoadedFmuLibrary):
    """Compiled simulation of a system. Parameters, start values and inputs are set in each run.

    The library does not depend on the values of exposed parameters. The compiler (zig) caches the library.

    Raises ImportError if a package is missing, RuntimeError if the compiler fails or does not support this
    platform, OSError if the library cannot be loaded, ValueError if the system is too large.
    """

    def __init__(self, system_model: SystemModel) -> None:
        set_status_text(f"compile {system_model.name}")
        model, platform = system_model.make_fmu_model(), find_machine_platform()
        split = ParameterSplit([*model.parameter_fields()], {}, {}, model.parameter_class, NO_DATA_TABLES)
        data, program = make_placeholder_data_struct(model, split), Path(__file__).with_name("simulation.c")
        sources = generate_sources(system_model) | {
            "data.h": data.make_c_header(),
            "data.c": data.make_c_source(),
            program.name: program.read_text(encoding="utf-8"),
        }
        names = select_source_files(sorted(sources), "3")
        libraries = compile_libraries(model.title, sources, names, (platform,))
        super().__init__(model, JointLibrary(libraries[platform], data.instantiation_token))
        parameters = system_model.make_system_parameter_file(model)
        self._start_values = {name: parameters.values_by_name[name] for name in model.parameter_fields()}
        self._start_values |= {v.name: parameters.start_value(v.name) for v in model.inputs}

    def _declare_c_functions(self) -> None:
        """Declare argument types of the C function that simulates the system."""
        super()._declare_c_functions()
        lib, pointer, size = self._library, ctypes.c_void_p, ctypes.c_size_t
        lib.fmi3Reset.argtypes = lib.fmi3ExitInitializationMode.argtypes = [pointer]
        lib.fmi3EnterInitializationMode.argtypes = [
            pointer, ctypes.c_bool, ctypes.c_double, ctypes.c_double, ctypes.c_bool, ctypes.c_double
        ]  # fmt: skip
        lib.jointfmu_simulate.restype = size
        lib.jointfmu_simulate.argtypes = [
            pointer, size, pointer, size, pointer, pointer, size, pointer, pointer
        ]  # fmt: skip

    def simulate(
        self,
        value_by_name: Mapping[str, float],
        output_times: Array,
        input_values: Mapping[str, Array],
        output_names: Sequence[str],
        step_tolerance: float = SIMULATION_TOLERANCE,
    ) -> Array:
        """Simulate the system; returns the outputs (n, outputs) [SI] at the times.

        value_by_name  : {parameter, or state with a start value: SI value} that differ from the system
        output_times   : (n) [s], increasing
        input_values   : {input: values (n) [SI]}, linear between the times; other inputs keep their start
            values
        step_tolerance : relative tolerance of a step [1]

        Raises ValueError with one line if a value is refused or the motion cannot be computed.
        """
        rows, results = (
            np.column_stack([output_times, *input_values.values()])[:, 1:].copy(),
            np.empty((len(output_times), len(output_names))),
        )
        output_times = np.ascontiguousarray(output_times, dtype=np.float64)
        played, read = self._list_value_references([*input_values]), self._list_value_references(output_names)
        first = {name: float(column[0]) for name, column in input_values.items()}
        states = {name: value for name, value in value_by_name.items() if name not in self._start_values}
        parameters = {name: value for name, value in value_by_name.items() if name in self._start_values}
        lib, instance = self._library, self._instance
        with self._lock:
            self._messages.clear()
            lib.fmi3Reset(instance)
            self.set_parameters(self._start_values | first | parameters)
            lib.fmi3EnterInitializationMode(instance, True, step_tolerance, output_times[0], False, 0.0)
            self.set_parameters(states)
            if lib.fmi3ExitInitializationMode(instance):
                raise ValueError(self._take_error_message())
            done = lib.jointfmu_simulate(
                instance, len(output_times), output_times.ctypes.data, len(played), played.ctypes.data,
                rows.ctypes.data, len(read), read.ctypes.data, results.ctypes.data,
            )  # fmt: skip
            if done < len(output_times):
                raise ValueError(self._take_error_message())
        return results
