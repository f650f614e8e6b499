"""Archives that are refused before anything is unpacked."""

import zipfile

import pytest
from jointfmu_tools.host import unpacked


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [("resources/x", bytes(100_000_000), "times its own size"), ("../../x", b"a", "has a member '../../x'")],
    ids=["zip bomb", "path that leaves the folder"],
)
def test_a_refused_archive_leaves_nothing_unpacked(name, data, words, tmp_path, monkeypatch):
    path, own = tmp_path / "a.fmu", tmp_path / "own"
    own.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(own))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", "<a/>")
        archive.writestr(name, data)
    with pytest.raises(ValueError, match=words), unpacked(path):
        pass
    assert not list(own.iterdir())
