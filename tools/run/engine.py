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

_ERROR_STATUS, _WARNING_STATUS = 3, 1
"""Status of a log message in FMI 3.0."""
_LOGGER_TYPE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
"""C type of the log callback of an FMI 3.0 instance."""
_POINTER_TYPE = ctypes.c_void_p
"""C type of the pointers of an instance."""
_SIZE_TYPE = ctypes.c_size_t
"""C type of array sizes."""


class PathResult(NamedTuple):
    """Outputs along a path of inputs.

    columns  : {variable: values (n)}: all inputs, then all outputs [SI]
    warnings : one line for each validity limit that the path exceeds
    """

    columns: dict[str, Array]
    warnings: tuple[str, ...]


class JointEngine(Protocol):
    """Interface of a joint that can be evaluated along paths of its inputs.

    model : inputs and outputs of the joint
    """

    model: Model

    def set_parameters(self, values: Mapping[str, Any]) -> None:
        """Set parameters by structured name [SI]. They are checked at the next evaluation."""

    def follow(self, inputs: Mapping[str, ArrayLike], *, each_from_rest: bool = False) -> PathResult:
        """Evaluate the joint along a path that starts in the virgin state.

        inputs         : numbers or columns (n) [SI]; other inputs have their start values
        each_from_rest : every point is reached on a straight path of its own from the virgin state

        Raises ValueError, one line, for a value that the joint refuses.
        """


def open_joint(model: Model, parameter_file: ParameterFile) -> JointEngine:
    """Open a joint for evaluation: by its compiled library if there is one or a compiler, else by Python.

    Prints one line on standard error, once in a process, if it is evaluated in Python.

    Raises ValueError, one line, for parameters that the joint refuses.
    """
    model = model.with_parameters(parameter_file.joint, parameter_file.values)
    try:
        return CompiledJoint(model, parameter_file)
    except (ImportError, OSError, RuntimeError) as error:
        _announce_python_evaluation(" ".join(str(error).split()))
        return PythonJoint(model, parameter_file)


class VariableJoint:
    """Joint that is evaluated with many parameter sets, for example by a fit or a study.

    Parameters that the FMU exposes are set in the open joint. For other values of the remaining parameters
    the joint is opened again; the last MAX_OPEN_JOINTS stay open.

    model          : inputs and outputs of the joint
    parameter_file : parameters that `with_values` changes; None: those of the first call of `with_parameters`
    """

    MAX_OPEN_JOINTS = 4

    def __init__(self, model: Model, parameter_file: ParameterFile | None = None) -> None:
        self._model = model
        self._engines: dict[tuple[Any, ...], tuple[JointEngine, dict[str, Any]]] = {}
        self._set_file(parameter_file)

    def _set_file(self, parameter_file: ParameterFile | None) -> None:
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

    def with_parameters(self, parameters: Any) -> JointEngine:
        """Return an engine of the joint with a parameter set. Engines returned before become invalid.

        Raises ValueError as `open_joint` and `JointEngine.follow`.
        """
        values = flatten_parameters(parameters)
        if (
            self._file is None
            or type(self._file.values) is not type(parameters)
            or self._stated_values.keys() != values.keys()
        ):
            self._set_file(ParameterFile(self._model.joint, "trial", parameters, {}, {}))
        return self.with_values(values)

    def with_values(self, values: Mapping[str, Any]) -> JointEngine:
        """Evaluation of the joint with values {structured name: value [SI]} in place of its file's.

        An engine that was returned before must not be used any more. Raises ValueError as `open_joint`.
        """
        stated, exposed = self._stated_values, self._exposed
        hidden = {k: v for k, v in values.items() if k not in exposed and v != stated[k]}
        engine, current = self._find_engine(hidden)
        needed = {k: values.get(k, stated[k]) for k in {*current, *values} if k in exposed}
        if changed := {k: v for k, v in needed.items() if current.get(k, stated[k]) != v}:
            current |= changed
            engine.set_parameters(changed)
        return engine

    def _find_engine(self, hidden_values: Mapping[str, Any]) -> tuple[JointEngine, dict[str, Any]]:
        """Find the engine with these hidden parameters, or open it; returns also its exposed parameters.

        hidden_values : {name: value} of parameters that the FMU does not expose
        """
        key = tuple(sorted(hidden_values.items()))
        found = self._engines.pop(key, None)
        if found is None:
            assert self._file is not None
            file = self._file.with_values(hidden_values, "user", "trial") if hidden_values else self._file
            if len(self._engines) >= self.MAX_OPEN_JOINTS:
                del self._engines[next(iter(self._engines))]
            found = open_joint(self._model, file), {}
        self._engines[key] = found
        return found


@lru_cache(maxsize=1)
def _announce_python_evaluation(reason: str) -> None:
    """Print once, on standard error, that a joint is evaluated in Python, and why."""
    print(
        f"jointfmu: the joint is evaluated by its Python law, which is slow ({reason}); "
        "for the compiled joint: pip install 'jointfmu[build]'",
        file=sys.stderr,
    )


class LoadedLibrary:
    """Instance of a model in the loaded library of its FMU (FMI 3.0, co-simulation).

    model : its inputs, outputs and parameters

    Raises OSError if the library cannot be loaded, RuntimeError if it gives no instance.
    """

    def __init__(self, model: Model, library: "JointLibrary") -> None:
        self.model = model
        self._messages: list[tuple[int, str]] = []
        self._lock = Lock()  # calls of the library release Python's own lock
        fields = model.parameter_fields()
        self._names = tuple(v.name for v in (*model.inputs, *model.outputs))
        self._references = {name: i for i, name in enumerate(["time", *self._names, *fields])}
        self._booleans = {name for name, item in fields.items() if "allowed" in item.metadata}
        messages = self._messages

        def log(environment: Any, status: int, message_category: bytes, message: bytes) -> None:
            """Callback of the instance: store its log message."""
            messages.append((status, message.decode("utf-8", "replace")))

        self._logger = _LOGGER_TYPE(log)
        folder = tempfile.mkdtemp(prefix="jointfmu-")
        try:
            path = Path(folder) / model.title
            path.write_bytes(library.content)
            self._library = ctypes.CDLL(str(path))
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        self._declare_functions()
        instance = self._library.fmi3InstantiateCoSimulation(
            model.title.encode(), library.token.encode(), None, False, False, False, False, None, 0, None,
            self._logger, None,
        )  # fmt: skip
        self._instance = _POINTER_TYPE(instance)
        # The file stays as long as the library is loaded: another file may get its number on the disk, and
        # the loader would take it for this one.
        weakref.finalize(self, _close_library, self._library, self._instance, self._logger, folder)
        if not instance:
            raise RuntimeError(self._messages[-1][1] if self._messages else "no instance of the library")

    def _declare_functions(self) -> None:
        """Declare argument types of the C functions of the library."""
        lib = self._library
        lib.fmi3InstantiateCoSimulation.restype = _POINTER_TYPE
        lib.fmi3InstantiateCoSimulation.argtypes = [
            ctypes.c_char_p, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_bool, ctypes.c_bool, ctypes.c_bool,
            ctypes.c_bool, _POINTER_TYPE, _SIZE_TYPE, _POINTER_TYPE, _LOGGER_TYPE, _POINTER_TYPE,
        ]  # fmt: skip
        for function in (lib.fmi3SetFloat64, lib.fmi3SetBoolean):
            function.argtypes = [_POINTER_TYPE, _POINTER_TYPE, _SIZE_TYPE, _POINTER_TYPE, _SIZE_TYPE]

    def set_parameters(self, values: Mapping[str, Any]) -> None:
        """Set exposed parameters and other variables {name: SI value}; ValueError if one is refused."""
        for is_boolean, function, kind in (
            (False, self._library.fmi3SetFloat64, np.float64),
            (True, self._library.fmi3SetBoolean, np.bool_),
        ):
            names = [name for name in values if (name in self._booleans) == is_boolean]
            if names:
                references = self._list_references(names)
                numbers = np.array([values[name] for name in names], kind)
                if function(
                    self._instance, references.ctypes.data, len(names), numbers.ctypes.data, len(names)
                ):
                    raise ValueError(self._take_error_message())

    def _list_references(self, names: Sequence[str]) -> Any:
        """Value references of variables, as a C array."""
        return np.array([self._references[name] for name in names], np.uint32)

    def _take_error_message(self) -> str:
        """Last error message of the instance, which is then cleared."""
        text = next((text for status, text in reversed(self._messages) if status >= _ERROR_STATUS), "refused")
        self._messages.clear()
        return text


class CompiledJoint(LoadedLibrary):
    """Joint that is evaluated by the compiled library of its FMU. See `JointEngine`.

    Raises ImportError if the library must be compiled and a package is missing, RuntimeError if the compiler
    fails or compiles for no such platform, OSError if the library cannot be loaded.
    """

    def __init__(self, model: Model, parameter_file: ParameterFile) -> None:
        from jointfmu_fmu_src.native.library import make_joint_library

        super().__init__(model, make_joint_library(model, parameter_file))
        inputs, outputs = [v.name for v in model.inputs], [v.name for v in model.outputs]
        self._input_references, self._output_references = map(self._list_references, (inputs, outputs))
        self._input_columns = {name: i for i, name in enumerate(inputs)}
        self._start_row = np.array([[float(parameter_file.start_value(name)) for name in inputs]])

    def _declare_functions(self) -> None:
        """Declare argument types of the C function that follows a path."""
        super()._declare_functions()
        self._library.jointfmu_follow_path.restype = _SIZE_TYPE
        self._library.jointfmu_follow_path.argtypes = [
            _POINTER_TYPE, ctypes.c_bool, _SIZE_TYPE, _SIZE_TYPE, _POINTER_TYPE, _POINTER_TYPE, _SIZE_TYPE,
            _POINTER_TYPE, _POINTER_TYPE,
        ]  # fmt: skip

    def follow(self, inputs: Mapping[str, ArrayLike], *, each_from_rest: bool = False) -> PathResult:
        """Evaluate the joint along a path of inputs from the virgin state, see `JointEngine.follow`."""
        sizes = {np.size(column) for column in inputs.values()} - {1}
        values = np.repeat(self._start_row, next(iter(sizes), 1), axis=0)
        for name, column in inputs.items():
            values[:, self._input_columns[name]] = column
        results = np.empty((len(values), len(self._output_references)))
        given, read = self._input_references, self._output_references
        with self._lock:
            self._messages.clear()
            done = self._library.jointfmu_follow_path(
                self._instance, each_from_rest, len(values),
                len(given), given.ctypes.data, values.ctypes.data,
                len(read), read.ctypes.data, results.ctypes.data,
            )  # fmt: skip
            if done < len(values):
                raise ValueError(self._take_error_message())
            texts = [text for status, text in self._messages if status == _WARNING_STATUS]
            warnings = tuple(dict.fromkeys(texts))
        return PathResult(dict(zip(self._names, (*values.T, *results.T), strict=True)), warnings)


def _close_library(library: Any, instance: Any, logger: Any, library_folder: str) -> None:
    """Free the instance of a library, unload the library and remove its folder.

    logger : log callback of the instance; it must exist until the library is unloaded
    """
    import _ctypes

    if instance:
        library.fmi3FreeInstance(instance)
    if sys.platform == "win32":
        _ctypes.FreeLibrary(library._handle)
    else:
        _ctypes.dlclose(library._handle)
    shutil.rmtree(library_folder, ignore_errors=True)


class PythonJoint:
    """Joint that is evaluated by its Python law. See `JointEngine`."""

    def __init__(self, model: Model, parameter_file: ParameterFile) -> None:
        self.model = model
        self._parameter_class, self._values = type(parameter_file.values), dict(parameter_file.values_by_name)
        self._start_values = {v.name: parameter_file.start_value(v.name) for v in model.inputs}
        self._joint: Any = model.tabulate(parameter_file.values)

    def set_parameters(self, values: Mapping[str, Any]) -> None:
        """Set parameters by structured name [SI], see `JointEngine.set_parameters`."""
        self._values |= values
        self._joint = None

    def follow(self, inputs: Mapping[str, ArrayLike], *, each_from_rest: bool = False) -> PathResult:
        """Evaluate the joint along a path of inputs from the virgin state, see `JointEngine.follow`."""
        if self._joint is None:
            self._joint = self.model.tabulate(build_parameter_set(self._parameter_class, self._values))
        model, joint = self.model, self._joint
        columns = self._start_values | {**inputs}
        arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, np.float64)) for x in columns.values()))
        points = [dict(zip(columns, map(float, point), strict=True)) for point in zip(*arrays, strict=True)]
        history = model.initial_history(joint) if model.initial_history else None
        rows = []
        for point in points:
            if model.advance is None or each_from_rest:
                outputs = model.evaluate(joint, point)
            else:
                outputs, history = model.advance(joint, point, history)
            rows.append(point | {name: float(value) for name, value in outputs.items()})
        found = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        texts = (text for row in rows for text in model.find_warnings(joint, row).values())
        return PathResult(found, tuple(dict.fromkeys(texts)))
