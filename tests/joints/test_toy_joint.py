"""Toy joint of another package in less than 100 lines, through all tools: a new joint is a new folder."""

import json
from contextlib import chdir
from pathlib import Path
from zipfile import ZipFile

import jointfmu_tools as tools
import numpy as np
import pytest
import toy_joint
import toy_joint.fmu as toy_fmu
import toy_joint.tools as toy_tools
from conftest import here_alone
from fmpy.validation import validate_fmu
from jointfmu_fmu_src import joints as builders
from jointfmu_fmu_src.building import FLAVOUR_BUILDERS, build_fmus
from jointfmu_fmu_src.folders import find_fmu_build_data
from jointfmu_tools import cli
from jointfmu_tools.exchange.modelica import library
from jointfmu_tools.studies.checks import check_ramp, compare_build_variant, run_default_ramp

from jointfmu import joints
from jointfmu.parameters import format_parameter_file, load_default

pytestmark = pytest.mark.slow

C = 1e4


@pytest.fixture(scope="module", autouse=True)
def toy():
    joints.register_joint(toy_joint.KIND)
    builders.FMU_BUILD_DATA["toy"], tools.PARTS["toy"] = toy_fmu.FMU_BUILD_DATA, toy_tools.TOOL_MODULES
    yield
    del builders.FMU_BUILD_DATA["toy"], tools.PARTS["toy"]
    del joints.KINDS["toy"], joints.MODELS["ToySpring"]


@pytest.fixture(scope="module")
def built(toy, tmp_path_factory):
    out = tmp_path_factory.mktemp("toy")
    with here_alone():
        build_fmus(["ToySpring"], list(FLAVOUR_BUILDERS), None, out)
    return out


def test_a_joint_without_fmu_parts_cannot_be_built():
    own = builders.FMU_BUILD_DATA.pop("toy")
    with pytest.raises(ValueError, match=r"joint 'toy' has no FMU parts; .*: harmonic_drive"):
        find_fmu_build_data(joints.MODELS["ToySpring"])
    builders.FMU_BUILD_DATA["toy"] = own


def test_it_is_short():
    """Code, page, parameters and icon of the toy joint have less than 100 lines together."""
    folder = Path(toy_joint.__file__).parent
    written = [path for path in folder.rglob("*") if path.suffix in (".py", ".html", ".toml", ".svg")]
    assert sum(len(path.read_text().splitlines()) for path in written) < 100


def test_a_name_is_taken_once():
    with pytest.raises(ValueError, match="joint 'toy': the name 'toy' is already used"):
        joints.register_joint(toy_joint.KIND)


@pytest.mark.parametrize("flavour", FLAVOUR_BUILDERS)
def test_every_flavour_is_valid_and_gives_hookes_law(built, flavour):
    path = built / flavour / "ToySpring.fmu"
    assert validate_fmu(str(path)) == []
    ramp = run_default_ramp("ToySpring", built / flavour)
    assert ramp.variable_columns["f"] == pytest.approx(
        -C * ramp.variable_columns["s_rel"], rel=1e-15, abs=0.0
    )
    assert ramp.variable_columns["K"] == pytest.approx(np.full(101, C), rel=1e-15)
    assert ramp.log_messages == ()
    assert all(one.is_passed for one in check_ramp("ToySpring", built / flavour, ramp))
    assert compare_build_variant("ToySpring", built / "python", ramp).is_passed


def test_a_stiffness_that_is_none_is_refused_by_the_fmu(built):
    from jointfmu_tools.run.ramps import ramp

    with pytest.raises(ValueError, match=r"c = -1 N/m is outside \(0, inf\): stiffness"):
        ramp.run_ramp(built / "fmi3" / "ToySpring.fmu", "s_rel", 1e-3, 1e-3, {"c": -1.0})


def test_it_has_page_icon_and_flange(built):
    with ZipFile(built / "fmi2" / "ToySpring.fmu") as fmu:
        names = fmu.namelist()
        assert b"<p>A spring.</p>" in fmu.read("documentation/index.html")
        assert b'terminalKind="Modelica.Mechanics.Translational' in fmu.read(
            "terminalsAndIcons/terminalsAndIcons.xml"
        )
    assert {"terminalsAndIcons/icon.svg", "terminalsAndIcons/icon.png", "model.png"} <= set(names)


def test_modelica_has_its_interface_and_wrapper():
    files = library.render_library()
    assert (
        "input Real s_rel" in files["Interfaces/ToySpring.mo"] or "s_rel" in files["Interfaces/ToySpring.mo"]
    )
    assert "flange" in files["Wrappers/ToySpring.mo"]
    assert "ToySpring" in files["Wrappers/package.order"].split()


def test_uncertainty_of_a_line(capsys):
    """f is linear in c, so its quantiles are the quantiles of c, times the elongation."""
    assert cli.main(["uncertainty", "toy", "--set", "c=9000..11000", "--samples", "1024", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    median = np.array(found["outputs"]["f"]["quantiles"]["0.5"])
    loads = np.array(found["load"]["values"])
    assert median == pytest.approx(-C * loads, rel=2e-3)  # 1024 samples of a uniform number


def test_export_writes_the_line(tmp_path, capsys):
    out = tmp_path / "spring.csv"
    assert cli.main(["export", "csv", "curve", "--joint", "toy", "--out", str(out)]) == 0
    rows = [line for line in out.read_text().splitlines() if not line.startswith("#")]
    assert rows[0] == "s_rel [m],pull [N],K [N/m]"
    assert [float(x) for x in rows[-1].split(",")] == [1e-3, 10.0, C]


def test_what_it_lacks_is_refused_by_name(tmp_path, capsys):
    assert cli.main(["export", "csv", "contact", "--joint", "toy", "--out", str(tmp_path / "x.csv")]) == 2
    assert "contact of a toy cannot be written" in capsys.readouterr().err


def test_its_parameter_file_is_read_and_written():
    file = load_default("toy")
    assert (file.joint, file.values.c) == ("toy", C)
    with pytest.raises(ValueError, match=r"c = 0 N/m is outside \(0, inf\)"):
        file.with_values({"c": 0.0}, "user", "test")


def test_it_has_a_page_of_its_own_file(tmp_path, enter):
    """The joint defines neither page contents nor loops: the page has the curve over the load and the
    parameters."""
    enter(chdir(tmp_path))
    Path("mine.toml").write_text(format_parameter_file(load_default("toy")))
    assert cli.main(["report", "mine.toml"]) == 0
    page = Path("mine.html").read_text(encoding="utf-8")
    assert "<td><code>c</code></td>" in page
    assert "<h2>Loops</h2>" not in page
