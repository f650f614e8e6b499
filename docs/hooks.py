"""What the site needs beside mkdocs: pages link to files of the repository, which the site carries along."""

import posixpath
import re
from pathlib import Path
from runpy import run_path
from typing import Any

from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parent.parent
CARRIED = {"README.md": "readme.md", "CONTRIBUTING.md": "contributing.md"}
"""{text of the repository: page of the site that shows it}."""
LABORATORY = "laboratory/page.html"
"""Place of the laboratory in the site."""
REFERENCE = "reference.md"
"""Place of the reference of Python in the site."""
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(((?:\.\./)+[^)\s#]+)(#[^)\s]*)?\)")


def place(source: str, target: str) -> str | None:
    """Path in the repository that a page's link leads to, None if it stays in the pages."""
    path = posixpath.normpath(posixpath.join("docs", posixpath.dirname(source), target))
    return None if path.startswith("docs/") else path


def address(path: str) -> str:
    """Address in the site of a file of the repository."""
    if path in CARRIED:
        return CARRIED[path]
    return f"files/{path}.txt" if path.endswith((".md", ".py")) else f"files/{path}"


def carried(name: str) -> str:
    """A text of the repository as a page in `docs`."""
    text = (ROOT / name).read_text(encoding="utf-8").replace("](docs/", "](")
    outside = r"\]\((?!https?:|#)([\w./-]+)\)"
    return re.sub(
        outside,
        lambda link: link[0] if (ROOT / "docs" / link[1]).exists() else f"](../{link[1]})",
        text,
    )


def laboratory() -> str:
    """The page of the main job, else made here."""
    made = ROOT / "dist" / "report" / "laboratory.html"
    if made.is_file():
        return made.read_text(encoding="utf-8")
    from jointfmu_tools.laboratory.assemble import page

    return page()


def reference() -> str:
    """What `docs/reference.py` writes; the folder of the pages is no package."""
    return str(run_path(str(Path(__file__).with_name("reference.py")))["page"]())


def on_files(files: Any, config: Any) -> Any:
    """Add the laboratory, the reference, the texts of the repository that are pages, and every other linked
    file as `files/PATH`."""
    files.append(File.generated(config, LABORATORY, content=laboratory()))
    files.append(File.generated(config, REFERENCE, content=reference()))
    for name, page in CARRIED.items():
        files.append(File.generated(config, page, content=carried(name)))
    linked = set()
    for page in files.documentation_pages():
        for _, target, _ in _LINK.findall(page.content_string):
            path = place(page.src_uri, target)
            if path and path not in CARRIED and (ROOT / path).is_file():
                linked.add(path)
    for path in sorted(linked):
        files.append(File.generated(config, address(path), content=(ROOT / path).read_bytes()))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Lead links out of `docs` to what the site carries; a folder has no page and loses its link."""
    here = posixpath.dirname(page.file.src_uri) or "."

    def lead(match: re.Match[str]) -> str:
        text, target, anchor = match.groups()
        path = place(page.file.src_uri, target)
        if path is None or not (ROOT / path).exists():
            return match[0]
        if (ROOT / path).is_dir():
            return text
        return f"[{text}]({posixpath.relpath(address(path), here)}{anchor or ''})"

    return _LINK.sub(lead, markdown)
