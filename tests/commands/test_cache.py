"""`jointfmu cache`: which files it stores, removes, and accepts from the disk."""

import io
import json
import lzma
import os
import tarfile
from pathlib import Path

import pytest
from clients import needs
from conftest import refused_line
from jointfmu_fmu_src.native.compiled import cache, compiled_models, compiler
from jointfmu_fmu_src.native.data import split_parameters
from jointfmu_tools.cli import main
from surroundings import Enter, environment, missing_package

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default


def test_only_what_is_kept_is_removed(
    tmp_path: Path, enter: Enter, capsys: pytest.CaptureFixture[str]
) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path)))
    for name in ("parts/casadi-1_ziglang-1/A.tar.xz", "zig/o/b", "mine.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("12345")
    assert main(["cache", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"folder": str(tmp_path), "files": 2, "bytes": 10}
    for _ in range(2):
        assert main(["cache", "--clear"]) == 0
        assert capsys.readouterr().out.startswith(f"{tmp_path}: 0 files, 0.0 MB")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


MODEL = MODELS["GearContact"]
POSIX = needs("Linux or macOS")


def part() -> compiled_models.CompiledModel:
    return compiled_models.CompiledModel(
        {"law.c": "int x;\n"},
        {v: dict.fromkeys(compiler.ZIG_TARGETS, b"library") for v in compiled_models.FMI_VERSIONS},
    )


@pytest.fixture
def cached(tmp_path: Path, enter: Enter, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Compiled part of a joint in a cache. Compiling it again fails the test."""
    file = load_default(MODEL.joint)
    model = MODEL.with_parameters(file.joint, file.values)
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "cache")))
    monkeypatch.setattr(compiled_models, "SHIPPED_MODEL_FOLDER", tmp_path / "none")
    place = compiled_models._list_candidate_cache_paths(
        compiled_models.make_compiled_model_file_name(model, split_parameters(model, file))
    )[-1]
    compiled_models._write_cache_file(place, compiled_models.pack_compiled_model(part()))
    enter(missing_package("ziglang"))
    return place


def found() -> compiled_models.CompiledModel:
    file = load_default(MODEL.joint)
    model = MODEL.with_parameters(file.joint, file.values)
    return compiled_models.get_compiled_model(model, file, split_parameters(model, file))


def levels(cached: Path) -> list[Path]:
    """Paths of the compiled part and of its folders, up to the folder of the cache."""
    return [cached, *cached.parents[: len(cached.relative_to(cache.cache_folder()).parts)]]


@POSIX
def test_a_new_cache_belongs_to_its_user_alone(cached: Path) -> None:
    assert found() == part()
    for place in levels(cached):
        assert place.stat().st_mode & 0o077 == 0


@POSIX
@pytest.mark.parametrize("level", range(4))
def test_a_cache_that_every_user_may_write_to_is_refused(
    level: int, cached: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = levels(cached)[level]
    place.chmod(place.stat().st_mode | 0o002)
    with pytest.raises(ValueError, match=f"{place}: every user may write to it; expected .*JOINTFMU_CACHE"):
        found()
    out = str(cached.parents[4] / "out")
    said = refused_line(capsys, "build", MODEL.name, "--flavour", "fmi3", "--out", out)
    assert f"{place}: every user may write to it" in said


@POSIX
@pytest.mark.parametrize("level", range(4))
def test_a_cache_of_another_user_is_refused(
    level: int, cached: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = levels(cached)[level]
    if os.geteuid() == 0:
        os.chown(place, 12345, -1)
    else:  # an ordinary user owns all of them and cannot give one away: the file is checked first
        place = cached
        monkeypatch.setattr(os, "geteuid", lambda: 12345)
    with pytest.raises(ValueError, match=f"{place}: belongs to another user; expected .*JOINTFMU_CACHE"):
        found()


@POSIX
@pytest.mark.parametrize(
    "variable", [cache.CACHE_ENVIRONMENT_VARIABLE, cache.COMPILER_CACHE_ENVIRONMENT_VARIABLE]
)
def test_what_the_compiler_keeps_is_checked_too(variable: str, tmp_path: Path, enter: Enter) -> None:
    enter(environment(**{cache.COMPILER_CACHE_ENVIRONMENT_VARIABLE: None}))
    enter(environment(**{variable: str(tmp_path)}))
    tmp_path.chmod(0o777)
    with pytest.raises(ValueError, match="every user may write to it"):
        compiler.compile_libraries("x", {"x.c": "int x;"}, ["x.c"], ["x86_64-linux"])


def test_a_missing_cache_is_empty(tmp_path: Path, enter: Enter) -> None:
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "none")))
    assert cache.count_cached_files() == (0, 0)


@pytest.mark.parametrize(
    "name", ["sources/../../x.c", "sources/a/b.c", "sources//x", "2/../../x", "/x", "other/x"]
)
def test_a_member_that_leaves_the_fmu_is_refused(name: str) -> None:
    buffer = io.BytesIO(lzma.decompress(compiled_models.pack_compiled_model(part())))
    with tarfile.open(fileobj=buffer, mode="a") as archive:
        archive.addfile(tarfile.TarInfo(name))
    with pytest.raises(ValueError, match="no compiled model"):
        compiled_models.unpack_compiled_model(lzma.compress(buffer.getvalue()))
