"""A WebAssembly component in binary form, item by item; each item gives its index."""

from collections import Counter
from collections.abc import Mapping

from .encoding import COMPONENT, label, name, one, section, unsigned, vector
from .types import InstanceType, Types

_MODULE, _CORE_INSTANCE, _COMPONENT, _INSTANCE, _ALIAS = 1, 2, 4, 5, 6
_TYPE, _CANON, _IMPORT, _EXPORT = 7, 8, 10, 11
_CORE = {"func": 0, "table": 1, "memory": 2}
_SORT = {"func": 1, "type": 3, "instance": 5}
_UTF8 = b"\0"

Item = tuple[str, int]
"""What it is (`func`, `type`, ...), and its index."""


class Component:
    """A component that grows."""

    def __init__(self) -> None:
        self._out = bytearray(COMPONENT)
        self._counts: Counter[str] = Counter()
        self.types = Types(lambda content: self._add(_TYPE, content))

    @property
    def content(self) -> bytes:
        """In binary form."""
        return bytes(self._out)

    def _add(self, kind: int, item: bytes) -> None:
        self._out += one(kind, item)

    def _new(self, sort: str) -> int:
        if sort == "type":
            return self.types.new()
        self._counts[sort] += 1
        return self._counts[sort] - 1

    # Modules

    def module(self, content: bytes) -> int:
        """A module."""
        self._out += section(_MODULE, content)
        return self._new("module")

    def start(self, module: int, **given: int) -> int:
        """A module's instance, with instances for what it imports."""
        items = [name(key) + b"\x12" + unsigned(index) for key, index in given.items()]
        self._add(_CORE_INSTANCE, b"\0" + unsigned(module) + vector(items))
        return self._new("core instance")

    def bundle(self, items: Mapping[str, Item]) -> int:
        """An instance made of items of others."""
        listed = [name(key) + bytes([_CORE[sort]]) + unsigned(index) for key, (sort, index) in items.items()]
        self._add(_CORE_INSTANCE, b"\1" + vector(listed))
        return self._new("core instance")

    def of_module(self, instance: int, key: str, sort: str = "func") -> int:
        """What a module's instance exports."""
        self._add(_ALIAS, bytes([0, _CORE[sort], 1]) + unsigned(instance) + name(key))
        return self._new(f"core {sort}")

    # The border between modules and components

    def lift(self, core: int, kind: int, memory: int, realloc: int, post: int) -> int:
        """A function of the component, from a module's."""
        options = vector([_UTF8, b"\3" + unsigned(memory), b"\4" + unsigned(realloc), b"\5" + unsigned(post)])
        self._add(_CANON, b"\0\0" + unsigned(core) + options + unsigned(kind))
        return self._new("func")

    def lower(self, function: int, memory: int) -> int:
        """A function for modules, from the component's."""
        self._add(_CANON, b"\1\0" + unsigned(function) + vector([_UTF8, b"\3" + unsigned(memory)]))
        return self._new("core func")

    def resource(self, drop: int) -> int:
        """A type of resources, and what is called when one is dropped."""
        return self.types.add(b"\x3f\x7f\1" + unsigned(drop))

    def new_resource(self, kind: int) -> int:
        """The function that makes a handle."""
        self._add(_CANON, b"\2" + unsigned(kind))
        return self._new("core func")

    # Imports, exports, components inside

    def import_instance(self, key: str, kind: InstanceType) -> int:
        """An instance of the host's."""
        index = self.types.add(kind.content)
        self._add(_IMPORT, label(key) + b"\5" + unsigned(index))
        return self._new("instance")

    def import_type(self, key: str, index: int | None) -> int:
        """A type equal to another, or of resources."""
        self._add(_IMPORT, label(key) + (b"\3\1" if index is None else b"\3\0" + unsigned(index)))
        return self._new("type")

    def import_function(self, key: str, kind: int) -> int:
        """A function of a type."""
        self._add(_IMPORT, label(key) + b"\1" + unsigned(kind))
        return self._new("func")

    def of_instance(self, instance: int, key: str, sort: str) -> int:
        """What an instance exports."""
        self._add(_ALIAS, bytes([_SORT[sort], 0]) + unsigned(instance) + name(key))
        return self._new(sort)

    def component(self, inner: "Component") -> int:
        """A component inside."""
        self._out += section(_COMPONENT, inner.content)
        return self._new("component")

    def instance(self, component: int, given: Mapping[str, Item]) -> int:
        """Its instance."""
        items = [name(key) + bytes([_SORT[sort]]) + unsigned(index) for key, (sort, index) in given.items()]
        self._add(_INSTANCE, b"\0" + unsigned(component) + vector(items))
        return self._new("instance")

    def export(self, key: str, sort: str, index: int, kind: int | None = None) -> int:
        """Give something out under a name; a function perhaps with another name of its type."""
        as_ = b"\0" if kind is None else b"\1\1" + unsigned(kind)
        self._add(_EXPORT, label(key) + bytes([_SORT[sort]]) + unsigned(index) + as_)
        return self._new(sort)
