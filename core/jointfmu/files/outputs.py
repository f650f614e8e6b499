"""Checks before output files are overwritten.

A file of another kind is never overwritten. A file that the program did not write is overwritten only if the
user forces it. The program recognises its own files by their content: `PROGRAM_MARK`,
`FileKind.is_program_file`.
"""

import os
import re
import zipfile
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from ..quantity.refusal import InputRefusal
from .writing import check_writable, is_stream, write_text

PROGRAM_MARK = "written by jointfmu"
"""Text in a comment in the first lines of all text files that the program writes."""
_PROGRAM_MARK_PATTERN = re.compile(
    rb'(written|generated) by jointfmu|(generationTool|content)="jointfmu', re.IGNORECASE
)
"""Marks, also of earlier versions, in the first bytes of a file that this program wrote."""
_PROGRAM_MARK_SEARCH_SIZE = 65536
"""Number of bytes [1] at the start of a file in which the mark is searched."""
_ARCHIVE_DESCRIPTION_NAME_PATTERN = re.compile(r"modelDescription\.xml|SystemStructure\.ssd")
"""Names of the XML members of FMU and SSP archives that contain the mark."""
_CHECKSUM_PATTERN = re.compile(rf"# {PROGRAM_MARK}; checksum ([0-9a-f]{{8}})\n")
"""First line of a parameter file that this program wrote."""
_FOREIGN_FILE_ENDING_PATTERN = re.compile(
    r"\.(7z|bat|c|cpp|dll|docx|dylib|exe|frd|gz|h|ipynb|jpg|json|jsonl|m|mat|md|npy|npz|odb|pdf"
    r"|ps1|py|pyi|rst|sh|so|ssd|ssv|tar|vtk|xls|xlsx|yaml|yml|zip)"
)
"""File name endings of kinds that no command writes to a path chosen by the user."""


def _has_program_mark(output_path: Path) -> bool:
    """Whether the head of a file, or of the description in an FMU or SSP archive, contains PROGRAM_MARK."""
    with output_path.open("rb") as file:
        head = file.read(_PROGRAM_MARK_SEARCH_SIZE)
    if head.startswith(b"PK"):
        try:
            with zipfile.ZipFile(output_path) as archive:
                member = next(filter(_ARCHIVE_DESCRIPTION_NAME_PATTERN.fullmatch, archive.namelist()))
                with archive.open(member) as text:
                    head = text.read(_PROGRAM_MARK_SEARCH_SIZE)
        except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, StopIteration):
            return False
    return _PROGRAM_MARK_PATTERN.search(head) is not None


@dataclass(frozen=True, slots=True)
class FileKind:
    """Kind of an output file: its name, its file name endings, and how a file of this kind is recognised.

    name_in_messages  : name of the kind in messages
    file_name_endings : file name endings of this kind, lower case
    is_program_file   : function, path -> whether the program wrote this file
    """

    name_in_messages: str
    file_name_endings: tuple[str, ...]
    is_program_file: Callable[[Path], bool] = _has_program_mark


def _is_unedited_parameter_file(parameter_path: Path) -> bool:
    """Whether a parameter file is unchanged since the program wrote it; an edited file is the user's."""
    text = parameter_path.read_bytes().decode("utf-8", "replace").replace("\r\n", "\n")
    match = _CHECKSUM_PATTERN.match(text)
    return match is not None and match[1] == _compute_checksum(text[match.end() :])


def _compute_checksum(file_text: str) -> str:
    """Checksum of the text of a parameter file, written into its first line to recognise later edits."""
    return f"{zlib.crc32(file_text.encode()):08x}"


PARAMETER_FILE = FileKind("parameter file", (".toml",), _is_unedited_parameter_file)
"""Parameter files of joints."""
HTML_FILE = FileKind("page", (".html", ".htm"))
"""HTML pages: reports, laboratory, figures."""
PICTURE_FILE = FileKind("picture", (".png", ".svg"))
"""Pictures of plots."""
ARCHIVE_FILE = FileKind("FMU or SSP archive", (".fmu", ".ssp"))
"""FMUs, and SSP archives of systems."""
EXPORTED_TEXT_FILE = FileKind(
    "text for another tool",
    (".bdf", ".cdb", ".comm", ".csv", ".inp", ".mac", ".mo", ".mjcf", ".urdf", ".xml"),
)
"""Text files for finite-element programs, Modelica tools and robot simulators."""
ACTUATOR_FILE = FileKind("list of actuators", (".json",))
"""Actuator parameters of a robot, for Isaac Lab."""
MESH_FILE = FileKind("mesh", (".vtu",))
"""Meshes with nodal results of finite elements."""
OUTPUT_FOLDER = FileKind("folder", ())
"""Folders into which several files are written."""
_PROGRAM_FILE_ENDINGS = {
    end
    for kind in (PARAMETER_FILE, HTML_FILE, PICTURE_FILE, ARCHIVE_FILE, EXPORTED_TEXT_FILE, MESH_FILE)
    for end in kind.file_name_endings
}
"""Endings of the names of all kinds of files that this program writes."""


def write_parameter_text(parameter_path: str | Path, file_text: str) -> None:
    """Write a parameter file, with a checksum in its first line to recognise later edits.

    Raises ValueError as `write_text` does.
    """
    write_text(parameter_path, f"# {PROGRAM_MARK}; checksum {_compute_checksum(file_text)}\n{file_text}")


def check_output(output_path: str | Path, file_kind: FileKind, overwrite: bool = False) -> None:
    """Raise ValueError, which names the path, if an output file must not or cannot be written.

    Errors are a folder, the ending of another kind of file, a write-protected file, a location that cannot be
    written, and, without `overwrite`, a file with content that the program did not write (InputRefusal). A
    device or pipe only has to be writable. Call it before long work; it leaves no file behind.
    """
    output_path = Path(output_path)
    if file_kind is OUTPUT_FOLDER:
        check_writable(output_path, output_path)
        return
    if output_path.is_dir():
        raise ValueError(f"{output_path}: is a folder; expected a file to write")
    if is_stream(output_path):
        if not os.access(output_path, os.W_OK):
            raise ValueError(
                f"{output_path}: cannot be written (Permission denied); expected a writable place"
            )
        return
    target = Path(os.path.realpath(output_path))
    for ending in (output_path.suffix.lower(), target.suffix.lower()):
        known = ending in _PROGRAM_FILE_ENDINGS or _FOREIGN_FILE_ENDING_PATTERN.fullmatch(ending)
        if known and ending not in file_kind.file_name_endings:
            allowed = " or ".join(file_kind.file_name_endings)
            raise ValueError(
                f"{output_path}: {ending} is the suffix of another kind of file; expected {allowed}"
            )
    try:
        if target.exists():
            if not os.access(target, os.W_OK):
                raise ValueError(f"{output_path}: is write-protected; expected another file")
            if not overwrite and target.stat().st_size and not file_kind.is_program_file(target):
                raise InputRefusal(
                    f"{output_path}: exists, and is not a {file_kind.name_in_messages} written by jointfmu, "
                    "or was edited; state another file, or force to replace it",
                    "force",
                )
    except OSError as error:
        raise ValueError(f"{output_path}: cannot be read ({error.strerror}); expected another file") from None
    check_writable(output_path, target.parent)


def check_outputs(output_paths: Iterable[Path], file_kind: FileKind, overwrite: bool = False) -> None:
    """Raise ValueError if one of several output files of one kind must not or cannot be written.

    Call it before long work. The errors are those of `check_output`.
    """
    for path in output_paths:
        check_output(path, file_kind, overwrite)


def is_same_file(first_path: Path, second_path: Path) -> bool:
    """Whether two paths lead to the same file, also through links.

    If one of them does not exist, names are compared without regard to case.
    """
    try:
        return os.path.samefile(first_path, second_path)
    except OSError:  # one of them does not exist yet
        return os.path.realpath(first_path).casefold() == os.path.realpath(second_path).casefold()
