"""Texts in parameter files: allowed characters and lengths, and TOML strings."""

import json
import re
from collections.abc import Iterator, Mapping

MAX_NAME_LENGTH = 200
"""Largest number of characters [1] of the name of a parameter set or system, and of a key."""
MAX_TEXT_LENGTH = 10_000
"""Largest number of characters [1] of any other text in a file."""
_FORBIDDEN_CHARACTERS = re.compile("[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
"""Control characters, line separators, marks of the writing direction, and characters invalid in XML."""


def check_text(text_role: str, text: str, max_length: int = MAX_TEXT_LENGTH) -> None:
    """Raise ValueError, one line, if a text is too long or has a control character.

    text_role : what the text is, for the error
    """
    if len(text) > max_length:
        raise ValueError(f"{text_role} has {len(text)} characters; allowed are at most {max_length}")
    if found := _FORBIDDEN_CHARACTERS.search(text):
        raise ValueError(
            f"{text_role} has the control character U+{ord(found[0]):04X} at position {found.start() + 1}; "
            "expected one line of printable text"
        )


def replace_unprintable(text: str) -> str:
    """Replace characters that `check_text` does not allow by question marks: for texts of other programs."""
    return _FORBIDDEN_CHARACTERS.sub("?", text)


def check_document(document: Mapping[str, object]) -> None:
    """Raise ValueError if `check_text` does not allow a key or a text of a TOML document."""
    for name, key, value in _iterate_document_items(document, ""):
        check_text(f"a key of {name or 'the file'}", key, MAX_NAME_LENGTH)
        if isinstance(value, str):
            full_name = f"{name}.{key}" if name else key
            check_text(full_name, value, MAX_NAME_LENGTH if full_name == "name" else MAX_TEXT_LENGTH)


def format_toml_string(text: str) -> str:
    """Format a text as a basic string of TOML: with the escapes of JSON, and DEL escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _iterate_document_items(document_value: object, table_name: str) -> Iterator[tuple[str, str, object]]:
    """Yield (table name, key, value) of each item of a TOML document; items of a list have the list's key."""
    if isinstance(document_value, Mapping):
        for key, item in document_value.items():
            yield table_name, key, item
            yield from _iterate_document_items(item, f"{table_name}.{key}" if table_name else key)
    elif isinstance(document_value, list):
        head, _, key = table_name.rpartition(".")
        for item in document_value:
            if isinstance(item, str):
                yield head, key, item
            elif isinstance(item, Mapping | list):
                yield from _iterate_document_items(item, table_name)
