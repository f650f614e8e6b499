"""A figure of the report; `figures(outcome)` in the file of a joint returns a list of them."""

from typing import NamedTuple


class Figure(NamedTuple):
    """Title, what is to be seen, the picture as an SVG element, and the CSV file beside the page, if any."""

    title: str
    text: str
    picture: str
    data: str | None = None
