"""Published files state one version, and link to the address that was given."""

import base64
import hashlib
import json
import os
import re
import subprocess
import sys
import zipfile
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


def test_the_description_leads_to_the_address_that_is_given(tmp_path: Path) -> None:
    program = "import build_backend as b, sys; print(b.prepare_metadata_for_build_wheel(sys.argv[1]))"
    given = os.environ | {"JOINTFMU_URL": "https://example.org/joints/", "PYTHONPATH": str(ROOT / "fmu_src")}
    subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)], cwd=ROOT, env=given, timeout=100, check=True
    )
    said = next(tmp_path.glob("*.dist-info/METADATA")).read_text(encoding="utf-8")
    assert "Project-URL: Repository, https://example.org/joints\n" in said
    links = re.findall(r"\]\((?!#)([^)\s]+)\)", said)
    assert len(links) > 10
    assert all(link.startswith("https://") for link in links), links
    pictures = re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", said)
    for link in (*links, *pictures):
        path = re.sub(r"https://example\.org/joints/(blob|raw)/HEAD/", "", link)
        assert ("/raw/" in link) == (link in pictures), link
        assert path.startswith("https:") or (ROOT / path.partition("#")[0]).exists(), link


def test_an_editable_install_finds_the_kernel_before_a_clone_of_its_name(tmp_path: Path) -> None:
    """The folder of the kernel is on the search path; a package there precedes a folder without
    `__init__`."""
    program = "import build_backend as b, sys; b.build_editable(sys.argv[1])"
    given = os.environ | {"PYTHONPATH": str(ROOT / "fmu_src")}
    subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)], cwd=ROOT, env=given, capture_output=True, timeout=100
    ).check_returncode()
    with zipfile.ZipFile(next(tmp_path.glob("*.whl"))) as wheel:
        (path,) = (name for name in wheel.namelist() if name.endswith(".pth"))
        text = wheel.read(path)
        (record,) = (name for name in wheel.namelist() if name.endswith("/RECORD"))
        rows = wheel.read(record).decode()
    assert text.decode().splitlines()[-1] == str(ROOT / "core")
    digest = base64.urlsafe_b64encode(hashlib.sha256(text).digest()).rstrip(b"=").decode()
    assert f"{path},sha256={digest},{len(text)}\n" in rows
    (tmp_path / "jointfmu").mkdir()
    find = (
        f"import sys; sys.path[:0] = ['', {str(ROOT / 'core')!r}]; import jointfmu; print(jointfmu.__file__)"
    )
    found = subprocess.run([sys.executable, "-S", "-c", find], cwd=tmp_path, capture_output=True, text=True)
    assert found.stdout.strip() == str(ROOT / "core" / "jointfmu" / "__init__.py")


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
