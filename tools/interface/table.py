"""Numbers with their units as a table: text at a prompt, HTML in a notebook."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

LONGEST = 60
"""Letters of a cell at a prompt; a notebook shows all."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells under a title and heads; `lines` stand between title and rows.

    >>> import jointfmu
    >>> table = jointfmu.load("GearContact").parameters
    >>> table.heads
    ('name', 'value', 'unit', 'meaning', 'kind', 'source')
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    lines: Sequence[str] = ()

    def __str__(self) -> str:
        cells = [[_cut(cell) for cell in row] for row in (self.heads, *self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        rows = ("  ".join(f"{c:{w}}" for c, w in zip(row, widths, strict=True)).rstrip() for row in cells)
        return "\n".join([self.title, *self.lines, *rows])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """The table for a notebook."""
        head = "".join(f"<th>{escape(cell)}</th>" for cell in self.heads)
        body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in self.rows)
        lines = "".join(f"<div>{escape(line)}</div>" for line in self.lines)
        return (
            f"<div><b>{escape(self.title)}</b></div>{lines}"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        )


def _cut(cell: str) -> str:
    return cell if len(cell) <= LONGEST else f"{cell[: LONGEST - 3]}..."
