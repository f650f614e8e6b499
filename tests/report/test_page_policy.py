"""Content security policy of all pages: no network, and no script but the page's own."""

import re
from base64 import b64encode
from hashlib import sha256
from html import unescape
from pathlib import Path

import pytest
from browser import browser
from clients import needs
from jointfmu_fmu_src.native.page import make_documentation
from jointfmu_fmu_src.partners import PARTNERS
from jointfmu_fmu_src.partners.models import load_partner_parameters
from jointfmu_fmu_src.templates import load_jinja_template
from jointfmu_tools.pages.laboratory.assemble import write_laboratory
from jointfmu_tools.pages.report import figure
from jointfmu_tools.pages.report.joint import write_joint_report

from jointfmu.joints import KINDS
from jointfmu.parameters import load_default

ROOT = Path(__file__).resolve().parents[2]
ALLOWED = {"'none'", "'unsafe-inline'", "'wasm-unsafe-eval'", "data:", "'self'", "file:"}
WATCH = """(() => { const seen = [];
  addEventListener("securitypolicyviolation", (e) => seen.push(e.effectiveDirective));
  window.seen = seen; })()"""

INTRUDERS = """(() => { const image = "<img src=https://example.org/a onerror=seen.push(0)>";
  document.body.insertAdjacentHTML("beforeend", image);
  document.body.append(Object.assign(document.createElement("script"), { text: "seen.push(1)" })); })()"""


def policy(page: str) -> dict[str, list[str]]:
    """Directives of the content security policy of a page."""
    (content,) = re.findall(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', page)
    return {words[0]: words[1:] for words in (part.split() for part in unescape(content).split(";"))}


def check(page: str) -> None:
    """Assert that the policy precedes scripts and styles, and names the page's own script by its digest."""
    found = policy(page)
    assert found["default-src"] == found["base-uri"] == found["form-action"] == ["'none'"]
    scripts = re.findall(r"<script>(.*?)</script>", page, flags=re.DOTALL)
    digests = [f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'" for text in scripts]
    for directive, sources in found.items():
        assert {*sources} - {*digests} <= ALLOWED, directive
    assert [source for source in found["script-src"] if source.startswith("'sha256")] == digests
    assert "'unsafe-inline'" not in found["script-src"]
    assert page.index("Content-Security-Policy") < page.index("<title>") < page.index("<style>")
    assert not re.search(r"\son\w+=", page.partition("</style>")[2].partition("<script")[0])


def pages(folder: Path) -> dict[str, Path]:
    """Pages: one of each FMU template, and a report."""
    found = {}
    for name, kind in KINDS.items():
        model, file = kind.models[0], load_default(name)
        found[name] = folder / "documentation" / f"{name}.html"
        found[name].parent.mkdir(exist_ok=True)
        found[name].write_bytes(
            make_documentation(model.with_parameters(name, file.values), file)["index.html"]
        )
    found["report"] = folder / "report.html"
    write_joint_report(found["report"], load_default(next(iter(KINDS))))
    return found


def test_documentation_and_reports_forbid_the_network(tmp_path: Path) -> None:
    for path in pages(tmp_path).values():
        check(path.read_text(encoding="utf-8"))
    for name, model in PARTNERS.items():
        check(make_documentation(model, load_partner_parameters(name))["index.html"].decode())


def test_the_template_of_all_reports_forbids_the_network() -> None:
    """The report of all joints, which takes minutes, extends this template, as the report of one
    joint does."""
    folder = Path(figure.__file__).parent
    assert '{% extends "base.html" %}' in (folder / "page.html").read_text(encoding="utf-8")
    script = figure.read_page_script("tabs.js")
    check(load_jinja_template(folder / "base.html").render(style="", script=script))


@pytest.mark.slow
def test_the_laboratory_forbids_the_network(tmp_path: Path) -> None:
    write_laboratory(tmp_path / "laboratory.html")
    page = (tmp_path / "laboratory.html").read_text(encoding="utf-8")
    check(page)
    assert "'wasm-unsafe-eval'" in policy(page)["script-src"]


@pytest.mark.slow
@needs("Chromium")
def test_pages_work_under_their_policy_and_send_nothing(tmp_path: Path) -> None:
    """Charts are drawn; an added request, script or frame in the page is blocked."""
    found = pages(tmp_path)
    icons = tmp_path / "terminalsAndIcons"
    icons.mkdir()
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>'
    (icons / "icon.svg").write_text(svg, encoding="utf-8")
    with browser() as one:
        one.call("Page.addScriptToEvaluateOnNewDocument", source=WATCH)
        for name, path in found.items():
            one.open(path)
            assert one.run("seen") == [], name
            assert one.run("document.querySelectorAll('.figure svg').length") > 0, name
            assert one.run("[...document.images].every((i) => i.complete && i.naturalWidth > 0)"), name
            assert one.run("charts.flat()[0].png().then((blob) => blob.size)") > 1000, name
            assert one.run("fetch('https://example.org/').then(() => 1, () => 0)") == 0
            one.run(INTRUDERS)
            one.run("new Promise((done) => setTimeout(done, 200))")
            assert {"connect-src", "img-src"} <= {*one.run("seen")}
            assert not {0, 1} & {*one.run("seen")}, name
