"""Public interface `import jointfmu`, as used in a notebook."""

import doctest
import json
import subprocess
import sys
from contextlib import chdir
from importlib import import_module

import numpy as np
import pytest
from clients import needs
from conftest import here_alone
from jointfmu_tools import cli
from surroundings import environment, missing_package

import jointfmu

MODULES = ("frame", "joint", "law", "make", "system_fit")
PLATE = {
    "plate": (200, 100),
    "bolts": "4xM12",
    "at": (160, 60),
    "grip": 40,
    "material": "steel",
    "Ra": 0.8,
    "preload": 30e3,
}
ROW = {"K1": 4700.0, "K2": 6100.0, "K3": 7100.0, "T1": 2.0, "T2": 6.9}


@pytest.fixture(autouse=True)
def folder(tmp_path, enter):
    enter(chdir(tmp_path))


@pytest.fixture
def plate():
    """Function that makes the bolted joint of PLATE without the finite elements of its members."""
    return lambda **changes: jointfmu.bolted_joint(**PLATE | {"sides": "rigid"} | changes)


def test_the_package_shows_its_interface_and_nothing_else():
    assert {*dir(jointfmu)} == {*jointfmu.__all__, "__version__"}
    for name in jointfmu.__all__:
        assert ">>>" in getattr(jointfmu, name).__doc__, name


def test_the_interface_is_loaded_when_it_is_asked_for():
    asked = "import sys, jointfmu; print(any(m.startswith('jointfmu_tools') for m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_a_name_that_is_not_there():
    with pytest.raises(AttributeError, match="no attribute 'drives'"):
        _ = jointfmu.drives


def test_the_core_alone_names_the_missing_package(enter):
    enter(missing_package("jointfmu_tools"))
    vars(jointfmu).pop("load", None)  # of an earlier test; it is found again
    with pytest.raises(ImportError, match=r"^jointfmu.load needs the package jointfmu_tools, .* pip install"):
        _ = jointfmu.load


@pytest.mark.slow
@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    assert doctest.testmod(import_module(f"jointfmu_tools.api.{name}")).failed == 0


@pytest.mark.parametrize(
    "name",
    [
        "drive",
        "cycloidal_drive",
        pytest.param("bolted_joint", marks=[pytest.mark.slow, needs("gmsh")]),
        "gear_contact",
        "gear_mesh",
    ],
)
def test_examples_of_what_makes_joints(name):
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner()
    (found,) = finder.find(getattr(jointfmu, name), name, module=False)
    assert runner.run(found).failed == 0
    assert found.examples


def test_a_drive_by_name_in_one_line():
    drive = jointfmu.drive("CSG-25-100")
    # the catalogue's own lines: 14 N.m at K1, then K2 up to 48 N.m
    assert drive.wind_up(48.0) == pytest.approx(14.0 / 31000 + 34.0 / 50000, rel=4e-3)
    T = np.array([-48.0, -1.0, 0.0, 1.0, 48.0])
    np.testing.assert_allclose(drive.torque(drive.wind_up(T)), T, rtol=1e-9, atol=1e-12)
    assert drive.torque(1e-3) == pytest.approx(14.0 + 50000 * (1e-3 - 14.0 / 31000), rel=4e-3)


def test_a_joint_prints_its_numbers_with_units_and_sources(plate):
    """Numbers, tuples and lists are different forms of the same drawing."""
    one = plate()
    for text in (repr(one), one._repr_html_()):
        for part in ("side1.E", "210", "GPa", "EN 1993-1-1", "inputs.preload", "30", "kN", "K_zz"):
            assert part in text
    other = plate(at=[(-80, -30), (80, -30), (-80, 30), (80, 30)], grip=[20, 20], Ra="0.8 um")
    assert other.values["plate.cone_diameter"] == pytest.approx(one.values["plate.cone_diameter"], rel=1e-12)
    assert other.values["plate.x"] == pytest.approx(one.values["plate.x"], rel=1e-12)


@pytest.mark.parametrize("form", [list, tuple, np.array])
def test_of_each_side_or_bolt_in_any_form(plate, form):
    """Several values, or one text with several numbers, as the option declares."""
    flanks = {"width": 20, "load": 3000, "material": form(["steel", "cast iron"])}
    made = jointfmu.gear_contact(**flanks, radii=form([30, 50]), Ra=form([0.4, 0.8]))
    assert made.file.roughness == pytest.approx({"Ra1": 0.4e-6, "Ra2": 0.8e-6})
    assert (made.values["side2.E"], made.name) == (110e9, "flanks 20 wide")
    wheels = {"module": 4, "width": np.array(20), "torque": 150, "material": "hardened steel", "Ra": 0.4}
    assert jointfmu.gear_mesh(**wheels, teeth=form([29, 45])).values["teeth1"] == 29.0
    places = form([(-80, -30), (80, -30), (-80, 30), (80, 30)])
    for at in (form([160, 60]), places):
        one = plate(plate=form([200, 100]), at=at, grip=form([20, 20]))
        assert one.values["plate.x"] == pytest.approx((-0.08, 0.08, -0.08, 0.08))


def test_what_is_evaluated_is_what_is_followed_on_the_way_from_rest(plate):
    joint = plate()
    far = joint.evaluate(s_rel_x=[0.0, 3e-7])
    way = joint.follow(s_rel_x=[0.0, 3e-7, 0.0])
    assert far["f_x"][1] == pytest.approx(way["f_x"][1], rel=1e-6)
    assert way["f_x"][2] > 0.0  # friction holds it back
    assert far.units["f_x"] == "N"


def test_a_joint_is_saved_and_loaded(plate):
    joint = plate().with_values(mu=0.2, **{"inputs.preload": 20e3})
    again = jointfmu.load(joint.save("plate.toml"))
    assert again.values == joint.values
    assert (again.values["mu"], again.values["inputs.preload"]) == (0.2, 20e3)
    assert again.file.origins["mu"] == "user"


@pytest.mark.slow
def test_a_joint_is_built_run_drawn_and_reported(tmp_path):
    drive = jointfmu.drive("CSG-17-100", hysteresis=1)
    with here_alone():
        built = drive.build("dist", "fmi2", fmu="HarmonicDriveCompliance", name="Shoulder")
    assert [path.name for path in built] == ["Shoulder.fmu"]
    T = np.linspace(0.0, 20.0, 5)
    found = jointfmu.run(built[0], {"tau": T})
    own = drive.follow("HarmonicDriveCompliance", tau=T)
    np.testing.assert_allclose(found["phi_rel"], own["phi_rel"], rtol=1e-9, atol=1e-15)
    drive.plot().savefig(tmp_path / "drive.png")
    found.plot().savefig(tmp_path / "found.png")
    assert found.save("found.csv").read_text().startswith("tau [N.m],phi_rel [rad]")
    assert "<html" in drive.report("drive.html").read_text()


@pytest.mark.slow
def test_several_inputs_over_a_time_of_their_own(native):
    fmu = native / "fmi3" / "BoltedJoint.fmu"
    time, s = np.array([0.0, 0.5, 2.0]), np.array([0.0, 1e-7, 2e-7])
    found = jointfmu.run(fmu, {"preload": 9e3, "s_rel_x": s}, time=time)
    own = jointfmu.load("BoltedJoint").follow(preload=9e3, s_rel_x=s)
    np.testing.assert_allclose(found["f_x"], own["f_x"], rtol=1e-9, atol=1e-9)
    for wrong, message in (({"time": [0.0, 1.0]}, "lengths"), ({"time": [0.0, 2.0, 1.0]}, "increase")):
        with pytest.raises(ValueError, match=message):
            jointfmu.run(fmu, {"s_rel_x": s}, **wrong)


def test_a_law_evaluates_arrays():
    law = jointfmu.law("zhao2018")
    found = law.at_pressure(np.geomspace(1e5, 1e7, 50))
    assert np.all(np.diff(found["K_N"]) > 0.0)
    assert found.units["K_N"] == "N/m"
    assert "surface.D" in repr(law)


@pytest.mark.parametrize(
    ("name", "varied"),
    [
        ("zhao2018", {"surface.D": [1.3, 1.42]}),
        ("hu2023", {"surface.D": [2.5, 2.53], "sigma_y": [3e8, 4e8]}),
        ("yu2022", {"e": [0.1, 0.2]}),
        ("roughness", {"h": [1e-6, 2e-6]}),
        ("roughness", {"Ra1": [1e-6, 2e-6], "Ra2": 1e-6}),
        ("roughness", {"surface.D": [1.3, 1.42], "surface.G": 1e-9}),
    ],
)
def test_a_law_evaluates_arrays_of_parameters(name, varied):
    """Each point equals the result of the law with its own parameters; the inversion has a residual
    of 1e-12."""
    law = jointfmu.law(name, **{key: np.array(value) for key, value in varied.items()})
    found = law.at_pressure([1e6, 2e6])
    alone = [
        jointfmu.law(name, **{key: np.broadcast_to(value, 2)[i] for key, value in varied.items()})
        for i in (0, 1)
    ]
    for column in found:
        expected = [one.at_pressure(p)[column][0] for one, p in zip(alone, (1e6, 2e6), strict=True)]
        np.testing.assert_allclose(found[column], expected, rtol=1e-10)
    assert "not checked for plausibility with arrays" in found.messages[0]
    assert "2 numbers from" in repr(law)
    with pytest.raises(ValueError, match="inputs of different lengths"):
        law.at_pressure([1e6, 2e6, 3e6])


def test_a_law_is_judged_as_by_the_command(capsys):
    """The warnings equal the warnings of `jointfmu law`, for the default surface and for a stated one."""
    for varied in ({"critical_area": "printed"}, {"surface.D": 1.2}):
        settings = [f"{name}={value}" for name, value in varied.items()]
        assert cli.main(["law", "zhao2018", "--pressure", "1e6", "--json", "--set", *settings]) == 0
        said = json.loads(capsys.readouterr().out)["warnings"]
        assert jointfmu.law("zhao2018", **varied).at_pressure(1e6).messages == tuple(said)
        assert bool(said) == ("critical_area" in varied)
    assert jointfmu.load("BoltedJoint").with_values(critical_area="printed").law.at_pressure(1e6).messages


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: jointfmu.drive("CSG-99"), "'CSG-99' is unknown"),
        (lambda: jointfmu.drive(ratio=100), "K1, K2, K3, T1, T2 missing"),
        (lambda: jointfmu.drive("CSG-25-100", efficiency=1.5), r"efficiency = .1.5. is outside \[0.1, 1\)"),
        (lambda: jointfmu.bolted_joint(**PLATE | {"grip": -40}), r"grip = '-40' is outside \(0, inf\)"),
        (lambda: jointfmu.bolted_joint(**PLATE | {"head": "round"}), "head = 'round', allowed are"),
        (lambda: jointfmu.bolted_joint(**PLATE | {"preload": (1, 2)}), r"preload = \(1, 2\) are 2 values"),
        (lambda: jointfmu.bolted_joint(**PLATE | {"material": []}), r"material = \[\] are 0 values"),
        (lambda: jointfmu.load("nothing"), "'nothing' is not a parameter file"),
        (lambda: jointfmu.load("BoltedJoint").with_values(mu=-1.0), "mu = -1"),
        (lambda: jointfmu.load("BoltedJoint").with_values(nu=1.0), "unknown name 'nu'"),
        (lambda: jointfmu.load("BoltedJoint").with_values(**{"inputs.f": 1.0}), "unknown input 'f'"),
        (lambda: jointfmu.load("BoltedJoint").evaluate(preload=-1.0), "preload = -1 is outside"),
        (lambda: jointfmu.load("BoltedJoint").evaluate(tau=1.0), "unknown input 'tau'"),
        (lambda: jointfmu.load("BoltedJoint").evaluate(preload=[1, 2], s_rel_x=[1, 2, 3]), "lengths"),
        (lambda: jointfmu.load("BoltedJoint").plot("GearMesh"), "fmu = 'GearMesh' is not a model of"),
        (lambda: jointfmu.law("nolaw"), "law = 'nolaw', allowed are"),
        (lambda: jointfmu.law("roughness", q=1.0), "unknown name 'q'"),
        (lambda: jointfmu.fit("nothing"), "procedure = 'nothing', allowed are"),
        (lambda: jointfmu.fit("loop", "a.csv"), "exists for several joints"),
        (lambda: jointfmu.fit("catalogue", K1=1.0), "missing"),
        (lambda: jointfmu.fit("catalogue", "a.csv"), "takes no file"),
        (
            lambda: jointfmu.fit("loop", "a.csv", joint="bolted_joint", preload="9 kN"),
            r"preload = '9 kN' is not a number: force of each bolt of a bolted joint at tightening \[N\]",
        ),
        (lambda: jointfmu.fit("catalogue", **ROW, law="hu2023", free="name"), "'name' is not a parameter to"),
        (lambda: jointfmu.fit("preload", "a.csv", direction="up"), "direction = 'up', allowed are normal"),
        (lambda: jointfmu.fit("torque-angle", "a.csv", rated_torque="2 N"), "rated_torque = '2 N': unit"),
        (lambda: jointfmu.run("no.fmu", {}), "no such file"),
    ],
)
def test_a_refusal_is_one_line_that_names_what_is_wrong(call, message):
    with pytest.raises(ValueError, match=message) as refused:
        call()
    assert "\n" not in str(refused.value)
    assert "--" not in str(refused.value)


def test_a_required_name_is_said_by_python():
    with pytest.raises(TypeError, match="plate"):
        jointfmu.bolted_joint()


@pytest.mark.slow  # a process of its own
def test_a_missing_package_is_named_with_what_brings_it(tmp_path, enter):
    """Without extras, numbers are computed; what needs a package names the extra in one line."""
    asked = """
import sys
sys.modules.update(dict.fromkeys(("matplotlib", "casadi")))
import jointfmu
drive = jointfmu.drive("CSG-25-100")
assert drive.wind_up(48.0) > 0.0 and len(repr(drive)) > 1000
law = jointfmu.law("roughness", h=1e-6)
for call in (drive.build, drive.plot, law.plot, law.at_pressure([1e6, 2e6]).plot):
    try:
        call()
    except ValueError as error:
        print(error)
"""
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "nothing kept")))
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    said = done.stdout.splitlines()
    assert len(said) == 4
    assert all(text in said[0] for text in ("casadi is missing", "pip install 'jointfmu[build]'"))
    assert all("matplotlib is missing" in line and "pip install matplotlib" in line for line in said[1:])
