"""Types of WebAssembly's component model in binary form, from WIT's notation."""

from collections.abc import Callable, Sequence

from .encoding import label, name, signed, unsigned, vector

PRIMITIVES = {
    "bool": 0x7F, "s8": 0x7E, "u8": 0x7D, "s16": 0x7C, "u16": 0x7B, "s32": 0x7A, "u32": 0x79,
    "s64": 0x78, "u64": 0x77, "f32": 0x76, "f64": 0x75, "string": 0x73,
}  # fmt: skip
_MADE = {
    "record": b"\x72", "list": b"\x70", "tuple": b"\x6f", "enum": b"\x6d", "option": b"\x6b",
    "result": b"\x6a", "own": b"\x69", "borrow": b"\x68",
}  # fmt: skip


class Types:
    """The types of a component, or of what an instance type says, by their index.

    declare : takes each new type
    known   : {type in WIT's notation: index}
    """

    def __init__(self, declare: Callable[[bytes], None]):
        self._declare, self._count = declare, 0
        self.known: dict[str, int] = {}

    def new(self) -> int:
        """The index of a type that was made elsewhere: imported, exported under a name, another's."""
        self._count += 1
        return self._count - 1

    def add(self, content: bytes) -> int:
        """The index of a new type."""
        self._declare(content)
        return self.new()

    def define(self, text: str) -> int:
        """The index of a new type by its structure."""
        if text in PRIMITIVES:
            return self.add(bytes([PRIMITIVES[text]]))
        kind, _, inner = text.removesuffix(">").partition("<")
        return self.add(_MADE[kind] + self._content(kind, _split(inner)))

    def _content(self, kind: str, items: Sequence[str]) -> bytes:
        if kind == "enum":
            return vector(name(item) for item in items)
        if kind == "record":
            return self._fields(items)
        if kind in ("own", "borrow"):
            return unsigned(self.known[items[0]])
        values = [self.value(item) for item in items]
        if kind == "result":
            return b"".join(b"\1" + value for value in values)
        return vector(values) if kind == "tuple" else values[0]

    def value(self, text: str) -> bytes:
        """A type as it stands in others."""
        if text in PRIMITIVES:
            return bytes([PRIMITIVES[text]])
        if text not in self.known:
            self.known[text] = self.define(text)
        return signed(self.known[text])

    def function(self, signature: str) -> int:
        """The index of the type of a function, `parameter: type, ... -> result`."""
        given, _, result = (part.strip() for part in signature.partition("->"))
        parameters = self._fields(_split(given))
        return self.add(b"\x40" + parameters + (b"\0" + self.value(result) if result else b"\1\0"))

    def _fields(self, items: Sequence[str]) -> bytes:
        pairs = [item.split(": ", 1) for item in items]
        return vector([name(field) + self.value(kind) for field, kind in pairs])


class InstanceType:
    """The type of an imported instance: its declarations."""

    def __init__(self) -> None:
        self._items: list[bytes] = []
        self.types = Types(lambda content: self._items.append(b"\1" + content))

    def outer(self, text: str, index: int) -> None:
        """Take a type of the component around."""
        self._items.append(b"\2\3\2\1" + unsigned(index))
        self.types.known[text] = self.types.new()

    def export_type(self, text: str, index: int) -> None:
        """A type under a name."""
        self._items.append(b"\4" + label(text) + b"\3\0" + unsigned(index))
        self.types.known[text] = self.types.new()

    def export_function(self, text: str, signature: str) -> None:
        """A function."""
        index = self.types.function(signature)
        self._items.append(b"\4" + label(text) + b"\1" + unsigned(index))

    @property
    def content(self) -> bytes:
        """In binary form."""
        return b"\x42" + vector(self._items)


def _split(text: str) -> list[str]:
    """Parts between the commas that stand in no brackets."""
    parts, depth = [""], 0
    for char in text:
        depth += (char == "<") - (char == ">")
        if char == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += char
    return [part.strip() for part in parts if part.strip()]
