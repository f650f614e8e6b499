"""Names quoted in docstrings, comments and documentation exist in the code."""

import ast
import builtins
import functools
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("benchmarks", "core", "docs", "examples", "fmu_src", "models", "studies", "tests", "tools")
CODE_SUFFIXES = {".c", ".h", ".html", ".js", ".json", ".mo", ".py", ".toml"}
WORD = re.compile(r"[A-Za-z_]\w*")
C_COMMENT = re.compile(r"/\*.*?\*/|//.*?$", re.DOTALL | re.MULTILINE)
PROSE = {
    ".py": re.compile(r'^ *r?""".*?"""|(?:^|(?<=\s))# .*?$', re.DOTALL | re.MULTILINE),
    ".c": C_COMMENT,
    ".h": C_COMMENT,
}
"""Docstrings and comments, by the ending of the file."""
CODE_BLOCK = re.compile(r"^ *```.*?^ *```", re.DOTALL | re.MULTILINE)
QUOTED_NAME = re.compile(r"(?<!`)`[A-Za-z_][\w.]*(?:\(\))?`(?!`)|\b[A-Z]{2,}(?:_[A-Z]{2,})+\b")
"""A name in backticks, or of a constant in capital letters."""
LISTED_NAMES = re.compile(r"^ *(\*{0,2}[A-Za-z_]\w*(?:, \*{0,2}[A-Za-z_]\w*)*) +: ", re.MULTILINE)
"""Names at the start of a line `name : meaning` of a docstring."""
PLACEHOLDER = re.compile(r"(?<![A-Z])(NAME|COMMAND|COMPONENT|FLANGE|PREFIX|ROBOT|SYSTEM)(?![A-Z])")
"""Words in capital letters that stand for any name, as in `NAME_ref.csv`."""
ABOUT_OTHER_PROGRAMS = ROOT / "docs" / "tools"
NAMES_OF_OTHER_PROGRAMS = {
    "chroot",
    "debootstrap",
    "eulerdamp",
    "gbode",
    "FMI2_FUNCTION_PREFIX",
    "FMI3_FUNCTION_PREFIX",
    "fmi3CompletedIntegratorStep",
    "fmi3SetContinuousStates",
    "LC_CODE_SIGNATURE",
    "LC_UUID",
    "LIAISON_SOLIDE",
    "NSLE",
    "parse_component",
    "prefer",
    "pypi",
    "pyssp_standard",
}
SYMBOLS = {"a_L", "a_c", "s_pc", "eps_alpha", "alpha_wt", "h_fP", "K_joint", "vX"}
"""Symbols of papers, standards and equations of the pages, and the version vX.Y.Z."""


def blank(match: re.Match[str]) -> str:
    """Empty lines in place of the matched text, so that line numbers stay right."""
    return "\n" * match[0].count("\n")


@functools.cache
def find_files() -> list[Path]:
    found = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*"))]
    return [p for p in (*found, ROOT / "CONTRIBUTING.md") if p.suffix in (*CODE_SUFFIXES, ".md")]


@functools.cache
def split_file(path: Path) -> tuple[str, list[tuple[int, str]]]:
    """Code of a file, and its texts for readers with their first line."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        return "\n".join(CODE_BLOCK.findall(text)), [(1, CODE_BLOCK.sub(blank, text))]
    prose = PROSE.get(path.suffix)
    if prose is None:
        return text, []
    found = [(text.count("\n", 0, match.start()) + 1, match[0]) for match in prose.finditer(text)]
    return prose.sub(blank, text), found


@functools.cache
def known_words() -> frozenset[str]:
    """Words of the code and of file names."""
    words = {*dir(builtins), *NAMES_OF_OTHER_PROGRAMS, *SYMBOLS}
    for path in find_files():
        words.update(WORD.findall(path.relative_to(ROOT).as_posix()), WORD.findall(split_file(path)[0]))
    return frozenset(words)


@functools.cache
def is_known(word: str) -> bool:
    """Whether the code has the word, also in lower case, or its beginning up to an underscore (f-strings)."""
    beginnings = (word[: match.end()] for match in re.finditer("_", word))
    return bool({word, word.lower(), *beginnings} & known_words())


def test_quoted_names_exist() -> None:
    unknown = [
        f"{path.relative_to(ROOT)}:{line + text.count(chr(10), 0, match.start())} {match[0]}"
        for path in find_files()
        if ABOUT_OTHER_PROGRAMS not in path.parents
        for line, text in split_file(path)[1]
        for match in QUOTED_NAME.finditer(text)
        if not PLACEHOLDER.search(match[0]) and not all(map(is_known, WORD.findall(match[0])))
    ]
    assert not unknown, "\n".join(
        ["names in docstrings, comments or pages that the code does not have:", *unknown]
    )


def find_definitions(node: ast.AST) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    for child in getattr(node, "body", []):
        if isinstance(child, ast.FunctionDef | ast.ClassDef):
            yield child
        yield from find_definitions(child)


def own_names(node: ast.FunctionDef | ast.ClassDef) -> set[str]:
    """Parameters of a function; fields, methods, attributes and parameters of `__init__` of a class."""
    if isinstance(node, ast.FunctionDef):
        return {child.arg for child in ast.walk(node.args) if isinstance(child, ast.arg)}
    names = {child.attr for child in ast.walk(node) if isinstance(child, ast.Attribute)}
    for child in node.body:
        if isinstance(child, ast.AnnAssign):
            names.add(ast.unparse(child.target))
        elif isinstance(child, ast.FunctionDef):
            names |= {child.name, *(own_names(child) if child.name == "__init__" else ())}
    return names


def test_listed_names_exist() -> None:
    """Lists of a docstring name parameters, fields, exceptions, or strings of the file (choices, keys)."""
    unknown = []
    for path in (p for p in find_files() if p.suffix == ".py"):
        code, texts = split_file(path)
        if not any(LISTED_NAMES.search(text) for _, text in texts):
            continue
        for node in find_definitions(ast.parse(path.read_text(encoding="utf-8"))):
            listed = {
                name
                for names in LISTED_NAMES.findall(ast.get_docstring(node) or "")
                for name in re.findall(r"\w+", names)
                if f'"{name}"' not in code and not hasattr(builtins, name)
            }
            if listed and (extra := listed - own_names(node)):
                unknown.append(
                    f"{path.relative_to(ROOT)}:{node.lineno} {node.name}: {', '.join(sorted(extra))}"
                )
    assert not unknown, "\n".join(
        ["names in lists of docstrings that the definition does not have:", *unknown]
    )
