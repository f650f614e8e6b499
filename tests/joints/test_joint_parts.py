"""Modules of a joint for builders and tools: they are named, and a wrong name fails at import."""

import sys
from collections.abc import Iterator
from pathlib import Path

import jointfmu_fmu_src.joints as builders
import jointfmu_tools as tools
import pytest
from jointfmu_tools.common.joint_parts import TOOL_NAMES, JointToolModules, load_tool_module

from jointfmu.joints import KINDS


def test_all_floors_know_the_same_joints() -> None:
    assert set(KINDS) == set(builders.FMU_BUILD_DATA) == set(tools.PARTS)


@pytest.mark.parametrize("joint", KINDS)
def test_every_part_can_be_loaded(joint: str) -> None:
    loaded = [tool for tool in TOOL_NAMES if load_tool_module(KINDS[joint], tool)]
    assert loaded == sorted(tools.PARTS[joint].modules)
    load = builders.FMU_BUILD_DATA[joint].load_native_definition
    assert load is not None
    assert load().shared_file_stems


@pytest.fixture
def package(tmp_path: Path) -> Iterator[str]:
    """Folder of a joint with the part `export`, and a module that is no part."""
    folder = tmp_path / "joint_of_a_test"
    folder.mkdir()
    for name in ("__init__", "export", "helper"):
        (folder / f"{name}.py").touch()
    sys.path.insert(0, str(tmp_path))
    yield folder.name
    sys.path.remove(str(tmp_path))
    for name in [name for name in sys.modules if name.startswith(folder.name)]:
        del sys.modules[name]


def test_a_part_is_a_module(package: str) -> None:
    parts = JointToolModules(package, ("export",))
    assert parts.load_joint_module("export") is sys.modules[f"{package}.export"]
    assert parts.load_joint_module("fit") is None


def test_a_module_may_serve_several_tools(package: str) -> None:
    parts = JointToolModules(package, ("export",), pressure="helper", checks="helper")
    assert (
        parts.load_joint_module("pressure")
        is parts.load_joint_module("checks")
        is sys.modules[f"{package}.helper"]
    )


@pytest.mark.parametrize(
    ("modules", "what"),
    [
        ({"pressure": "load"}, "joint_of_a_test.load has no module"),
        ({"pressures": "helper"}, "joint_of_a_test.pressures is a part that no tool uses"),
    ],
)
def test_a_wrong_module_fails_at_import(package: str, modules: dict[str, str], what: str) -> None:
    with pytest.raises(ImportError, match=what):
        JointToolModules(package, ("export",), **modules)


@pytest.mark.parametrize(
    ("names", "what"),
    [
        (("export", "fitt"), "joint_of_a_test.fitt has no module"),
        (("export", "fit"), "joint_of_a_test.fit has no module"),
        (("export", "helper"), "joint_of_a_test.helper is a part that no tool uses"),
        ((), "joint_of_a_test.export is a part that its __init__.py must name"),
    ],
)
def test_a_wrong_name_fails_at_import(package: str, names: tuple[str, ...], what: str) -> None:
    with pytest.raises(ImportError, match=what):
        JointToolModules(package, names)
