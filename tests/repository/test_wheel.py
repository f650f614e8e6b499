"""Wheel of this checkout in an environment without compiler: it builds FMUs for every platform."""

import os
import subprocess
import sys
import venv
from importlib.metadata import PackageNotFoundError, distribution
from itertools import islice
from pathlib import Path
from shutil import copytree, ignore_patterns

import pytest
from clients import needs
from conftest import Fmu, made_once
from joint_cases import CASES, STATE, law, random_inputs
from jointfmu_fmu_src.native.compiled import compile_ahead
from natives import VERSIONS, close
from packaging.requirements import Requirement
from test_native_binaries import BINARIES, members

from jointfmu.joints import MODELS
from jointfmu.parameters import format_parameter_file, load_default

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
NAME = "GearContact"
"""The only FMU with compiled parts in the wheel of the test, with its default law."""


def brought_along() -> set[str]:
    """Distributions that `pip install jointfmu` installs."""
    found: set[str] = set()
    waiting = ["jointfmu"]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        try:
            needs = [Requirement(text) for text in distribution(name).requires or ()]
        except PackageNotFoundError:
            continue
        found.add(name)
        waiting += [r.name.lower() for r in needs if r.marker is None or r.marker.evaluate({"extra": ""})]
    return found - {"jointfmu"}


def link_packages(names: set[str], folder: Path) -> None:
    """Link the top-level files of distributions into a folder."""
    folder.mkdir()
    for name in names:
        files = distribution(name).files or []
        for top in {file.parts[0] for file in files} - {"..", "__pycache__"}:
            place = Path(str(distribution(name).locate_file(top)))
            if place.exists() and not (folder / top).exists():
                (folder / top).symlink_to(place)


def built_wheel(out: Path) -> Path:
    """Wheel of this tree with compiled parts of one FMU, built in a copy because pip writes files into the
    tree."""
    tree, ignored = out / "tree", ignore_patterns("__pycache__", "*.egg-info", "parts")
    for folder in ("core", "fmu_src", "models", "tools"):
        copytree(ROOT / folder, tree / folder, ignore=ignored)
    for file in ("pyproject.toml", "README.md", "LICENSE"):
        (tree / file).write_bytes((ROOT / file).read_bytes())
    every = compile_ahead.list_code_structures
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compile_ahead, "list_code_structures", lambda model: islice(every(model), 1))
        compile_ahead.compile_models_ahead([NAME], tree / "fmu_src" / "native" / "parts")
    options = ("--no-deps", "--no-index", "--no-build-isolation", "--quiet", "--wheel-dir", str(out))
    subprocess.run([sys.executable, "-m", "pip", "wheel", *options, str(tree)], check=True)
    (wheel,) = out.glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the wheel, and an environment `env` with the wheel and its dependencies only."""

    def make(out: Path) -> None:
        out.mkdir()
        wheel = built_wheel(out)
        link_packages(brought_along(), out / "packages")
        venv.create(out / "env", with_pip=False)
        options = ("install", "--no-deps", "--no-index", "--quiet", str(wheel))
        pip = (sys.executable, "-m", "pip", "--python", str(out / "env" / "bin" / "python"))
        subprocess.run([*pip, *options], check=True)

    return made_once(tmp_path_factory, "wheel", make)


def run(clean: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a command of the environment, which has no compiler and only the compiled parts of the wheel."""
    return subprocess.run(
        [clean / "env" / "bin" / "python", "-W", "ignore", *words],
        cwd=folder,
        env={
            "PYTHONPATH": str(clean / "packages"),
            "JOINTFMU_CACHE": str(folder / "nothing kept"),
            "PATH": os.devnull,
        },
        capture_output=True,
        text=True,
        timeout=100,
    )


@needs("Linux or macOS")
def test_the_wheel_alone_builds_variants_for_every_platform(clean: Path, tmp_path: Path) -> None:
    for package in ("casadi", "ziglang", "matplotlib", "pythonfmu"):
        assert run(clean, tmp_path, "-c", f"import {package}").returncode
    where = run(clean, tmp_path, "-c", "import jointfmu, jointfmu_fmu_src.native as n; print(n.__file__)")
    assert str(clean / "env") in where.stdout, where.stderr
    changes = dict([next(iter(CASES[NAME].tuning.tuned.items()))])
    file = load_default(MODELS[NAME].joint).with_values(changes, "user", "test")
    (tmp_path / "variant.toml").write_text(format_parameter_file(file))
    build = ("-m", "jointfmu", "build", NAME, "--params", "variant.toml", "--name", "Mine", "--out", "out")
    done = run(clean, tmp_path, *build)
    assert done.returncode == 0, done.stderr
    for version in VERSIONS:
        path = tmp_path / "out" / version / "Mine.fmu"
        found = {name for name in members(path) if name.startswith("binaries/")}
        assert found == {f"binaries/{folder}/Mine.{end}" for folder, end in BINARIES[version].items()}
        instance, expected = Fmu(path).start(STATE[NAME]), law(NAME, file.values).after(STATE[NAME])
        for inputs in random_inputs(NAME, 5, seed=62):
            assert instance.at(inputs) == close(expected(inputs))
        instance.free_instance()


def test_the_bytes_are_those_of_a_build_here(clean: Path, tmp_path: Path, native: Path) -> None:
    done = run(clean, tmp_path, "-m", "jointfmu", "build", NAME, "--out", "out")
    assert done.returncode == 0, done.stderr
    for version in VERSIONS:
        path = f"{version}/{NAME}.fmu"
        assert (tmp_path / "out" / path).read_bytes() == (native / path).read_bytes()


def test_what_the_wheel_does_not_carry_asks_for_the_compiler(clean: Path, tmp_path: Path) -> None:
    other = next(name for name in MODELS if MODELS[name].joint != MODELS[NAME].joint)
    done = run(clean, tmp_path, "-m", "jointfmu", "build", other, "--flavour", "fmi3", "--out", "out")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "pip install 'jointfmu[build]'" in done.stderr
    assert not (tmp_path / "out").exists()
