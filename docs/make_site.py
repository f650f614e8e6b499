"""Write the site (Zensical, configured by mkdocs.yml): `python docs/make_site.py --out FOLDER`.

Pages link to files of the repository, so they are laid out in a folder together with what the site carries
along: linked files, README and CONTRIBUTING as pages, the laboratory, the reference of Python, the examples
with their output."""

import argparse
import posixpath
import re
import shutil
import subprocess
import sys
from pathlib import Path
from runpy import run_path
from tempfile import TemporaryDirectory

from notebooks import EXAMPLES, write_page

ROOT = Path(__file__).resolve().parent.parent
PAGE_OF_TEXT = {"README.md": "readme.md", "CONTRIBUTING.md": "contributing.md"}
"""{text of the repository: page of the site that shows it}."""
PAGES_OF_FILES = PAGE_OF_TEXT | {f"examples/{p.name}": f"examples/{p.stem}.md" for p in EXAMPLES}
"""{file of the repository: page of the site that shows it}."""
LABORATORY = "laboratory/page.html"
"""Path of the laboratory page in the site."""
SCRIPTS = {"reference.md": "reference.py", "variables.md": "variables.py"}
"""{page of the site: script in this folder whose function `page` writes it}."""
SITE = "site"
"""Folder into which mkdocs.yml builds the site."""
POLICY = "; ".join(
    [
        "default-src 'none'",
        "script-src 'self' file: blob: 'unsafe-inline'",
        "style-src 'self' file: 'unsafe-inline'",
        "img-src 'self' file: data:",
        "font-src 'self' file:",
        "connect-src 'self' file:",
        "worker-src 'self' file: blob:",
        "frame-src 'self' file:",
        "base-uri 'none'",
        "form-action 'self'",
    ]
)
"""Content-Security-Policy of a page: connections only to the site itself. `file:` is for a site opened from a
disk."""
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(((?:\.\./)+[^)\s#]+)(#[^)\s]*)?\)")


def repository_path(source: str, target: str) -> str | None:
    """Path in the repository to which a link of a page leads; None if the link stays inside the pages."""
    path = posixpath.normpath(posixpath.join("docs", posixpath.dirname(source), target))
    return None if path.startswith("docs/") else path


def site_path(path: str) -> str:
    """Address of a repository file in the site."""
    if path in PAGES_OF_FILES:
        return PAGES_OF_FILES[path]
    return f"files/{path}.txt" if path.endswith((".md", ".py")) else f"files/{path}"


def convert_text(name: str) -> str:
    """Text of the repository as a page in `docs`."""
    text = (ROOT / name).read_text(encoding="utf-8").replace("](docs/", "](")
    outside = r"\]\((?!https?:|#)([\w./-]+)\)"
    return re.sub(
        outside,
        lambda link: link[0] if (ROOT / "docs" / link[1]).exists() else f"](../{link[1]})",
        text,
    )


def laboratory() -> str:
    """Laboratory page of the main job; it is made if it does not exist."""
    made = ROOT / "dist" / "report" / "laboratory.html"
    if made.is_file():
        return made.read_text(encoding="utf-8")
    from jointfmu_tools.pages.laboratory.assemble import render_page

    return render_page()


def page_of(script: str) -> str:
    """Page that a script of this folder writes; the script is loaded by its path."""
    return str(run_path(str(Path(__file__).with_name(script)))["page"]())


def redirect_links(markdown: str, source: str) -> tuple[str, set[str]]:
    """Page with its links out of `docs` led to files of the site, and the list of these files. Links to
    folders are removed."""
    here, linked = posixpath.dirname(source) or ".", set()

    def convert_lead_link(match: re.Match[str]) -> str:
        text, target, anchor = match.groups()
        path = repository_path(source, target)
        if path is None or not (ROOT / path).exists():
            return match[0]
        if (ROOT / path).is_dir():
            return str(text)
        if path not in PAGES_OF_FILES:
            linked.add(path)
        return f"[{text}]({posixpath.relpath(site_path(path), here)}{anchor or ''})"

    return _LINK.sub(convert_lead_link, markdown), linked


def copy_inputs(docs: Path, notebooks: Path | None) -> None:
    """Copy all inputs of the site generator into the folder `docs`.

    notebooks : folder with notebooks of the examples that were run before
    """
    shutil.copytree(ROOT / "docs", docs, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    made = {LABORATORY: laboratory()} | {page: page_of(script) for page, script in SCRIPTS.items()}
    made |= {page: convert_text(name) for name, page in PAGE_OF_TEXT.items()}
    for page_path, text in made.items():
        (docs / page_path).parent.mkdir(exist_ok=True)
        (docs / page_path).write_text(text, encoding="utf-8")
    (docs / "examples").mkdir()
    for script in EXAMPLES:
        write_page(script, docs / "examples", notebooks)
    for page in sorted(docs.rglob("*.md")):
        text, linked = redirect_links(page.read_text(encoding="utf-8"), page.relative_to(docs).as_posix())
        page.write_text(text, encoding="utf-8")
        for path in linked:
            copy = docs / site_path(path)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / path, copy)


def add_policy(site: Path) -> None:
    """Add the Content-Security-Policy to all pages that have none."""
    tag = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        if "Content-Security-Policy" not in text:
            page.write_text(
                re.sub(r"<head[^>]*>", lambda head: head[0] + tag, text, count=1), encoding="utf-8"
            )


def build(out: Path, notebooks: Path | None) -> int:
    """Build the site into the folder `out`; returns the exit status of the generator, which fails for broken
    links."""
    with TemporaryDirectory() as name:
        work = Path(name)
        copy_inputs(work / "docs", notebooks)
        shutil.copy(ROOT / "mkdocs.yml", work)
        done = subprocess.run([sys.executable, "-m", "zensical", "build", "--strict"], cwd=work)
        if done.returncode == 0:
            add_policy(work / SITE)
            shutil.copytree(work / SITE, out, dirs_exist_ok=True)
        return done.returncode


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--out",
        type=Path,
        default=ROOT / "dist/docs",
        metavar="FOLDER",
        help="folder to write (default: dist/docs)",
    )
    parser.add_argument(
        "--notebooks",
        type=Path,
        metavar="FOLDER",
        help="folder with notebooks that have output, as in dist/docs/examples; only the other examples are "
        "run",
    )
    arguments = parser.parse_args()
    sys.exit(build(arguments.out, arguments.notebooks))
