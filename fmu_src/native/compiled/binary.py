"""Insert data and name of an FMU into a compiled library in place of the placeholders, on any machine.

ELF, PE and Mach-O are treated alike: the placeholder data block is found by its content, the placeholder name
where the library names itself. A Mach-O library also gets a new UUID, and on arm64 new page digests.
"""

import struct
from hashlib import sha256
from uuid import UUID

from ..data import PLACEHOLDER, DataBlock

_MACHO_MAGIC = struct.pack("<I", 0xFEEDFACF)
_UUID_COMMAND, _SIGNATURE_COMMAND = 0x1B, 0x1D
"""Load commands of Mach-O (LC_UUID, LC_CODE_SIGNATURE)."""
_CODE_DIRECTORY_MAGIC = 0xFADE0C02
_DIGEST_SIZE = 32
"""Size of a SHA-256 digest [bytes]."""


def fill_library(library: bytes, placeholder: DataBlock, data: DataBlock, name: str) -> bytes:
    """Insert data and name of an FMU into a compiled library.

    library          : compiled with the placeholder data and the placeholder name
    placeholder_data : data block in the compiled library
    data             : data block of the FMU

    Raises ValueError if the library does not contain the placeholder data exactly once.
    """
    if library.count(placeholder.content) != 1 or len(placeholder.content) != len(data.content):
        raise ValueError(f"{name}: the compiled part is not that of these data; remove it")
    image = bytearray(library.replace(placeholder.content, data.content))
    _rename(image, name.encode())
    if image.startswith(_MACHO_MAGIC):
        _set_uuid(image, UUID(data.token))
        _sign(image)
    return bytes(image)


def _rename(image: bytearray, name: bytes) -> None:
    """Replace the placeholder name in every text of the library; the rest of the text is kept."""
    start = image.find(PLACEHOLDER.encode())
    while start >= 0:
        end = image.index(0, start)
        image[start:end] = (name + image[start + len(PLACEHOLDER) : end]).ljust(end - start, b"\0")
        start = image.find(PLACEHOLDER.encode(), end)


def _find_load_commands(image: bytes | bytearray) -> dict[int, int]:
    """{load command: byte offset} of a Mach-O library."""
    (count,) = struct.unpack_from("<I", image, 16)
    offsets, offset = {}, 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", image, offset)
        offsets[command] = offset
        offset += size
    return offsets


def _set_uuid(image: bytearray, uuid: UUID) -> None:
    """Set the UUID of a Mach-O library."""
    offset = _find_load_commands(image)[_UUID_COMMAND] + 8
    image[offset : offset + 16] = uuid.bytes


def _sign(image: bytearray) -> None:
    """Recompute the digests of the ad-hoc signature of a Mach-O library, if it has one."""
    command = _find_load_commands(image).get(_SIGNATURE_COMMAND)
    if command is None:
        return
    (signature,) = struct.unpack_from("<I", image, command + 8)
    (blobs,) = struct.unpack_from(">I", image, signature + 8)
    for i in range(blobs):
        (offset,) = struct.unpack_from(">I", image, signature + 16 + 8 * i)
        directory = signature + offset
        if struct.unpack_from(">I", image, directory) == (_CODE_DIRECTORY_MAGIC,):
            _digest_pages(image, directory)


def _digest_pages(image: bytearray, directory: int) -> None:
    """Recompute the page digests of the code directory at a byte offset."""
    digests, _, _, pages, limit = struct.unpack_from(">IIIII", image, directory + 16)
    page = 1 << image[directory + 39]
    for i in range(pages):
        digest = sha256(image[i * page : min((i + 1) * page, limit)]).digest()
        start = directory + digests + _DIGEST_SIZE * i
        image[start : start + _DIGEST_SIZE] = digest
