"""Compiled parts to the libraries of an FMU: its data and name in place of the placeholders, on any machine.

The same for ELF, PE and Mach-O: the block of data is found by its content, the placeholder of the name where
the library names itself. Only macOS asks for more: a library has a number of its own, and on arm64 digests
of its pages.
"""

import struct
from hashlib import sha256
from uuid import UUID

from ..data import PLACEHOLDER, Data

_MACHO = struct.pack("<I", 0xFEEDFACF)
_UUID, _CODE_SIGNATURE = 0x1B, 0x1D
"""Load commands of Mach-O."""
_CODE_DIRECTORY = 0xFADE0C02
_DIGEST = 32
"""Bytes of SHA-256."""


def finished(library: bytes, before: Data, after: Data, name: str) -> bytes:
    """The library of an FMU.

    library : compiled with the block `before` and the placeholder of the name

    Raises ValueError if the block is not there once.
    """
    if library.count(before.content) != 1 or len(before.content) != len(after.content):
        raise ValueError(f"{name}: the compiled part is not that of these data; remove it")
    image = bytearray(library.replace(before.content, after.content))
    _rename(image, name.encode())
    if image.startswith(_MACHO):
        _identify(image, UUID(after.token))
        _sign(image)
    return bytes(image)


def _rename(image: bytearray, name: bytes) -> None:
    """Put the name where the placeholder stands, with what follows up to the end of the text."""
    at = image.find(PLACEHOLDER.encode())
    while at >= 0:
        end = image.index(0, at)
        image[at:end] = (name + image[at + len(PLACEHOLDER) : end]).ljust(end - at, b"\0")
        at = image.find(PLACEHOLDER.encode(), end)


def _commands(image: bytes | bytearray) -> dict[int, int]:
    """{load command: place}."""
    (count,) = struct.unpack_from("<I", image, 16)
    found, at = {}, 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", image, at)
        found[command] = at
        at += size
    return found


def _identify(image: bytearray, uuid: UUID) -> None:
    at = _commands(image)[_UUID] + 8
    image[at : at + 16] = uuid.bytes


def _sign(image: bytearray) -> None:
    """Compute the digests of an ad-hoc signature again, where there is one."""
    command = _commands(image).get(_CODE_SIGNATURE)
    if command is None:
        return
    (at,) = struct.unpack_from("<I", image, command + 8)
    (blobs,) = struct.unpack_from(">I", image, at + 8)
    for i in range(blobs):
        (offset,) = struct.unpack_from(">I", image, at + 16 + 8 * i)
        directory = at + offset
        if struct.unpack_from(">I", image, directory) == (_CODE_DIRECTORY,):
            _digest_pages(image, directory)


def _digest_pages(image: bytearray, directory: int) -> None:
    digests, _, _, pages, limit = struct.unpack_from(">IIIII", image, directory + 16)
    page = 1 << image[directory + 39]
    for i in range(pages):
        digest = sha256(image[i * page : min((i + 1) * page, limit)]).digest()
        place = directory + digests + _DIGEST * i
        image[place : place + _DIGEST] = digest
