"""Read contact pressure from Abaqus field reports (.rpt) and data files (.dat), meshes from decks (.inp).

A field report of Abaqus/CAE names the part of its nodes. A line of dashes separates the column names from the
rows. If the page is too narrow for all columns, names and rows continue in the next line. A data file of
Abaqus/Standard has the column names after NODE. Its rows may contain a status (CL, OP), rows of zeros are
left out, and each increment repeats the tables. If there are several frames (increments), the last one with a
pressure is read. An input deck (of Abaqus or CalculiX, without parts) gives nodes and elements.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jointfmu.quantity.refusal import InputRefusal

from .mesh import CELL_NODE_COUNTS, FiniteElementMesh
from .nodal_result import LISTING_NUMBER_PATTERN, NodalResult, read_result_lines

PRESSURE_COLUMN, AREA_COLUMN = "CPRESS", "CNAREA"
_COORDINATE_COLUMNS = ("COOR1", "COOR2", "COOR3")
"""Names of the columns with the coordinates of a node."""
_COLUMN_NAME_PATTERN = re.compile(r"[A-Z]+\d*(?:\..*)?")
"""Pattern of the name of a column."""
_SUMMARY_WORDS = ("MINIMUM", "MAXIMUM", "TOTAL")
"""First words of the lines below a table with its extreme values."""


class ListingRow(NamedTuple):
    """Row of a listing (text output of the solver): values at one node.

    file_and_line      : file and line
    step_and_increment : step and increment
    part_instance      : part instance of the node
    node_number        : number of the node
    column_values      : {column: value}; a vector has one column for each component
    """

    file_and_line: str
    step_and_increment: str
    part_instance: str
    node_number: int
    column_values: dict[str, float]


class NodalValues(NamedTuple):
    """Nodal values of one frame (increment) of an Abaqus result: {(part instance, node): value}.

    The values are in the units of the file.
    """

    pressure_by_node: dict[tuple[str, int], float]
    area_by_node: dict[tuple[str, int], float]
    position_by_node: dict[tuple[str, int], tuple[float, ...]]


def read_abaqus(result_paths: Sequence[Path], length_unit: float, pressure_unit: float) -> NodalResult:
    """Read a nodal contact result from Abaqus listings (text output): field reports or data files.

    Coordinates and nodal areas come from the listings, or from an input deck among the files.

    length_unit, pressure_unit : size of the files' length unit [m] and pressure unit [Pa]

    Raises ValueError with file and line: the file cannot be read, a column is missing, a row does not fit its
    columns, a node has two values.
    """
    path, meshes = result_paths[0], [p for p in result_paths[1:] if p.suffix.lower() == ".inp"]
    values, left_out = _read_last_frame([p for p in result_paths if p not in meshes])
    if not values.pressure_by_node:
        raise ValueError(
            f"{path}: has no contact pressure; expected a column {PRESSURE_COLUMN} with values at nodes "
            "(Unique Nodal)"
        )
    if meshes:
        return _combine_pressures_with_deck(path, meshes[0], values, left_out, length_unit, pressure_unit)
    for table, text in (
        (values.position_by_node, "no coordinates, columns COOR1, COOR2 and COOR3 (COORD)"),
        (values.area_by_node, f"no nodal areas, a column {AREA_COLUMN}"),
    ):
        if not any(table.values()):
            raise InputRefusal(f"{path}: has {text}; list them too, or give the input deck (.inp)", "beside")
    nodes = sorted(key for key, area in values.area_by_node.items() if area > 0.0)
    if missing := [key for key in nodes if key not in values.position_by_node]:
        raise ValueError(
            f"{path}: node {missing[0][1]} has an area, but no coordinates; list them for all nodes"
        )
    absent = 0.0 if left_out else np.nan
    return NodalResult(
        result_path=path,
        node_label="node",
        node_numbers=np.array([node for _, node in nodes], dtype=np.int64),
        node_positions=np.array([values.position_by_node[key] for key in nodes]).reshape(-1, 3) * length_unit,
        nodal_pressure=np.array([values.pressure_by_node.get(key, absent) for key in nodes]) * pressure_unit,
        nodal_area=np.array([values.area_by_node[key] for key in nodes]) * length_unit**2,
    )


def _combine_pressures_with_deck(
    listing_path: Path,
    deck_path: Path,
    listed_nodal_values: NodalValues,
    omits_open_nodes: bool,
    length_unit: float,
    pressure_unit: float,
) -> NodalResult:
    """Build the nodal result from listed pressures and the mesh of an input deck."""
    instances = sorted({instance for instance, _ in listed_nodal_values.pressure_by_node})
    if len(instances) > 1:
        text = (
            f"{listing_path}: lists nodes of {len(instances)} parts ({', '.join(instances)}), but an input "
            "deck has one numbering; list coordinates and areas in place of the deck"
        )
        raise InputRefusal(text, "beside")
    mesh = read_input_deck(deck_path)
    pressures = {node: value for (_, node), value in listed_nodal_values.pressure_by_node.items()}
    if stray := mesh.find_unknown_nodes(pressures):
        raise ValueError(
            f"{listing_path}: node {min(stray)} has a pressure, but is not in {deck_path}; expected the mesh "
            "of the same model"
        )
    return mesh.build_nodal_result(listing_path, pressures, length_unit, pressure_unit, omits_open_nodes)


def _read_last_frame(result_paths: Sequence[Path]) -> tuple[NodalValues, bool]:
    """Read pressures and areas of the last frame with a pressure, and the last coordinates, from listings.

    The second result tells whether a file leaves out rows of zeros.
    """
    frames: dict[str, NodalValues] = {}
    last, left_out = "", False
    coordinates: dict[tuple[str, int], tuple[float, ...]] = {}
    for path in result_paths:
        lines = read_result_lines(path, "an Abaqus listing")
        report = any(line.lstrip().startswith("Field Output") for line in lines)
        left_out |= not report
        for row in _read_report_rows(path, lines) if report else _read_data_file_rows(path, lines):
            frame = frames.setdefault(row.step_and_increment, NodalValues({}, {}, {}))
            key = row.part_instance, row.node_number
            for name, table in ((PRESSURE_COLUMN, frame.pressure_by_node), (AREA_COLUMN, frame.area_by_node)):
                if (
                    name in row.column_values
                    and table.setdefault(key, row.column_values[name]) != row.column_values[name]
                ):
                    raise ValueError(
                        f"{row.file_and_line}: node {row.node_number} has a second {name}, expected one"
                    )
            if all(name in row.column_values for name in _COORDINATE_COLUMNS):
                frame.position_by_node[key] = coordinates[key] = tuple(
                    row.column_values[name] for name in _COORDINATE_COLUMNS
                )
            if PRESSURE_COLUMN in row.column_values:
                last = row.step_and_increment
    values = frames.get(last, NodalValues({}, {}, {}))
    return NodalValues(
        values.pressure_by_node, values.area_by_node, coordinates | values.position_by_node
    ), left_out


def _read_report_rows(listing_path: Path, listing_lines: list[str]) -> Iterator[ListingRow]:
    """Read the rows of the nodal tables of an Abaqus field report; tables by element are ignored."""
    step = frame = instance = ""
    head: list[str] | None = None  # lines between the name of the part and the rows
    columns: list[str] = []
    words: list[str] = []  # words of a row that continues in the next line
    for number, line in enumerate(listing_lines, 1):
        text, location = line.strip(), f"{listing_path}: line {number}"
        if text.startswith("Step:"):
            step = text
        elif text.startswith("Frame:"):
            frame = text
        elif text.startswith("Field Output"):
            head, columns, words = None, [], []
            if text.startswith("Field Output reported at nodes for"):
                head, instance = [], text.split(":", 1)[-1].strip().split(".")[0]
        elif text and set(text) == {"-"} and head:
            columns, head = [*columns, *_read_column_names(location, head)], []
        elif not text or text.upper().startswith(_SUMMARY_WORDS):
            columns = [] if text else columns
        elif columns and LISTING_NUMBER_PATTERN.fullmatch(text.split()[0]):
            words += text.split()
            head = None
            if len(words) > len(columns):
                yield _parse_listing_row(location, f"{step} {frame}", instance, columns, words)
                words = []
        elif head is not None and (columns or head or text.startswith("Node")):
            head.append(text)


def _read_column_names(file_and_line: str, table_head_lines: Sequence[str]) -> list[str]:
    """Read the column names in the head of a table: names in the first line, locations (@Loc 1) in the next.

    A name may be followed by the name of a contact pair, as in CPRESS  ASSEMBLY_A/ASSEMBLY_B.
    """
    words = [word for word in table_head_lines[0].split() if word not in ("Node", "Label")]
    names: list[str] = []
    for word in words:
        if names and not _COLUMN_NAME_PATTERN.fullmatch(word):
            names[-1] += f" {word}"
        else:
            names.append(word)
    count = sum(line.count("@Loc") for line in table_head_lines)
    if count not in (0, len(names)):
        raise ValueError(
            f"{file_and_line}: has {count} columns, but its headings cannot be assigned to them: "
            f"{' '.join(words)}"
        )
    columns = [_standardise_column_name(name) for name in names]
    if columns.count(PRESSURE_COLUMN) > 1:
        raise ValueError(
            f"{file_and_line}: has {columns.count(PRESSURE_COLUMN)} columns {PRESSURE_COLUMN}, expected one "
            "contact pair"
        )
    return columns


def _standardise_column_name(column_heading: str) -> str:
    """Standard name of a column: COOR1 for COORD.COOR1, CPRESS for CPRESS with a contact pair."""
    first = column_heading.split()[0]
    return first.removeprefix("COORD.") if first.startswith("COORD.") else first


def _parse_listing_row(
    file_and_line: str,
    step_and_increment: str,
    part_instance: str,
    column_names: Sequence[str],
    row_words: Sequence[str],
) -> ListingRow:
    """Parse one row of a listing: a node and a number for each column; ValueError for any other line."""
    numbers = row_words[-len(column_names) :]
    if (
        not row_words[0].isdigit()
        or len(row_words) != len(column_names) + 1
        or not all(map(LISTING_NUMBER_PATTERN.fullmatch, numbers))
    ):
        raise ValueError(
            f"{file_and_line}: {' '.join(row_words)!r} is not a row with a node number and a number for each "
            f"column: {' '.join(column_names)}"
        )
    values = [float(word.upper().replace("D", "E")) for word in numbers]
    return ListingRow(
        file_and_line,
        step_and_increment,
        part_instance,
        int(row_words[0]),
        dict(zip(column_names, values, strict=True)),
    )


def _read_data_file_rows(listing_path: Path, listing_lines: list[str]) -> Iterator[ListingRow]:
    """Read the rows of the nodal tables of an Abaqus data file."""
    step = increment = ""
    columns: list[str] = []
    for number, line in enumerate(listing_lines, 1):
        words = line.split()
        if not words:
            continue
        if words[:4] == ["S", "T", "E", "P"]:
            step, columns = " ".join(words[4:5]), []
        elif words[0] == "INCREMENT" and words[-1] == "SUMMARY":
            increment, columns = words[1], []
        elif words[0] == "NODE" and "FOOT-" in words:
            columns = [word for word in words if word not in ("NODE", "FOOT-", "STATUS")]
        elif words[0] in _SUMMARY_WORDS or "TABLE" in words:
            columns = []
        elif columns and words[0].isdigit() and len(words) > 1:
            numbers = [word for word in words if not word.isalpha()]  # without the status CL or OP
            yield _parse_listing_row(
                f"{listing_path}: line {number}", f"{step} {increment}", "", columns, numbers
            )


_SOLID_ELEMENT_NAME_PATTERN = re.compile(r"(?:AC3D|DC3D|C3D)(\d+)")
"""Pattern of the type name of a solid element: its number of nodes."""
_SHELL_ELEMENT_NAME_PATTERN = re.compile(r"(?:S|SC|R3D|M3D|SFM3D|STRI|CPS|CPE|CPEG|CAX)(\d+)")
"""Pattern of the type name of a shell or plane element: its number of nodes."""
SOLID_CELL_TYPES = {
    4: "tetra",
    5: "pyramid",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    15: "wedge15",
    20: "hexahedron20",
}
"""Cell types of meshio of solid elements, by the number of nodes in the name of the element."""
SHELL_CELL_TYPES = {3: "triangle", 4: "quad", 6: "triangle6", 65: "triangle6", 8: "quad8"}
"""Cell types of meshio by the number of nodes in the name of an element; the node order is the same."""
UNSUPPORTED_DECK_KEYWORDS = (
    "INSTANCE",
    "INCLUDE",
    "NGEN",
    "NCOPY",
    "NFILL",
    "ELGEN",
    "ELCOPY",
    "SYSTEM",
    "NMAP",
)
"""Keywords that are an error: they create or move nodes or elements outside of *NODE and *ELEMENT."""


def read_input_deck(deck_path: Path) -> FiniteElementMesh:
    """Read the mesh of an input deck (of Abaqus or CalculiX): solids, or shells if there are no solids.

    Other elements are ignored.

    Raises ValueError with file and line: no input deck, an unsupported keyword, a line that cannot be read,
    an element with an undefined node.
    """
    coordinates: dict[int, tuple[float, float, float]] = {}
    rows: dict[str, list[list[int]]] = {}
    open_row: list[int] = []  # a row that continues in the next line, after a comma at its end
    for number, keyword, kind, words in _read_deck_lines(deck_path):
        try:
            if keyword == "NODE":
                x, y, z = (float(word or 0.0) for word in (*words[1:4], "", "")[:3])
                coordinates[int(words[0])] = x, y, z
                continue
            row = [*open_row, *(int(word) for word in words if word)]
        except ValueError:
            row = []
        size = 1 + CELL_NODE_COUNTS.get(kind, 0)
        open_row = row if words[-1] == "" and 0 < len(row) < size else []
        if not open_row and len(row) != size:
            expected = f"an element number and {size - 1} nodes" if kind else "a node number and coordinates"
            raise ValueError(
                f"{deck_path}: line {number}: {', '.join(words)!r} is not a line of *{keyword}; "
                f"expected {expected}"
            )
        if not open_row:
            rows.setdefault(kind, []).append(row[1:])
    if not coordinates or not rows:
        raise ValueError(
            f"{deck_path}: has no nodes and elements, expected an input deck with *NODE and *ELEMENT"
        )
    names = np.array(list(coordinates), dtype=np.int64)
    return FiniteElementMesh.from_elements(deck_path, names, np.array(list(coordinates.values())), rows)


def _read_deck_lines(deck_path: Path) -> Iterator[tuple[int, str, str, list[str]]]:
    """Yield data lines of *NODE and *ELEMENT in an input deck.

    Each is (line number, keyword, cell type of meshio, words).
    """
    keyword = kind = ""
    for number, line in enumerate(read_result_lines(deck_path, "an input deck"), 1):
        if not line.strip() or line.startswith("**"):
            continue
        words = [word.strip() for word in line.split(",")]
        if line.startswith("*"):
            keyword, kind = words[0][1:].upper(), _find_cell_type(words[1:])
            if keyword in UNSUPPORTED_DECK_KEYWORDS:
                raise ValueError(
                    f"{deck_path}: line {number}: has *{keyword}, expected a deck whose nodes and elements "
                    "are listed once, in one numbering (Abaqus/CAE: do not use parts and assemblies)"
                )
        elif keyword == "NODE" or (keyword == "ELEMENT" and kind):
            yield number, keyword, kind, words


def _find_cell_type(keyword_parameters: list[str]) -> str:
    """Cell type of meshio for TYPE of *ELEMENT in an input deck; empty if it is not supported."""
    values = (p.split("=")[1].strip().upper() for p in keyword_parameters if p.upper().startswith("TYPE"))
    name = next(values, "")
    for pattern, kinds in (
        (_SOLID_ELEMENT_NAME_PATTERN, SOLID_CELL_TYPES),
        (_SHELL_ELEMENT_NAME_PATTERN, SHELL_CELL_TYPES),
    ):
        if match := pattern.match(name):
            return kinds.get(int(match[1]), "")
    return ""
