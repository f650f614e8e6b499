"""A core module to a component after FMI-LS-WASM: its functions under the names of the draft."""

from collections.abc import Mapping, Sequence

from .encoding import MODULE, name, section, vector
from .interface import COMMON, KINDS, LOG, TYPES, USED, Functions, Kind, full
from .sections import Component, Item
from .types import InstanceType

_I32 = 0x7F
_LATER = {"log-message": 7, "drop": 1}
"""Functions that the module calls, or that belong to its resources, before they can be there: numbers of
their parameters."""


def component(module: bytes) -> bytes:
    """The component around the module of an FMU, compiled with component.c."""
    c = Component()
    _import_types(c)
    log = _import_log(c)
    late = c.start(c.module(_stand_ins()))
    drop = c.of_module(late, "drop")
    made: dict[str, Item] = {"log-message": ("func", c.of_module(late, "log-message"))}
    for kind in KINDS:
        c.types.known[kind.resource] = c.resource(drop)
        made[f"new-{kind.resource}"] = ("func", c.new_resource(c.types.known[kind.resource]))
    main = c.start(c.module(module), component=c.bundle(made))
    memory = c.of_module(main, "memory", "memory")
    now: dict[str, Item] = {
        "log-message": ("func", c.lower(log, memory)),
        "drop": ("func", c.of_module(main, "drop")),
        "_initialize": ("func", c.of_module(main, "_initialize")),
        "table": ("table", c.of_module(late, "table", "table")),
    }
    c.start(c.module(_put_in_place()), late=c.bundle(now))
    options = memory, c.of_module(main, "cabi_realloc"), c.of_module(main, "cabi_post")
    core: dict[str, int] = {}

    def lifted(functions: Functions) -> dict[str, int]:
        found = {}
        for key, signature in functions.items():
            short = key.rpartition(".")[2]
            if short not in core:
                core[short] = c.of_module(main, short)
            found[key] = c.lift(core[short], c.types.function(signature), *options)
        return found

    _export(c, "common", {}, (), COMMON, lifted(COMMON))
    for kind in KINDS:
        for key, text in kind.types.items():
            c.types.known[key] = c.types.define(text)
        types = {key: TYPES[key] for key in TYPES} | dict(kind.types)
        _export(c, kind.name, types, (*USED, *kind.types), kind.functions, lifted(kind.functions), kind)
    return c.content


def _import_types(c: Component) -> None:
    kind = InstanceType()
    for key, text in TYPES.items():
        kind.export_type(key, kind.types.define(text))
    instance = c.import_instance(full("types"), kind)
    for key in TYPES:
        c.types.known[key] = c.of_instance(instance, key, "type")


def _import_log(c: Component) -> int:
    kind = InstanceType()
    kind.outer("status", c.types.known["status"])
    kind.export_type("status", kind.types.known["status"])
    for key, signature in LOG.items():
        kind.export_function(key, signature)
    return c.of_instance(c.import_instance(full("callbacks"), kind), "log-message", "func")


def _export(
    c: Component,
    interface: str,
    types: Mapping[str, str],
    shown: Sequence[str],
    functions: Functions,
    lifted: Mapping[str, int],
    kind: Kind | None = None,
) -> None:
    """Export an interface: an inner component names its types, and what its functions have of them."""
    inner = Component()
    given: dict[str, Item] = {}
    known = inner.types.known

    def take_type(key: str, index: int | None) -> None:
        known[key] = inner.import_type(f"import-type-{key}", index)
        given[f"import-type-{key}"] = ("type", c.types.known[key])

    for key, text in types.items():
        take_type(key, inner.types.define(text))
    if kind:
        take_type(kind.resource, None)
    taken = {}
    for key, signature in functions.items():
        label = "import-func-" + key.replace("[", "").replace("]", "-").replace(".", "-")
        taken[key] = inner.import_function(label, inner.types.function(signature))
        given[label] = ("func", lifted[key])
    named = {key: known[key] for key in types}
    named |= {key: inner.export(key, "type", known[key]) for key in shown}
    if kind:
        named[kind.resource] = inner.export(kind.resource, "type", known[kind.resource])
    known.clear()
    known.update(named)
    for key, signature in functions.items():
        inner.export(key, "func", taken[key], inner.types.function(signature))
    c.export(full(interface), "instance", c.instance(c.component(inner), given))


def _kinds() -> list[bytes]:
    """Types of the functions in _LATER, and of one without parameters."""
    return [b"\x60" + vector([bytes([_I32])] * n) + b"\0" for n in (*_LATER.values(), 0)]


def _stand_ins() -> bytes:
    """A module whose functions call those in its table."""
    count = len(_LATER)
    bodies = []
    for i, n in enumerate(_LATER.values()):
        gets = b"".join(bytes([0x20, k]) for k in range(n))
        body = b"\0" + gets + bytes([0x41, i, 0x11, i, 0, 0x0B])
        bodies.append(bytes([len(body)]) + body)
    exports = [name(key) + bytes([0, i]) for i, key in enumerate(_LATER)]
    return (
        MODULE
        + section(1, vector(_kinds()))
        + section(3, vector(bytes([i]) for i in range(count)))
        + section(4, vector([bytes([0x70, 0, count])]))
        + section(7, vector([*exports, name("table") + b"\1\0"]))
        + section(10, vector(bodies))
    )


def _put_in_place() -> bytes:
    """A module that puts the functions into that table, and begins with the module's own beginning."""
    count = len(_LATER)
    imports = [name("late") + name(key) + bytes([0, i]) for i, key in enumerate((*_LATER, "_initialize"))]
    table = name("late") + name("table") + bytes([1, 0x70, 0, count])
    places = bytes([0, 0x41, 0, 0x0B]) + vector(bytes([i]) for i in range(count))
    return (
        MODULE
        + section(1, vector(_kinds()))
        + section(2, vector([*imports, table]))
        + section(8, bytes([count]))
        + section(9, vector([places]))
    )
