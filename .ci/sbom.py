"""The SBOM of a release, CycloneDX: python .ci/sbom.py PYTHON FILE, with the extra `release`.

PYTHON is that of a bare environment with the wheel: its distributions are what the wheel needs. The headers
that are compiled into the FMUs are added: those of the versions of fmpy and ziglang that run this script.
"""

import json
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMPILED = (
    ("FMI headers", "fmpy", "BSD-2-Clause", "declarations of FMI 2.0 and 3.0, from fmpy"),
    ("mingw-w64 headers and import stubs", "ziglang", "ZPL-2.1", "of the Windows binaries, from ziglang"),
)
"""(name, distribution that carries it, licence, what it is) of what is compiled in."""
TOOLS = ("pip", "setuptools")
"""Distributions of an environment that the wheel does not need."""


def write_sbom(python: str, out: Path) -> None:
    """Write the SBOM of the wheel installed for `python`."""
    options = ["--pyproject", str(ROOT / "pyproject.toml"), "--mc-type", "library", "--output-reproducible"]
    command = [sys.executable, "-m", "cyclonedx_py", "environment", *options, "-o", "-", python]
    document = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    found = [c for c in document["components"] if c["name"].lower() not in (*TOOLS, "jointfmu")]
    own = {"version": next(c["version"] for c in document["components"] if c["name"] == "jointfmu")}
    document["metadata"]["component"] |= own
    compiled = [
        {
            "type": "library",
            "bom-ref": f"compiled-in:{carrier}",
            "name": name,
            "version": f"{carrier} {version(carrier)}",
            "description": f"compiled in: {meaning}",
            "licenses": [{"license": {"id": licence}}],
        }
        for name, carrier, licence, meaning in COMPILED
    ]
    document["components"] = found + compiled
    known = {document["metadata"]["component"]["bom-ref"], *(c["bom-ref"] for c in document["components"])}
    rows = [row for row in document.get("dependencies", []) if row["ref"] in known]
    for row in rows:
        row["dependsOn"] = [ref for ref in row.get("dependsOn", []) if ref in known]
    main = next(row for row in rows if row["ref"] == document["metadata"]["component"]["bom-ref"])
    main["dependsOn"] += [c["bom-ref"] for c in compiled]
    document["dependencies"] = [*rows, *({"ref": c["bom-ref"]} for c in compiled)]
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write_sbom(sys.argv[1], Path(sys.argv[2]))
