"""Input files: archives are checked before they are unpacked; pipes and devices are refused at once."""

import os
import re
import struct
import threading
import zipfile
from contextlib import chdir
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from clients import needs
from conftest import refused_line
from jointfmu_tools.cli.parser import _iterate_parsers, build_parser
from jointfmu_tools.inputs.surfaces.reading import read_heights as heights
from jointfmu_tools.run import host
from jointfmu_tools.run.proof.manifest import RelatedFileReader
from surroundings import Enter, temporary_folder

from jointfmu.files import archives
from jointfmu.files.reading import read_bytes
from jointfmu.parameters import load_parameter_file

DESCRIPTION = (
    '<fmiModelDescription fmiVersion="2.0" modelName="Bomb" guid="0"><CoSimulation modelIdentifier="Bomb"/>'
)
DESCRIPTION += "<ModelVariables/><ModelStructure/></fmiModelDescription>"


def archive(path: Path, members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> Path:
    """FMU for co-simulation on this platform, with additional members."""
    with zipfile.ZipFile(path, "w", method) as made:
        made.writestr("modelDescription.xml", DESCRIPTION, zipfile.ZIP_DEFLATED)
        made.writestr(f"binaries/{host_platform()}/Bomb.so", b"x")
        for name, content in members.items():
            made.writestr(name, content)
    return path


def host_platform() -> str:
    from fmpy import platform

    return platform


def larger(path: Path, name: str, size: int) -> Path:
    """Change the declared size of an archive member, in the directory and before the member."""
    data = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as made:
        at = made.getinfo(name).header_offset
    struct.pack_into("<I", data, at + 22, size)
    entry = data.rindex(name.encode()) - 46
    assert data[entry : entry + 4] == b"PK\x01\x02"
    struct.pack_into("<I", data, entry + 24, size)
    path.write_bytes(data)
    return path


ZEROS = bytes(1 << 20)
REFUSED = {
    "ratio": (
        {f"resources/{i}": ZEROS for i in range(80)},
        "allowed are at most 100 times",
    ),
    "members": (
        {f"resources/{i}": b"" for i in range(archives.MAX_ARCHIVE_MEMBERS)},
        "allowed are at most 20000",
    ),
    "parent": ({"resources/../../x": b""}, "expected a relative path without"),
    "root": ({"/resources/x": b""}, "expected a relative path without"),
    "drive": ({"C:/x": b""}, "expected a relative path without"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_an_archive_is_refused_before_anything_is_unpacked(kind: str, tmp_path: Path, enter: Enter) -> None:
    members, words = REFUSED[kind]
    path, own = archive(tmp_path / "bomb.fmu", members), enter(temporary_folder(tmp_path / "own"))
    for read in (
        archives.FmuMembers,
        RelatedFileReader,
        host.read_description,
        lambda p: host.unpack_fmu(p).__enter__(),
    ):
        with pytest.raises(ValueError, match=words) as refused:
            read(path)
        assert str(refused.value).startswith(f"{path}: ")
    assert [*own.iterdir()] == []


@pytest.mark.parametrize("size", [archives.MAX_UNPACKED_SIZE + 1, archives.MAX_TEXT_MEMBER_SIZE + 1])
def test_a_declared_size_is_refused(size: int, tmp_path: Path) -> None:
    noise = np.random.default_rng(0).bytes(1 << 21)
    path = larger(archive(tmp_path / "large.fmu", {"extra/large.xml": noise}), "extra/large.xml", size)
    with pytest.raises(ValueError, match=r"bytes unpacked.*allowed are"):
        host.read_description(path)


def test_a_member_is_unpacked_to_its_declared_size_at_most(tmp_path: Path) -> None:
    """A member of a million bytes that declares 10 bytes is not unpacked beyond 10 bytes."""
    path = larger(archive(tmp_path / "lies.fmu", {"resources/x": ZEROS}), "resources/x", 10)
    with pytest.raises(ValueError, match=r"lies.fmu: is not an FMU \(Bad CRC-32"):
        archives.FmuMembers(path)["resources/x"]
    with (
        pytest.raises(ValueError, match=r"lies.fmu: is not an FMU \(Bad CRC-32"),
        archives.open_archive(path) as opened,
    ):
        archives.extract_members(opened, tmp_path / "out", lambda name: True)
    assert sum(file.stat().st_size for file in tmp_path.glob("out/resources/*")) <= 10


def test_a_surface_in_a_zip_is_measured_too(tmp_path: Path) -> None:
    path = archive(tmp_path / "scan.x3p", {f"{i}.bin": ZEROS for i in range(80)})
    with pytest.raises(ValueError, match="times its packed size"):
        heights(path)


def test_other_compression_is_refused(tmp_path: Path) -> None:
    """bzip2 and LZMA are refused, because they unpack a member completely, whatever size it declares."""
    for method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        with pytest.raises(ValueError, match="or compressed by another method than deflate"):
            host.read_description(archive(tmp_path / f"{method}.fmu", {"resources/x": ZEROS}, method))


def test_what_was_unpacked_of_a_broken_fmu_is_removed(tmp_path: Path, enter: Enter) -> None:
    path, own = (
        archive(tmp_path / "broken.fmu", {"resources/x": ZEROS}),
        enter(temporary_folder(tmp_path / "own")),
    )
    larger(path, "resources/x", 10)
    with pytest.raises(ValueError, match="Bad CRC-32"), host.unpack_fmu(path):
        pass
    assert [*own.iterdir()] == []


def test_a_usual_fmu_is_read(tmp_path: Path) -> None:
    path = archive(tmp_path / "usual.fmu", {"resources/x": ZEROS, "extra/y.csv": b"1"})
    assert host.read_description(path).modelName == "Bomb"
    assert archives.FmuMembers(path)["extra/y.csv"] == b"1"
    with host.unpack_fmu(path) as (folder, _):
        assert Path(folder, "resources", "x").stat().st_size == len(ZEROS)
    assert not Path(folder).exists()


# Pipes and devices


@needs("Linux or macOS")
def test_a_pipe_and_a_device_are_refused(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    for path, kind in ((pipe, "a pipe"), (Path("/dev/zero"), "a device")):
        for read in (load_parameter_file, host.read_description, lambda p: read_bytes(p, "a file")):
            with pytest.raises(ValueError, match=f"{path}: is {kind}, not a regular file; expected"):
                read(path)


INPUTS = {
    (one.prog.partition(" ")[2], action.dest)
    for one in _iterate_parsers(build_parser())
    for action in one._actions
    if action.type is Path and action.dest not in (*one.output_file_kinds, "fmus")
}
"""(command, argument) of every input file."""
FILES = {
    "assembly.toml": (files("jointfmu_models") / "assemblies" / "box_specimen.toml").read_text("utf-8"),
    "field.csv": "x [m],y [m],area [m2],pressure [Pa]\n0,0,1e-4,1e6\n",
    "field.inp": "",
    "loop.csv": "torque [N.m],angle [rad]\n" + "1,1\n" * 9,
    "log.csv": "a [1]\n1\n",
}
"""Files that a command reads before the pipe."""
PIPES = ("PIPE", "PIPE.csv", "PIPE.toml")
LINES = {
    ("build", "params"): "BoltedJoint --params PIPE --out out",
    ("export", "nodes"): "ansys springs --preload 1e4 --first 1 --first-set 1 --nodes PIPE --out a.cdb",
    ("export", "params"): "ansys springs --params PIPE --out a.cdb",
    ("fit catalogue", "params"): "--params PIPE --K1 1 --K2 1 --K3 1 --T1 1 --T2 2",
    ("fit log", "file"): "PIPE --ratio 100",
    ("fit log", "params"): "log.csv --params PIPE",
    ("fit loop", "file"): "PIPE",
    ("fit loop", "params"): "loop.csv --params PIPE",
    ("fit preload", "file"): "PIPE",
    ("fit preload", "params"): "decay.csv --params PIPE",
    ("fit system", "data"): "robot_joint PIPE.csv --free link.J",
    ("fit torque-angle", "file"): "PIPE",
    ("fit torque-angle", "params"): "angle.csv --params PIPE",
    ("footprint compute", "assembly"): "PIPE",
    ("footprint compute", "params"): "assembly.toml --params PIPE",
    (
        "footprint import",
        "beside",
    ): "field.inp --format abaqus --length-unit m --pressure-unit Pa --preload 1 --with PIPE",
    ("footprint import", "file"): "PIPE --format csv --preload 1",
    ("footprint import", "moment_file"): "field.csv --preload 1 --moment 1 --moment-file PIPE.csv",
    ("footprint import", "params"): "field.csv --preload 1 --params PIPE",
    ("law", "params"): "zhao2018 --pressure 1e6 --params PIPE",
    ("modelica", "params"): "--params PIPE --out out",
    ("modes", "assembly"): "PIPE",
    ("modes", "params"): "assembly.toml --params PIPE",
    ("parameters", "params"): "HarmonicDriveSpring --params PIPE",
    ("prove", "against"): "a.fmu --against PIPE",
    ("prove", "fmu"): "PIPE",
    ("ramp", "fmu"): "PIPE --input tau --to 1 --step 1",
    ("report", "file"): "PIPE.toml",
    ("robot", "robot"): "PIPE --drive joint1=CSG-17-100 --out out",
    ("surface identify", "files"): "PIPE",
    ("surface identify", "params"): "scan.csv --params PIPE",
    ("sweep", "fmu"): "PIPE --set a=1..2 --input tau --to 1 --step 1 --out out",
    ("sweep", "study"): "a.fmu --study PIPE --input tau --to 1 --step 1 --out out",
    ("uncertainty", "params"): "--params PIPE --set surface.D=1.4..1.5",
    ("uncertainty", "study"): "harmonic_drive --study PIPE",
}


def test_every_file_that_is_read_is_tried() -> None:
    assert LINES.keys() == INPUTS


@needs("Linux or macOS")
@pytest.mark.parametrize(("command", "name"), LINES)
def test_a_command_refuses_a_pipe_at_once(
    command: str,
    name: str,
    tmp_path: Path,
    enter: Enter,
    capsys: pytest.CaptureFixture[str],
) -> None:
    enter(chdir(tmp_path))
    for path, text in FILES.items():
        Path(path).write_text(text)
    for path in PIPES:
        os.mkfifo(path)
    writer = threading.Timer(20.0, lambda: [os.open(path, os.O_RDWR | os.O_NONBLOCK) for path in PIPES])
    writer.start()  # what waits for the pipe goes on, and fails the test
    try:
        said = refused_line(capsys, *command.split(), *LINES[command, name].split())
    finally:
        writer.cancel()
    assert re.search(r"PIPE\S*: is a pipe, not a regular file; expected", said)
    assert {*os.listdir()} == {*FILES, *PIPES}
