"""Insert data and name of an FMU into a compiled library in place of the placeholders, on any machine.

ELF, PE and Mach-O are treated alike: the placeholder struct is found by its content, the placeholder name
where the library names itself. A Mach-O library also gets a new UUID, and on arm64 new page digests.
"""

import struct
from hashlib import sha256
from uuid import UUID

from ..data import PLACEHOLDER_FMU_NAME, CDataStruct

_MACHO_MAGIC = struct.pack("<I", 0xFEEDFACF)
"""First bytes of a Mach-O library."""
_MACHO_UUID_COMMAND, _MACHO_SIGNATURE_COMMAND = 0x1B, 0x1D
"""Load commands of Mach-O (LC_UUID, LC_CODE_SIGNATURE)."""
_MACHO_CODE_DIRECTORY_MAGIC = 0xFADE0C02
"""First number of the code directory in the signature of a Mach-O library."""
_SHA256_DIGEST_SIZE = 32
"""Size of a SHA-256 digest [bytes]."""


def fill_library_placeholders(
    compiled_library: bytes, placeholder_data: CDataStruct, fmu_data: CDataStruct, fmu_name: str
) -> bytes:
    """Insert data and name of an FMU into a compiled shared library in place of the placeholders.

    compiled_library : bytes of a library that contains placeholder data and placeholder name
    placeholder_data : C struct of zeros (data.c) in the compiled library
    fmu_data         : C struct with the FMU's numbers, which replaces it

    Raises ValueError if the library does not contain the placeholder data exactly once.
    """
    if compiled_library.count(placeholder_data.struct_bytes) != 1 or len(
        placeholder_data.struct_bytes
    ) != len(fmu_data.struct_bytes):
        raise ValueError(
            f"{fmu_name}: the compiled code does not fit these parameters; run jointfmu cache --clear and "
            "build again"
        )
    image = bytearray(compiled_library.replace(placeholder_data.struct_bytes, fmu_data.struct_bytes))
    _replace_placeholder_name(image, fmu_name.encode())
    if image.startswith(_MACHO_MAGIC):
        _set_uuid(image, UUID(fmu_data.instantiation_token))
        _update_signature(image)
    return bytes(image)


def _replace_placeholder_name(library_bytes: bytearray, fmu_name: bytes) -> None:
    """Replace the placeholder name by the FMU's name in every text of a library, which keeps its size."""
    start = library_bytes.find(PLACEHOLDER_FMU_NAME.encode())
    while start >= 0:
        end = library_bytes.index(0, start)
        library_bytes[start:end] = (fmu_name + library_bytes[start + len(PLACEHOLDER_FMU_NAME) : end]).ljust(
            end - start, b"\0"
        )
        start = library_bytes.find(PLACEHOLDER_FMU_NAME.encode(), end)


def _find_load_commands(library_bytes: bytes | bytearray) -> dict[int, int]:
    """Find the load commands of a Mach-O library: {load command: byte offset}."""
    (count,) = struct.unpack_from("<I", library_bytes, 16)
    offsets, offset = {}, 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", library_bytes, offset)
        offsets[command] = offset
        offset += size
    return offsets


def _set_uuid(library_bytes: bytearray, library_uuid: UUID) -> None:
    """Set the UUID of a Mach-O library."""
    offset = _find_load_commands(library_bytes)[_MACHO_UUID_COMMAND] + 8
    library_bytes[offset : offset + 16] = library_uuid.bytes


def _update_signature(library_bytes: bytearray) -> None:
    """Recompute the digests of the ad-hoc signature of a Mach-O library, if it has one."""
    command = _find_load_commands(library_bytes).get(_MACHO_SIGNATURE_COMMAND)
    if command is None:
        return
    (signature,) = struct.unpack_from("<I", library_bytes, command + 8)
    (blobs,) = struct.unpack_from(">I", library_bytes, signature + 8)
    for i in range(blobs):
        (offset,) = struct.unpack_from(">I", library_bytes, signature + 16 + 8 * i)
        directory = signature + offset
        if struct.unpack_from(">I", library_bytes, directory) == (_MACHO_CODE_DIRECTORY_MAGIC,):
            _update_page_digests(library_bytes, directory)


def _update_page_digests(library_bytes: bytearray, directory_offset: int) -> None:
    """Recompute the page digests in the code directory of a Mach-O library at a byte offset."""
    digests, _, _, pages, limit = struct.unpack_from(">IIIII", library_bytes, directory_offset + 16)
    page = 1 << library_bytes[directory_offset + 39]
    for i in range(pages):
        digest = sha256(library_bytes[i * page : min((i + 1) * page, limit)]).digest()
        start = directory_offset + digests + _SHA256_DIGEST_SIZE * i
        library_bytes[start : start + _SHA256_DIGEST_SIZE] = digest
