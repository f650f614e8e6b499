"""Shared functions of the tests of `jointfmu prove`: changed copies of FMUs, and the command's JSON."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from clients import needs
from jointfmu_fmu_src.proof.standard import (
    LAYERED_STANDARD_NAME,
    MANIFEST_ATTRIBUTE_NAMESPACE,
    MANIFEST_PATH,
    REFERENCE_FILE_FOLDER,
)
from jointfmu_tools import cli

Change = Callable[[str, bytes], bytes | None]
BOTH = ["co-simulation", "model exchange"]
MEASURED = 2e-3
"""Largest error over tolerance of the FMUs' experiments [1]. Measured: 8.4e-4 next to a refusal (absolute
8e-9); elsewhere 5e-10 from the digits of the files, 4e-10 from the solver of model exchange."""


ECOS, LIBCOSIM = (pytest.param(name, marks=needs(name)) for name in ("ecos", "libcosim"))
"""Importers that only some machines have, as test cases."""


def copy(source: Path, target: Path, change: Change, **more: bytes) -> Path:
    """Copy an FMU with members changed, removed (None) or added."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            data = change(name, old.read(name))
            if data is not None:
                new.writestr(name, data)
        for name, data in more.items():
            new.writestr(f"{REFERENCE_FILE_FOLDER}/{name}", data)
    return target


def replaced(part: str, old: bytes, new: bytes) -> Change:
    """Change for `copy`: replace a text in the members whose path ends with `part`."""

    def change(name: str, data: bytes) -> bytes:
        if not name.endswith(part):
            return data
        assert old in data, (name, old)
        return data.replace(old, new, 1)

    return change


def other_manifest(source: Path, target: Path, experiments: str, **files: bytes) -> Path:
    """Copy an FMU with a manifest of one file of experiments instead of its own."""
    head = f'xmlns:fmi-ls="{MANIFEST_ATTRIBUTE_NAMESPACE}" fmi-ls:fmi-ls-name="{LAYERED_STANDARD_NAME}" '
    head += 'fmi-ls:fmi-ls-version="1.0.0-alpha.1"'
    related = '<Related type="application/x-ma-ls-experiments" source="own.exp" role="experiment"/>'
    texts = {
        Path(MANIFEST_PATH).name: f"<fmiReferences {head}>{related}</fmiReferences>".encode(),
        "own.exp": f'<Experiments name="own">{experiments}</Experiments>'.encode(),
    }
    return copy(
        source,
        target,
        lambda name, data: None if name.startswith(REFERENCE_FILE_FOLDER) else data,
        **texts,
        **files,
    )


def proved(capsys: pytest.CaptureFixture[str], fmu: Path, *words: str, status: int = 0) -> dict[str, Any]:
    """JSON object that `jointfmu prove --json` prints; asserts the exit status."""
    found = cli.main(["prove", str(fmu), *words, "--json"])
    out, err = capsys.readouterr()
    assert (found, err) == (status, ""), (err, out[-2000:])
    return dict(json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON")))
