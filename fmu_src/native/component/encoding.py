"""What WebAssembly's binary format is made of."""

from collections.abc import Iterable

MODULE = b"\0asm\1\0\0\0"
COMPONENT = b"\0asm\x0d\0\1\0"
"""What files begin with."""


def unsigned(value: int) -> bytes:
    """A whole number of LEB128."""
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])


def signed(value: int) -> bytes:
    """The same with room for a sign."""
    if value < 0x40:
        return bytes([value])
    return bytes([value & 0x7F | 0x80]) + signed(value >> 7)


def vector(items: Iterable[bytes]) -> bytes:
    """Items with their number in front."""
    every = list(items)
    return unsigned(len(every)) + b"".join(every)


def sized(content: bytes) -> bytes:
    """Bytes with their number in front."""
    return unsigned(len(content)) + content


def name(text: str) -> bytes:
    """A name."""
    return sized(text.encode())


def label(text: str) -> bytes:
    """A name of what a component imports or exports."""
    return b"\0" + name(text)


def section(kind: int, content: bytes) -> bytes:
    """A section of a module or component."""
    return bytes([kind]) + sized(content)


def one(kind: int, item: bytes) -> bytes:
    """A section with one item."""
    return section(kind, b"\1" + item)
