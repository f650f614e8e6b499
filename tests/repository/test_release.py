"""What is published says one version, and leads to the address that is given."""

import json
import os
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

from clients import needs

from jointfmu import __version__

ROOT = Path(__file__).resolve().parents[2]


def test_the_version_is_one() -> None:
    for file, pattern in (
        ("CITATION.cff", r"^version: (.+)$"),
        ("CHANGELOG.md", r"^## \[(.+?)\]"),
        ("models/modelica/JointStiffness/package.mo", r'^ +version="(.+)",$'),
    ):
        found = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), flags=re.MULTILINE)
        assert found is not None
        assert found[1] == __version__, file


def test_the_description_leads_to_the_address_that_is_given() -> None:
    show = [sys.executable, "setup.py", "--quiet", "--url", "--long-description"]
    given = os.environ | {"JOINTFMU_URL": "https://example.org/joints/"}
    said = subprocess.run(show, cwd=ROOT, env=given, capture_output=True, text=True, timeout=100, check=True)
    links = re.findall(r"\]\((?!#)([^)\s]+)\)", said.stdout)
    assert len(links) > 10
    assert all(link.startswith("https://") for link in links), links
    pictures = re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", said.stdout)
    for link in (*links, *pictures):
        path = re.sub(r"https://example\.org/joints/(blob|raw)/HEAD/", "", link)
        assert ("/raw/" in link) == (link in pictures), link
        assert path.startswith("https:") or (ROOT / path.partition("#")[0]).exists(), link


def test_workflows_pin_every_action_by_commit() -> None:
    uses = [
        line
        for path in sorted((ROOT / ".github/workflows").glob("*.yml"))
        for line in re.findall(r"uses: (.+)", path.read_text(encoding="utf-8"))
        if not line.startswith("./")
    ]
    assert uses
    for line in uses:
        assert re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", line), line


@needs("cyclonedx-bom")
def test_the_sbom_lists_dependencies_and_what_is_compiled_in(tmp_path: Path) -> None:
    out = tmp_path / "sbom" / "jointfmu.cdx.json"
    subprocess.run(
        [sys.executable, ".ci/sbom.py", sys.executable, str(out)], cwd=ROOT, check=True, timeout=100
    )
    document = json.loads(out.read_text(encoding="utf-8"))
    assert document["bomFormat"] == "CycloneDX"
    main = document["metadata"]["component"]
    assert (main["name"], main["version"]) == ("jointfmu", __version__)
    found = {c["name"].lower(): c["version"] for c in document["components"]}
    for name in ("numpy", "scipy", "fmpy", "jinja2"):
        assert found[name] == version(name)
    assert {"fmi headers", "mingw-w64 headers and import stubs"} <= found.keys()
    assert not {"pip", "setuptools", "jointfmu"} & found.keys()
    refs = [main["bom-ref"], *(c["bom-ref"] for c in document["components"])]
    assert {ref for row in document["dependencies"] for ref in row.get("dependsOn", ())} <= {*refs}
