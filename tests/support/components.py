"""A host of FMUs by their WebAssembly component, after FMI-LS-WASM, in wasmtime."""

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import wasmtime
from conftest import Message
from fmpy import read_model_description
from wasmtime.component import Component, Linker

MEMORY = 8 << 20
"""Bytes that an instance of a component may have."""
STATUS = ("ok", "warning", "discard", "error", "fatal")


def package(interface: str) -> str:
    """Name of an interface of the draft."""
    return f"fmi:fmi3/{interface}@3.0.0"


class Refused(Exception):
    """A call did not go well; the text is its status."""


class ComponentFmu:
    """An instance of an FMU, as `conftest.Fmu`; no file of the FMU but the component and its description."""

    def __init__(self, path: Path, exchange: bool = False, token: str | None = None, **options: Any) -> None:
        self.description = read_model_description(str(path))
        kind = self.description.modelExchange if exchange else self.description.coSimulation
        with zipfile.ZipFile(path) as archive:
            binary = archive.read(f"binaries/wasm32-wasip2/{kind.modelIdentifier}.wasm")
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.outputs = [n for n, v in self.variables.items() if v.causality == "output"]
        self.exchange, self.time = exchange, 0.0
        self.kind = "model-exchange" if exchange else "co-simulation"
        self.messages: list[Message] = []
        self.names: set[str] = set()
        engine = wasmtime.Engine()
        self.store = wasmtime.Store(engine)
        self.store.set_limits(memory_size=MEMORY)
        self.component = Component(engine, binary)
        linker = Linker(engine)
        with linker.root() as root, root.add_instance(package("callbacks")) as callbacks:
            callbacks.add_func("log-message", self._log)
        self.instance = linker.instantiate(self.store, self.component)
        self.it = self.new(token or self.description.instantiationToken, **options)

    def new(self, token: str, name: str = "test", logging: bool = True, **options: Any) -> Any:
        """Another instance, or None."""
        given = [name, token, False, logging]
        if not self.exchange:
            given += [options.get("events", False), False, options.get("intermediate", [])]
        return self.function(self.kind, f"[static]{self.kind}-instance.instantiate-{self.kind}", *given)

    def function(self, interface: str, name: str, *arguments: Any) -> Any:
        """Call a function of an interface."""
        index = self.component.get_export_index(package(interface))
        index = self.component.get_export_index(name, index)
        found = self.instance.get_func(self.store, index)
        assert found is not None
        return found(self.store, *arguments)

    def _log(self, _: Any, name: str, status: str, category: str, text: str) -> None:
        self.names.add(name)
        self.messages.append(Message(STATUS.index(status), text, category))

    def __call__(self, method: str, *arguments: Any) -> Any:
        """What a method gives; raises Refused if that is a status other than ok and warning."""
        found = self.function(self.kind, f"[method]{self.kind}-instance.{method}", self.it, *arguments)
        if isinstance(found, str):
            if found not in STATUS[:2]:
                raise Refused(found)
            return None
        return found

    def references(self, names: Any) -> list[int]:
        return [self.variables[name].valueReference for name in names]

    def set(self, values: Mapping[str, Any]) -> None:
        """Set parameters and inputs, one call each."""
        for name, value in values.items():
            if self.variables[name].type == "Boolean":
                self("set-boolean", self.references([name]), [bool(value)])
            else:
                self("set-float64", self.references([name]), [float(value)])

    def get(self, *names: str) -> dict[str, float]:
        """Outputs (default: all), inputs or parameters, all in one call."""
        names = names or tuple(self.outputs)
        return dict(zip(names, self("get-float64", self.references(names)), strict=True))

    def start(self, values: Mapping[str, Any] | None = None) -> "ComponentFmu":
        """Set start values in initialization mode and leave it."""
        self("enter-initialization-mode", None, 0.0, None)
        self.time = 0.0
        self.set(values or {})
        self("exit-initialization-mode")
        return self

    def step(self, size: float = 1.0) -> None:
        """One step."""
        done = vars(self("do-step", self.time, size, True))
        self.time += size
        assert done == {
            "last-successful-time": self.time,
            "event-handling-needed": False,
            "terminate-simulation": False,
            "early-return": False,
        }

    def free(self) -> None:
        """Drop the instance."""
        self.it.drop(self.store)
