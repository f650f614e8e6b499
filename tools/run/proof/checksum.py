"""Checksums of related files of an FMU: attributes `checksum` and `checksumType` of FMI-LS-REF."""

import hashlib
from xml.etree.ElementTree import Element

DEFAULT_CHECKSUM_ALGORITHM = "SHA3-256"
"""checksumType if a related file states none."""
CHECKSUM_ALGORITHMS = {
    f"{family}-{bits}": f"{name}{bits}"
    for family, name in (("SHA3", "sha3_"), ("SHA", "sha"))
    for bits in (224, 256, 384, 512)
}
"""{checksumType: name of the algorithm in hashlib}."""


def check_checksum(related_file_element: Element, file_content: bytes) -> None:
    """Compare the content of a file in an FMU with its checksum in the manifest, if one is stated.

    related_file_element : element of the manifest (FMI-LS-REF) for the file

    Raises ValueError if the checksums differ, or the algorithm is not in CHECKSUM_ALGORITHMS.
    """
    if (stated := related_file_element.get("checksum")) is None:
        return
    kind = related_file_element.get("checksumType", DEFAULT_CHECKSUM_ALGORITHM)
    if kind not in CHECKSUM_ALGORITHMS:
        raise ValueError(f"has checksumType = {kind!r}, allowed are {', '.join(CHECKSUM_ALGORITHMS)}")
    if (found := hashlib.new(CHECKSUM_ALGORITHMS[kind], file_content).hexdigest()) != stated.strip().lower():
        raise ValueError(f"is not the file of the manifest: its {kind} is {found}, stated is {stated}")
