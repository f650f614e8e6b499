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


def check_text(text_description: str, checked_text: str, max_length: int = MAX_TEXT_LENGTH) -> None:
    """Raise ValueError, one line, if a text is too long or has a control character.

    text_description : what the text is, for the error
    """
    if len(checked_text) > max_length:
        raise ValueError(
            f"{text_description} has {len(checked_text)} characters; allowed are at most {max_length}"
        )
    if found := _FORBIDDEN_CHARACTERS.search(checked_text):
        raise ValueError(
            f"{text_description} has the control character U+{ord(found[0]):04X} at position "
            f"{found.start() + 1}; expected one line of printable text"
        )


def replace_unprintable(foreign_text: str) -> str:
    """Replace characters that `check_text` does not allow by question marks: for texts of other programs."""
    return _FORBIDDEN_CHARACTERS.sub("?", foreign_text)


def check_toml_texts(toml_document: Mapping[str, object]) -> None:
    """Raise ValueError if a key or text of a TOML document is too long or has a control character."""
    for name, key, value in _iterate_document_items(toml_document, ""):
        check_text(f"a key of {name or 'the file'}", key, MAX_NAME_LENGTH)
        if isinstance(value, str):
            full_name = f"{name}.{key}" if name else key
            check_text(full_name, value, MAX_NAME_LENGTH if full_name == "name" else MAX_TEXT_LENGTH)


def format_toml_string(string_content: str) -> str:
    """Format a text as a basic string of TOML: with the escapes of JSON, and DEL escaped."""
    return json.dumps(string_content, ensure_ascii=False).replace("\x7f", "\\u007f")


def _iterate_document_items(toml_value: object, toml_table_name: str) -> Iterator[tuple[str, str, object]]:
    """Yield (table name, key, value) of each item of a TOML document; items of a list have the list's key."""
    if isinstance(toml_value, Mapping):
        for key, item in toml_value.items():
            yield toml_table_name, key, item
            yield from _iterate_document_items(item, f"{toml_table_name}.{key}" if toml_table_name else key)
    elif isinstance(toml_value, list):
        head, _, key = toml_table_name.rpartition(".")
        for item in toml_value:
            if isinstance(item, str):
                yield head, key, item
            elif isinstance(item, Mapping | list):
                yield from _iterate_document_items(item, toml_table_name)
