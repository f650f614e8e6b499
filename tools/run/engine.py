"""Evaluation of a joint: by the compiled library of its FMU, or by the Python law where there is none.

Both give the same numbers; the library needs some microseconds for what the Python law does in milliseconds.
"""

import ctypes
import shutil
import sys
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, build_parameter_set, flatten_parameters

if TYPE_CHECKING:
    from jointfmu_fmu_src.native.library import JointLibrary

_FMI3_ERROR_STATUS, _FMI3_WARNING_STATUS = 3, 1
"""Status of a log message in FMI 3.0."""
_LOG_CALLBACK_C_TYPE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
"""C type of the log callback of an FMI 3.0 instance."""
_POINTER_C_TYPE = ctypes.c_void_p
"""C type of the pointers of an instance."""
_ARRAY_SIZE_C_TYPE = ctypes.c_size_t
"""C type of array sizes."""


class LoadPathResult(NamedTuple):
    """Outputs of a joint along a path of its inputs.

    variable_columns  : {variable: values (n)}: all inputs, then all outputs [SI]
    validity_warnings : one line for each validity limit that the path exceeds
    """

    variable_columns: dict[str, Array]
    validity_warnings: tuple[str, ...]


class JointEngine(Protocol):
    """Protocol of a joint that can be evaluated along paths of its inputs.

    fmu_model : model of the joint's FMU, with its inputs and outputs
    """

    fmu_model: Model

    def set_parameters(self, parameter_values: Mapping[str, Any]) -> None:
        """Set parameters by structured name [SI]. They are checked at the next evaluation."""

    def evaluate_path(
        self, inputs: Mapping[str, ArrayLike], *, restart_at_each_point: bool = False
    ) -> LoadPathResult:
        """Evaluate the joint along a path that starts in the virgin state.

        inputs                : numbers or columns (n) [SI]; other inputs have their start values
        restart_at_each_point : every point is reached on a straight path of its own from the virgin state

        Raises ValueError, one line, for a value that the joint refuses.
        """


def open_joint(fmu_model: Model, parameter_file: ParameterFile) -> JointEngine:
    """Open a joint for evaluation, by its compiled library or, without library and compiler, in Python.

    Prints one line on standard error, once in a process, if it is evaluated in Python.

    Raises ValueError, one line, for parameters that the joint refuses.
    """
    fmu_model = fmu_model.with_parameters(parameter_file.joint, parameter_file.values)
    try:
        return CompiledJoint(fmu_model, parameter_file)
    except (ImportError, OSError, RuntimeError) as error:
        _announce_python_evaluation(" ".join(str(error).split()))
        return PythonJoint(fmu_model, parameter_file)


class ParametricJoint:
    """Joint that is evaluated with many parameter sets, for example by a fit or a study.

    Parameters that the FMU exposes are set in an open joint. For each combination of the other parameters
    the joint is opened anew; the last MAX_OPEN_JOINTS joints stay open.

    fmu_model      : FMU model of the joint, with its inputs and outputs
    parameter_file : parameters that `open_with_values` changes; None: those of the first call of
        `open_with_parameters`
    """

    MAX_OPEN_JOINTS = 4

    def __init__(self, fmu_model: Model, parameter_file: ParameterFile | None = None) -> None:
        self._model = fmu_model
        self._engines: dict[tuple[Any, ...], tuple[JointEngine, dict[str, Any]]] = {}
        self._set_parameter_file(parameter_file)

    def _set_parameter_file(self, parameter_file: ParameterFile | None) -> None:
        """Set the parameter file whose values are changed, and close the open joints."""
        self._file = parameter_file
        self._engines.clear()
        if parameter_file is not None:
            self._stated_values = parameter_file.values_by_name
            self._exposed = (
                self._model.with_parameters(parameter_file.joint, parameter_file.values)
                .parameter_fields()
                .keys()
            )

    def open_with_parameters(self, parameter_set: Any) -> JointEngine:
        """Open the joint with a parameter set. Engines returned before become invalid.

        Raises ValueError as `open_joint` and `JointEngine.evaluate_path`.
        """
        values = flatten_parameters(parameter_set)
        if (
            self._file is None
            or type(self._file.values) is not type(parameter_set)
            or self._stated_values.keys() != values.keys()
        ):
            self._set_parameter_file(ParameterFile(self._model.joint, "trial", parameter_set, {}, {}))
        return self.open_with_values(values)

    def open_with_values(self, parameter_values: Mapping[str, Any]) -> JointEngine:
        """Open the joint with parameter values {structured name: value [SI]} in place of those of its file.

        Engines returned before become invalid. Raises ValueError as `open_joint`.
        """
        stated, exposed = self._stated_values, self._exposed
        hidden = {k: v for k, v in parameter_values.items() if k not in exposed and v != stated[k]}
        engine, current = self._find_open_joint(hidden)
        needed = {
            k: parameter_values.get(k, stated[k]) for k in {*current, *parameter_values} if k in exposed
        }
        if changed := {k: v for k, v in needed.items() if current.get(k, stated[k]) != v}:
            current |= changed
            engine.set_parameters(changed)
        return engine

    def _find_open_joint(
        self, hidden_parameter_values: Mapping[str, Any]
    ) -> tuple[JointEngine, dict[str, Any]]:
        """Find an open joint by those of its parameters that the FMU does not expose, or open it.

        Returns the joint and its present values of exposed parameters.

        hidden_parameter_values : {name: value} of parameters that the FMU does not expose, if not as in the
            parameter file
        """
        key = tuple(sorted(hidden_parameter_values.items()))
        found = self._engines.pop(key, None)
        if found is None:
            assert self._file is not None
            file = (
                self._file.with_values(hidden_parameter_values, "user", "trial")
                if hidden_parameter_values
                else self._file
            )
            if len(self._engines) >= self.MAX_OPEN_JOINTS:
                del self._engines[next(iter(self._engines))]
            found = open_joint(self._model, file), {}
        self._engines[key] = found
        return found


@lru_cache(maxsize=1)
def _announce_python_evaluation(fallback_reason: str) -> None:
    """Print once, on standard error, that a joint is evaluated in Python, and why."""
    print(
        f"jointfmu: the joint is evaluated by its Python law, which is slow ({fallback_reason}); "
        "for the compiled joint: pip install 'jointfmu[build]'",
        file=sys.stderr,
    )


class LoadedFmuLibrary:
    """Instance of an FMU model in the loaded library of its FMU (FMI 3.0, co-simulation).

    fmu_model : inputs, outputs and parameters of the FMU

    Raises OSError if the library cannot be loaded, RuntimeError if it gives no instance.
    """

    def __init__(self, fmu_model: Model, joint_library: "JointLibrary") -> None:
        self.fmu_model = fmu_model
        self._messages: list[tuple[int, str]] = []
        self._lock = Lock()  # calls of the library release Python's own lock
        fields = fmu_model.parameter_fields()
        self._names = tuple(v.name for v in (*fmu_model.inputs, *fmu_model.outputs))
        self._references = {name: i for i, name in enumerate(["time", *self._names, *fields])}
        self._booleans = {name for name, item in fields.items() if "allowed" in item.metadata}
        messages = self._messages

        def store_log_message(
            environment: Any, fmi_status: int, message_category: bytes, message_text: bytes
        ) -> None:
            """Callback of the instance: store its log message."""
            messages.append((fmi_status, message_text.decode("utf-8", "replace")))

        self._logger = _LOG_CALLBACK_C_TYPE(store_log_message)
        folder = tempfile.mkdtemp(prefix="jointfmu-")
        try:
            path = Path(folder) / fmu_model.title
            path.write_bytes(joint_library.library_bytes)
            self._library = ctypes.CDLL(str(path))
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        self._declare_c_functions()
        instance = self._library.fmi3InstantiateCoSimulation(
            fmu_model.title.encode(), joint_library.instantiation_token.encode(), None,
            False, False, False, False, None, 0,
            None, self._logger, None,
        )  # fmt: skip
        self._instance = _POINTER_C_TYPE(instance)
        # The file stays as long as the library is loaded: another file may get its number on the disk, and
        # the loader would take it for this one.
        weakref.finalize(self, _unload_library, self._library, self._instance, self._logger, folder)
        if not instance:
            raise RuntimeError(
                self._messages[-1][1] if self._messages else "the compiled model cannot be instantiated"
            )

    def _declare_c_functions(self) -> None:
        """Declare argument types of the FMI functions of the loaded library, for ctypes."""
        lib = self._library
        lib.fmi3InstantiateCoSimulation.restype = _POINTER_C_TYPE
        lib.fmi3InstantiateCoSimulation.argtypes = [
            ctypes.c_char_p, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_bool, ctypes.c_bool, ctypes.c_bool,
            ctypes.c_bool, _POINTER_C_TYPE, _ARRAY_SIZE_C_TYPE, _POINTER_C_TYPE, _LOG_CALLBACK_C_TYPE,
            _POINTER_C_TYPE,
        ]  # fmt: skip
        for function in (lib.fmi3SetFloat64, lib.fmi3SetBoolean):
            function.argtypes = [
                _POINTER_C_TYPE,
                _POINTER_C_TYPE,
                _ARRAY_SIZE_C_TYPE,
                _POINTER_C_TYPE,
                _ARRAY_SIZE_C_TYPE,
            ]

    def set_parameters(self, parameter_values: Mapping[str, Any]) -> None:
        """Set parameters and other variables {name: SI value} of the FMU; ValueError if it rejects one."""
        for is_boolean, function, kind in (
            (False, self._library.fmi3SetFloat64, np.float64),
            (True, self._library.fmi3SetBoolean, np.bool_),
        ):
            names = [name for name in parameter_values if (name in self._booleans) == is_boolean]
            if names:
                references = self._list_value_references(names)
                numbers = np.array([parameter_values[name] for name in names], kind)
                if function(
                    self._instance, references.ctypes.data, len(names), numbers.ctypes.data, len(names)
                ):
                    raise ValueError(self._take_error_message())

    def _list_value_references(self, variable_names: Sequence[str]) -> Any:
        """Value references (FMI) of variables, as a C array."""
        return np.array([self._references[name] for name in variable_names], np.uint32)

    def _take_error_message(self) -> str:
        """Return the last error message of the instance, and clear all its messages."""
        text = next(
            (text for status, text in reversed(self._messages) if status >= _FMI3_ERROR_STATUS), "refused"
        )
        self._messages.clear()
        return text


class CompiledJoint(LoadedFmuLibrary):
    """Joint that is evaluated along paths of its inputs by the compiled library of its FMU.

    Raises ImportError if the library must be compiled and a package is missing, RuntimeError if the compiler
    fails or compiles for no such platform, OSError if the library cannot be loaded.
    """

    def __init__(self, fmu_model: Model, parameter_file: ParameterFile) -> None:
        from jointfmu_fmu_src.native.library import make_joint_library

        super().__init__(fmu_model, make_joint_library(fmu_model, parameter_file))
        inputs, outputs = [v.name for v in fmu_model.inputs], [v.name for v in fmu_model.outputs]
        self._input_references, self._output_references = map(self._list_value_references, (inputs, outputs))
        self._input_columns = {name: i for i, name in enumerate(inputs)}
        self._start_row = np.array([[float(parameter_file.start_value(name)) for name in inputs]])

    def _declare_c_functions(self) -> None:
        """Declare argument types of the library's function that evaluates a path, for ctypes."""
        super()._declare_c_functions()
        self._library.jointfmu_follow_path.restype = _ARRAY_SIZE_C_TYPE
        self._library.jointfmu_follow_path.argtypes = [
            _POINTER_C_TYPE, ctypes.c_bool, _ARRAY_SIZE_C_TYPE,
            _ARRAY_SIZE_C_TYPE, _POINTER_C_TYPE, _POINTER_C_TYPE,
            _ARRAY_SIZE_C_TYPE, _POINTER_C_TYPE, _POINTER_C_TYPE,
        ]  # fmt: skip

    def evaluate_path(
        self, inputs: Mapping[str, ArrayLike], *, restart_at_each_point: bool = False
    ) -> LoadPathResult:
        """Evaluate the joint along a path of inputs from rest, see `JointEngine.evaluate_path`."""
        sizes = {np.size(column) for column in inputs.values()} - {1}
        values = np.repeat(self._start_row, next(iter(sizes), 1), axis=0)
        for name, column in inputs.items():
            values[:, self._input_columns[name]] = column
        results = np.empty((len(values), len(self._output_references)))
        given, read = self._input_references, self._output_references
        with self._lock:
            self._messages.clear()
            done = self._library.jointfmu_follow_path(
                self._instance, restart_at_each_point, len(values),
                len(given), given.ctypes.data, values.ctypes.data,
                len(read), read.ctypes.data, results.ctypes.data,
            )  # fmt: skip
            if done < len(values):
                raise ValueError(self._take_error_message())
            texts = [text for status, text in self._messages if status == _FMI3_WARNING_STATUS]
            warnings = tuple(dict.fromkeys(texts))
        return LoadPathResult(dict(zip(self._names, (*values.T, *results.T), strict=True)), warnings)


def _unload_library(c_library: Any, instance_pointer: Any, log_callback: Any, library_folder: str) -> None:
    """Free the instance of a library, unload the library and remove its folder.

    log_callback : log callback of the instance; it must exist until the library is unloaded
    """
    import _ctypes

    if instance_pointer:
        c_library.fmi3FreeInstance(instance_pointer)
    if sys.platform == "win32":
        _ctypes.FreeLibrary(c_library._handle)
    else:
        _ctypes.dlclose(c_library._handle)
    shutil.rmtree(library_folder, ignore_errors=True)


class PythonJoint:
    """Joint that is evaluated along paths of its inputs in Python, without a compiled library."""

    def __init__(self, fmu_model: Model, parameter_file: ParameterFile) -> None:
        self.fmu_model = fmu_model
        self._parameter_class, self._values = type(parameter_file.values), dict(parameter_file.values_by_name)
        self._start_values = {v.name: parameter_file.start_value(v.name) for v in fmu_model.inputs}
        self._joint: Any = fmu_model.tabulate(parameter_file.values)

    def set_parameters(self, parameter_values: Mapping[str, Any]) -> None:
        """Set parameters by structured name [SI], see `JointEngine.set_parameters`."""
        self._values |= parameter_values
        self._joint = None

    def evaluate_path(
        self, inputs: Mapping[str, ArrayLike], *, restart_at_each_point: bool = False
    ) -> LoadPathResult:
        """Evaluate the joint along a path of inputs from rest, see `JointEngine.evaluate_path`."""
        if self._joint is None:
            self._joint = self.fmu_model.tabulate(build_parameter_set(self._parameter_class, self._values))
        model, joint = self.fmu_model, self._joint
        columns = self._start_values | {**inputs}
        arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, np.float64)) for x in columns.values()))
        points = [dict(zip(columns, map(float, point), strict=True)) for point in zip(*arrays, strict=True)]
        history = model.initial_history(joint) if model.initial_history else None
        rows = []
        for point in points:
            if model.advance is None or restart_at_each_point:
                outputs = model.evaluate(joint, point)
            else:
                outputs, history = model.advance(joint, point, history)
            rows.append(point | {name: float(value) for name, value in outputs.items()})
        found = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        texts = (text for row in rows for text in model.find_warnings(joint, row).values())
        return LoadPathResult(found, tuple(dict.fromkeys(texts)))
