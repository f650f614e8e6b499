"""Output files and folders: written completely or not at all, and refused before the work starts."""

import pytest
from clients import needs
from conftest import refused_line
from jointfmu_tools import cli
from surroundings import full_disk

from jointfmu.files.outputs import EXPORTED_TEXT_FILE, OUTPUT_FOLDER, check_output
from jointfmu.files.writing import write_files

FILES = {"package.mo": "one\n", "Data/package.mo": "two\n", "Data/order": "three\n"}


def everything(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_files_are_written_below_a_folder(tmp_path):
    folder = tmp_path / "new" / "Library"
    assert write_files(folder, FILES) == [folder / name for name in FILES]
    assert {name: (folder / name).read_text() for name in FILES} == FILES
    (folder / "own.txt").write_text("kept")
    write_files(folder, FILES | {"package.mo": "again\n"})
    assert (folder / "package.mo").read_text() == "again\n"
    assert everything(tmp_path / "new") == [
        "Library",
        *sorted(f"Library/{p}" for p in ("Data", "own.txt", *FILES)),
    ]


@needs("Linux or macOS")
@pytest.mark.parametrize("there", [False, True])
def test_a_full_disk_leaves_what_was_there(tmp_path, there):
    folder = tmp_path / "new" / "Library"
    if there:
        write_files(folder, FILES)
    before, changed = everything(tmp_path), dict.fromkeys(FILES, "changed\n")
    with full_disk(100), pytest.raises(ValueError, match=r"Library: cannot be written \(File too large\)"):
        write_files(folder, changed | {"Data/order": 101 * "x"})
    assert everything(tmp_path) == before
    assert not there or (folder / "package.mo").read_text() == "one\n"


def test_a_check_leaves_nothing_and_refuses_what_is_in_the_way(tmp_path):
    check_output(tmp_path / "a" / "b.csv", EXPORTED_TEXT_FILE)
    check_output(tmp_path / "a" / "b", OUTPUT_FOLDER)
    assert everything(tmp_path) == []
    (tmp_path / "file").write_text("")
    for kind, path in (
        (EXPORTED_TEXT_FILE, "file/a.csv"),
        (OUTPUT_FOLDER, "file"),
        (OUTPUT_FOLDER, "file/a"),
    ):
        with pytest.raises(ValueError, match=r"cannot be written \(.*file: Not a directory\)"):
            check_output(tmp_path / path, kind)


@pytest.mark.parametrize(
    ("command", "work"),
    [
        (["build", "GearContact"], "jointfmu_fmu_src.building.build_fmus"),
        (["modelica"], "jointfmu_tools.exchange.modelica.library.render_library"),
        (["system", "robot_joint"], "jointfmu_tools.exchange.modelica.library.render_system"),
    ],
)
def test_a_folder_that_cannot_be_written_is_refused_before_the_work(
    tmp_path, monkeypatch, capsys, command, work
):
    (tmp_path / "file").write_text("")

    def never(*args, **options):
        raise AssertionError("worked before the check")

    monkeypatch.setattr(work, never)
    said = refused_line(capsys, *command, "--out", tmp_path / "file" / "out")
    assert "cannot be written" in said
    with pytest.raises(AssertionError):
        cli.main([*command, "--out", str(tmp_path / "out")])
