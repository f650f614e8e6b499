"""Checksums of related files of an FMU: attributes `checksum` and `checksumType` of FMI-LS-REF."""

import hashlib
from xml.etree.ElementTree import Element

DEFAULT_ALGORITHM = "SHA3-256"
"""checksumType if a related file states none."""
ALGORITHMS = {
    f"{family}-{bits}": f"{name}{bits}"
    for family, name in (("SHA3", "sha3_"), ("SHA", "sha"))
    for bits in (224, 256, 384, 512)
}
"""{checksumType: name of the algorithm in hashlib}."""


def check_checksum(file_element: Element, content: bytes) -> None:
    """Compare the content of a related file with its checksum in the manifest, if one is stated.

    file_element : element of the manifest

    Raises ValueError if the checksums differ, or the algorithm is not in ALGORITHMS.
    """
    if (stated := file_element.get("checksum")) is None:
        return
    kind = file_element.get("checksumType", DEFAULT_ALGORITHM)
    if kind not in ALGORITHMS:
        raise ValueError(f"has checksumType = {kind!r}, allowed are {', '.join(ALGORITHMS)}")
    if (found := hashlib.new(ALGORITHMS[kind], content).hexdigest()) != stated.strip().lower():
        raise ValueError(f"is not the file of the manifest: its {kind} is {found}, stated is {stated}")
