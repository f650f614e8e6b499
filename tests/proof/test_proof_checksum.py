"""Related files with a checksum in the manifest: read if it agrees, else refused."""

import hashlib
import zipfile
from pathlib import Path

import pytest
from conftest import refused_line
from jointfmu_fmu_src.proof.standard import MANIFEST_PATH, REFERENCE_FILE_FOLDER
from jointfmu_tools.run.proof.checksum import CHECKSUM_ALGORITHMS
from jointfmu_tools.run.proof.manifest import RelatedFileReader

EXPERIMENTS = b'<Experiments><Experiment name="rest" stopTime="1.0"/></Experiments>'
HEAD = (
    'xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest" fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref"'
)


def fmu(path: Path, attributes: str) -> Path:
    """FMU with an empty description, a manifest and its experiments."""
    related = f'<Related source="smoke.exp" role="experiment" {attributes}/><Related source="absent.ssv" '
    related += 'role="parameter" checksum="00"/><Related source="http://a.b/c" role="other" checksum="00"/>'
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
        archive.writestr(MANIFEST_PATH, f"<fmiReferences {HEAD}>{related}</fmiReferences>")
        archive.writestr(f"{REFERENCE_FILE_FOLDER}/smoke.exp", EXPERIMENTS)
    return path


@pytest.mark.parametrize("kind", [None, *CHECKSUM_ALGORITHMS])
def test_a_file_with_its_checksum_is_read(tmp_path: Path, kind: str | None) -> None:
    """Without a stated type the checksum is SHA3-256; missing files and web addresses are not compared."""
    name = (kind or "SHA3-256").lower()
    name = name.replace("-", "_") if name.startswith("sha3") else name.replace("-", "")
    digest = hashlib.new(name, EXPERIMENTS).hexdigest().upper()
    stated = f'checksum="{digest}"' + (f' checksumType="{kind}"' if kind else "")
    assert [
        one.experiment_name for one in RelatedFileReader(fmu(tmp_path / "a.fmu", stated)).read_experiments()
    ] == ["rest"]


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        ('checksum="00ff"', "smoke.exp is not the file of the manifest: its SHA3-256 is "),
        ('checksum="00ff" checksumType="SHA-512"', "its SHA-512 is "),
        ('checksum="00ff" checksumType="MD5"', "smoke.exp has checksumType = 'MD5', allowed are SHA3-224, "),
    ],
)
def test_another_file_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], stated: str, said: str
) -> None:
    assert said in refused_line(capsys, "prove", fmu(tmp_path / "a.fmu", stated))
