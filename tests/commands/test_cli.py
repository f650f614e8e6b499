"""Command line: printed results, exit status, and one line for each invalid input."""

import json
import math
import re
import subprocess
import sys
from dataclasses import asdict

import numpy as np
import pytest
from jointfmu_tools.cli import main
from jointfmu_tools.inputs.laws import LAW_OUTPUT_COLUMNS, LAWS, build_law_parameters
from jointfmu_tools.inputs.laws import find_default_joint as _first
from jointfmu_tools.joints.bolted_joint.published import PUBLISHED_NUMBERS
from jointfmu_tools.studies.published import computed, reference, validation

from jointfmu import __version__
from jointfmu.contact.interface import evaluate_at_largest_spot, evaluate_at_pressure
from jointfmu.contact.laws import zhao2018
from jointfmu.joints import KINDS
from jointfmu.parameters import format_parameter_file, load_default
from jointfmu.quantity import flatten_parameters

COMMON = {
    "side1.E": 1.9e11,
    "side1.nu": 0.31,
    "side2.E": 1.8e11,
    "side2.nu": 0.33,
    "mu": 0.21,
    "traction_ratio": 0.35,
    "A_0": 2e-3,
    "surface.gamma": 1.7,
}
SETTABLE = {  # the names of the public contract, each with another value than the default
    "zhao2018": COMMON
    | {"surface.D": 1.5, "surface.G": 1e-9, "H": 2.5e9, "mass": 33.0}
    | {"critical_area": "printed", "spot_stiffness": "hertz"},
    "hu2023": COMMON
    | {"surface.D": 2.4, "surface.G": 3e-7, "surface.r_m": 1e-4, "surface.s_min": 2e-14, "sigma_y": 9e8},
    "yu2022": COMMON
    | {"surface1.D": 1.5, "surface1.G": 2e-10, "surface2.D": 1.4, "surface2.G": 3e-10}
    | {"e": 0.4, "lambda": 0.5, "sigma_y": 3e8, "rigid_flat": "false"},
    "roughness": {name: value for name, value in COMMON.items() if name != "surface.gamma"}
    | {"h": 1e-6, "gamma": 0.48, "longest_wave": 3e-3, "hurst": 0.7, "slope": 0.01, "H": 2.5e9},
    "table": {"table.ratio": 0.5, "table.factor": 1.3}
    | {name: COMMON[name] for name in ("mu", "traction_ratio", "A_0")},
}
CHOICES = [
    ("zhao2018", "critical_area", ("continuity", "printed", "yield")),
    ("zhao2018", "spot_stiffness", ("family", "hertz")),  # the specimen keeps the paper's
    ("yu2022", "rigid_flat", ("true", "false")),
]
NO_EFFECT = {
    ("hu2023", "mu"),  # enters with a traction on the real area only
    ("yu2022", "mu"),
    ("yu2022", "traction_ratio"),
    ("yu2022", "side2.E"),  # the second body is rigid by default
    ("yu2022", "side2.nu"),
}
UNDEFINED = {"zhao2018": set(), "hu2023": {"eta_n", "eta_t"}, "yu2022": {"K_T", "eta_n", "eta_t"}} | {
    "roughness": {"largest_spot"},
    "table": {"largest_spot", "A_r"},
}
WITHOUT_SPOTS = ("roughness", "table")
each_law = pytest.mark.parametrize("law", LAWS)


@pytest.fixture
def run(capsys):
    """Function that runs a command and returns exit status, standard output and standard error."""

    def call(*args):
        try:
            status = main([str(arg) for arg in args])
        except SystemExit as end:
            status = end.code
        return status, *capsys.readouterr()

    return call


@pytest.fixture
def law_json(run):
    """Function that returns the JSON object which `law --json` prints."""

    def call(*args):
        status, out, err = run("law", *args, "--json")
        assert (status, err) == (0, "")
        assert out.count("\n") == 1
        return json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))

    return call


# law


@each_law
def test_law_by_pressure(law_json, law):
    pressures = [2e6, 1e5, 4e7]
    found = law_json(law, "--pressure", *pressures)
    assert set(found) == {"law", "parameters", "rows", "level", "warnings"}
    assert found["law"] == law
    parameters = build_law_parameters(law, None, {})
    assert found["parameters"] == json.loads(json.dumps(flatten_parameters(parameters)))
    assert set(SETTABLE[law]) <= set(found["parameters"])
    expected = evaluate_at_pressure(parameters, np.array(pressures))
    assert len(found["rows"]) == 3
    for i, row in enumerate(found["rows"]):
        assert (
            set(LAW_OUTPUT_COLUMNS)
            == {"largest_spot", "pressure", "F", "K_N", "K_T", "A_r", "eta_n", "eta_t"}
            <= set(row)
        )
        assert {name for name in LAW_OUTPUT_COLUMNS if row[name] is None} == UNDEFINED[law]
        for name, value in row.items():
            if name in expected and value is not None:
                assert value == float(np.broadcast_to(expected[name], 3)[i])
        # 1e-12 is the residual of the pressure inversion
        assert row["pressure"] == pytest.approx(pressures[i], rel=1e-12)
        assert row["F"] == pytest.approx(pressures[i] * parameters.A_0, rel=1e-12)


@pytest.mark.parametrize("law", [law for law in LAWS if law not in WITHOUT_SPOTS])
def test_law_by_largest_spot(law_json, law):
    """The pressure that the command returns gives the same largest spot."""
    areas = [1e-7, 1e-9]
    found = law_json(law, "--largest-spot", *areas)["rows"]
    parameters = build_law_parameters(law, None, {})
    for row, area in zip(found, areas, strict=True):
        assert row["largest_spot"] == pytest.approx(area, rel=1e-13)  # exp of log
        alone = float(evaluate_at_largest_spot(parameters, area)["K_N"])
        assert row["K_N"] == pytest.approx(alone, rel=1e-14)  # order of a sum
        (back,) = law_json(law, "--pressure", repr(row["pressure"]))["rows"]
        # 1e-12 of the load, a power of the area below 2.5
        assert back["largest_spot"] == pytest.approx(area, rel=1e-11)
        assert back["K_N"] == pytest.approx(row["K_N"], rel=1e-11)


@each_law
def test_law_without_load(law_json, law):
    """At zero pressure there is no force and no stiffness, and the JSON has no infinity."""
    (row,) = law_json(law, "--pressure", 0)["rows"]
    assert (row["F"], row["K_N"], row["pressure"]) == (0.0, 0.0, 0.0)
    assert row["A_r"] == (None if law == "table" else 0.0)
    assert row["K_T"] in (0.0, None)
    assert row["eta_n"] == (0.0 if law in WITHOUT_SPOTS else None)


HEIGHTS = {
    "both sides": (["Ra1=0.8e-6", "Ra2=1.6e-6"], np.sqrt(np.pi / 2.0) * np.hypot(0.8e-6, 1.6e-6), None),
    "one side": (["Rq2=0.8e-6"], 0.8e-6, None),
    # docs/validity_stiffness.md: 7.2 um of Zhao's surface
    "a surface": (["surface.D=1.42", "surface.G=1.21e-8", "longest_wave=1e-3"], 7.2e-6, 0.58),
}


@pytest.mark.parametrize("case", HEIGHTS)
def test_a_roughness_is_stated_in_the_terms_that_people_have(law_json, case):
    settings, h, hurst = HEIGHTS[case]
    found = law_json("roughness", "--pressure", 1e6, "--set", *settings)["parameters"]
    assert found["h"] == pytest.approx(h, rel=0.01 if hurst else 1e-12)
    assert found["hurst"] == pytest.approx(
        hurst or build_law_parameters("roughness", None, {}).hurst, rel=1e-12
    )


def test_a_roughness_out_of_the_file_of_another_law(law_json, tmp_path, run):
    """Ra of the specimen replaces D and G of its surface; material, area and friction are those of
    the file."""
    path = tmp_path / "mine.toml"
    specimen = load_default("bolted_joint").with_values({"mu": 0.2, "side1.E": 2e11}, "user", "test")
    path.write_text(format_parameter_file(specimen))
    found = law_json("roughness", "--pressure", 1e6, "--params", path)["parameters"]
    assert found["h"] == pytest.approx(1.6e-6 * np.sqrt(np.pi), rel=1e-12)
    assert (found["mu"], found["side1.E"], found["H"]) == (0.2, 2e11, 1.96e9)
    path.write_text(format_parameter_file(load_default("gear_contact")))
    found = law_json("roughness", "--pressure", 1e6, "--params", path)["parameters"]
    assert found["h"] == pytest.approx(5.2e-7, rel=0.01)  # of D and G, waves up to 1 mm
    assert found["H"] == pytest.approx(2.8 * 235e6, rel=1e-12)
    both = ["surface.D=1.42", "surface.G=1.21e-8"]
    again = law_json("roughness", "--pressure", 1e6, "--params", path, "--set", *both)["parameters"]
    assert again["h"] == law_json("roughness", "--pressure", 1e6, "--set", *both)["parameters"]["h"]


FRACTAL_OR_HEIGHTS = "state either surface.D and surface.G, or heights, and remove the others"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["h=1e-6", "Ra1=1e-6"], "Ra1 with h: state one height for each side, or only h"),
        (["surface.D=1.3"], "surface.D without surface.G: state both, or heights instead"),
        (["surface.G=1e-9"], "surface.G without surface.D: state both, or heights instead"),
        (
            ["surface.D=1.3", "surface.G=1e-9", "h=1e-6"],
            f"surface.D, surface.G together with h: {FRACTAL_OR_HEIGHTS}",
        ),
        (["surface.D=1.3", "Ra1=1e-6"], f"surface.D together with Ra1: {FRACTAL_OR_HEIGHTS}"),
    ],
)
def test_a_roughness_is_stated_once_and_whole(run, settings, message):
    status, out, err = run("law", "roughness", "--pressure", 1, "--set", *settings)
    assert (status, out, err) == (2, "", f"jointfmu law: {message}\n")


@pytest.mark.parametrize(("law", "name"), [(law, name) for law, names in SETTABLE.items() for name in names])
def test_every_promised_name_can_be_set(law_json, law, name):
    value = SETTABLE[law][name]
    plain = law_json(law, "--pressure", 1e6)
    found = law_json(law, "--pressure", 1e6, "--set", f"{name}={value}")
    asked = {"true": True, "false": False}.get(value, value)
    assert found["parameters"] == plain["parameters"] | {name: asked}
    assert plain["parameters"][name] != asked
    columns = [c for c, value in plain["rows"][0].items() if value is not None and c != "pressure"]
    before, after = ([answer["rows"][0][c] for c in columns] for answer in (plain, found))
    same = after == pytest.approx(before, rel=1e-9)  # residual of the pressure inversion: 1e-12
    assert same == ((law, name) in NO_EFFECT)


@pytest.mark.parametrize(("law", "name", "words"), CHOICES)
def test_of_named_choices_the_first_is_the_default(law_json, law, name, words):
    plain = law_json(law, "--pressure", 1e6)
    rows = [law_json(law, "--pressure", 1e6, "--set", f"{name}={word}")["rows"] for word in words]
    assert plain["rows"] == rows[0]
    assert len({row[0]["K_N"] for row in rows}) == len(words)
    assert str(plain["parameters"][name]).lower() == words[0]


@each_law
def test_printed_parameters_are_settings(law_json, law):
    """The parameters of the JSON object, set one by one without a file, give the same rows."""
    everything = [f"{name}={value}" for name, value in SETTABLE[law].items()]
    first = law_json(law, "--pressure", 1e6, 3e7, "--set", *everything)
    again = law_json(
        law,
        "--pressure",
        1e6,
        3e7,
        *[
            x
            for k, v in first["parameters"].items()
            if not isinstance(v, list)
            for x in ("--set", f"{k}={v}")
        ],
    )
    assert again == first


@each_law
def test_parameter_file(law_json, tmp_path, law):
    """Values of a changed file are used; --set overrides them."""
    joint = _first(law)
    name = "traction_ratio" if law in ("zhao2018", "roughness", "table") else "A_0"
    value = 0.002 if law == "hu2023" else 0.25
    path = tmp_path / "mine.toml"
    path.write_text(
        format_parameter_file(load_default(joint, law).with_values({name: value}, "user", "test"))
    )
    plain = law_json(law, "--pressure", 1e6)
    found = law_json(law, "--pressure", 1e6, "--params", path)
    assert found["parameters"] == plain["parameters"] | {name: value}
    over = law_json(law, "--pressure", 1e6, "--params", path, "--set", f"{name}=0.5")
    assert over["parameters"][name] == 0.5
    written = tmp_path / "default.toml"
    written.write_text(format_parameter_file(load_default(joint, law)))
    assert law_json(law, "--pressure", 1e6, "--params", written) == plain


@each_law
def test_law_as_text(run, law):
    """The text has a header with units and one line per pressure; a dash stands for an undefined quantity."""
    status, out, err = run("law", law, "--pressure", 1e6, 2e6)
    assert (status, err) == (0, "")
    heads, *lines = (re.split(r"\s\s+", line.strip()) for line in out.splitlines())
    head, units = zip(*(cell.removesuffix("]").split(" [") for cell in heads), strict=True)
    assert head[: len(LAW_OUTPUT_COLUMNS)] == LAW_OUTPUT_COLUMNS
    assert units[: len(LAW_OUTPUT_COLUMNS)] == ("m2", "Pa", "N", "N/m", "N/m", "m2", "1", "1")
    # the last is the level beside the roughness, where that is known; zhao2018 has a note on eta_t
    assert len(lines) == 2 + {"zhao2018": 2, "roughness": 1}.get(law, 0)
    values = dict(zip(head, lines[1], strict=True))
    assert {name for name in LAW_OUTPUT_COLUMNS if values[name] == "-"} == UNDEFINED[law]
    expected = evaluate_at_pressure(build_law_parameters(law, None, {}), 2e6)
    assert float(values["K_N"]) == pytest.approx(float(expected["K_N"]), rel=5e-6)  # six digits are printed
    assert float(values["pressure"]) == 2e6


def test_the_harmonic_drive_gives_the_softer_body_as_side1(law_json):
    drive = load_default("harmonic_drive").values
    found = law_json("hu2023", "--pressure", 1e6)["parameters"]
    assert (found["side1.E"], found["sigma_y"]) == (drive.flexspline.E, drive.flexspline.sigma_y)


# validate


def test_validate_as_text(run):
    status, out, err = run("validate")
    assert (status, err) == (0, "")
    laws, _, published = out.partition("\n\n")
    assert laws.endswith("missed: none")
    *lines, last = published.splitlines()
    papers = [paper for kind in KINDS.values() for paper in computed.load_published_numbers(kind).paper_names]
    points = [p for paper in papers for p in reference.read_points(paper)]
    assert len(lines) == len(points) + 1
    for word in (
        "published",
        "computed",
        "error",
        "tolerance",
        "guess",
        "nearer",
        "number",
        "role",
        "verdict",
    ):
        assert word in lines[0]
    for line, point in zip(lines[1:], points, strict=True):
        assert line.split()[:2] == [point.paper, point.id]
        verdict = ["no", "test"] if point.role in reference.UNTESTED_ROLES else ["pass"]
        assert line.split()[-1 - len(verdict) :] == [point.role, *verdict]
    assert last.endswith("missed: none")


def test_validate_as_json(run):
    status, out, err = run("validate", "--json")
    assert (status, err) == (0, "")
    found = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    assert found["missed"] == 0
    assert found["counts"] == asdict(validation.count_points(validation.validate_published_numbers()))
    assert {row["verdict"] for row in found["rows"]} == {"pass", "no test"}
    assert {row["verdict"] for row in found["laws"]} == {"pass"}
    for row in found["rows"]:
        assert {"paper", "id", "unit", "value", "computed", "error", "tolerance", "role"} <= set(row)
        assert row["role"] in reference.POINT_ROLES
        assert isinstance(row["printed"], bool)
        assert (
            (row["guess"] is None)
            == (row["nearer"] is None)
            == (row["role"] not in reference.ROLES_WITH_TRIVIAL_GUESS)
        )
        if not isinstance(row["value"], bool):
            error = row["computed"] - row["value"]
            error = error if row["absolute"] else error / abs(row["value"])
            assert row["error"] == pytest.approx(error, rel=1e-12, abs=1e-15)  # the same three operations
            assert abs(row["error"]) <= row["tolerance"]


@pytest.fixture
def wrong(monkeypatch, request):
    """Wrong value of one computed quantity."""
    name, value = request.param
    monkeypatch.setitem(PUBLISHED_NUMBERS.observable_functions, name, lambda *_, **__: value)


@pytest.mark.parametrize("wrong", [("spot_stiffness_ratio", 1.0)], indirect=True)
def test_a_missed_point_gives_status_1(run, wrong):
    status, out, err = run("validate", "--json")
    assert (status, err) == (1, "")
    found = json.loads(out)
    assert found["missed"] == 1
    assert [r["id"] for r in found["rows"] if r["verdict"] == "miss"] == ["spot_stiffness.ratio"]
    status, out, err = run("validate")
    assert (status, err) == (1, "")
    assert out.splitlines()[-1].endswith("missed: spot_stiffness.ratio")


def test_the_last_line_names_a_law_that_missed(run, monkeypatch):
    """The summary of the published numbers, below the summary of the laws, says that it missed none."""
    normal_stiffness = zhao2018.normal_stiffness
    monkeypatch.setattr(zhao2018, "normal_stiffness", lambda law, a: 1.01 * normal_stiffness(law, a))
    status, out, _ = run("validate")
    assert status == 1
    *_, summary, last = out.splitlines()
    assert summary.endswith("missed: none")
    assert last.startswith("missed in both tables: zhao2018.K_N, ")


@pytest.mark.parametrize("wrong", [("p_max", 8e6)], indirect=True)
def test_a_missed_calibration_point_is_shown(run, wrong):
    """The table shows the miss; the exit status depends on the points that are not calibrated."""
    status, out, err = run("validate")
    assert (status, err) == (0, "")
    assert "no test, moved" in out
    assert "missed: none" in out
    assert len([r for r in validation.validate_published_numbers() if not r.has_passed]) == 1


# ramp


def test_ramp(run, fmus, tmp_path):
    fmu = fmus / "GearContact.fmu"
    args = ("ramp", fmu, "--input", "f", "--to", 1000, "--step", 250, "--set", "e=0.3")
    status, out, err = run(*args, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["units"]["K_N"] == "N/m"
    columns = found["columns"]
    assert columns["f"] == [0.0, 250.0, 500.0, 750.0, 1000.0]
    assert {"s_rel", "K_N", "A_r", "elastic_fraction"} <= set(columns)
    assert np.all(np.diff(columns["s_rel"]) > 0.0)
    status, text, err = run(*args)
    assert (status, err) == (0, "")
    head, *lines = text.splitlines()
    assert head.split(",")[0] == "f [N]"
    assert [float(x) for x in lines[-1].split(",")] == [
        columns[name.split(" ")[0]][-1] for name in head.split(",")
    ]
    path = tmp_path / "new" / "ramp.csv"
    status, out, err = run(*args, "--csv", path)
    assert (status, err) == (0, "")
    assert path.read_text() == text
    assert str(path) in out
    other = json.loads(run(*args[:-2], "--json")[1])["columns"]
    assert other["s_rel"][-1] != columns["s_rel"][-1]  # --set counted


# Refusals


@pytest.fixture
def places(tmp_path, fmus):
    """Files that serve as arguments of commands."""
    (tmp_path / "text.toml").write_text("plain text")
    (tmp_path / "text.fmu").write_text("plain text")
    (tmp_path / "folder").mkdir()
    (tmp_path / "binary.toml").write_bytes(bytes(range(256)))
    (tmp_path / "gear.toml").write_text(format_parameter_file(load_default("gear_contact")))
    (tmp_path / "bolts.toml").write_text(format_parameter_file(load_default("bolted_joint")))
    return {"tmp": tmp_path, "fmus": fmus}


LAW = ["law", "zhao2018", "--pressure", "1e6"]
RAMP = ["ramp", "{fmus}/GearContact.fmu", "--input", "f", "--to", "1", "--step", "1"]


def ramp(**changes):
    args = list(RAMP)
    for name, value in changes.items():
        args[args.index(f"--{name}") + 1] = value
    return args


BAD = {
    # name: (arguments, words of the one line on standard error)
    "no-command": ([], ["COMMAND"]),
    "command": (["calibrate"], ["'calibrate'", "law", "build", "ramp", "validate"]),
    "option": ([*LAW, "--digits", "3"], ["--digits"]),
    "no-law": (["law"], ["LAW"]),
    "law": (["law", "hertz1881", "--pressure", "1"], ["'hertz1881'", *LAWS]),
    "no-load": (["law", "yu2022"], ["--pressure", "--largest-spot"]),
    "both-loads": ([*LAW, "--largest-spot", "1e-6"], ["--largest-spot", "--pressure"]),
    "no-pressure": (["law", "yu2022", "--pressure"], ["--pressure"]),
    "word": (["law", "yu2022", "--pressure", "1e6", "high"], ["--pressure", "'high'"]),
    "negative": (["law", "yu2022", "--pressure", "1e6", "-1"], ["pressure = -1 Pa", "[0, inf)"]),
    "nan": (["law", "hu2023", "--pressure", "nan"], ["pressure = nan Pa", "[0, inf)"]),
    "inf": (["law", "hu2023", "--pressure", "inf"], ["pressure = inf Pa", "[0, inf)"]),
    "no-spot": (["law", "zhao2018", "--largest-spot", "0"], ["largest spot = 0 m2", "(0, inf)"]),
    "spot-nan": (["law", "yu2022", "--largest-spot", "nan"], ["largest spot = nan m2", "(0, inf)"]),
    "spot-small": (
        ["law", "hu2023", "--largest-spot", "1e-290"],
        ["largest spot = 1e-290 m2", "1e-260 to 1e130 times"],
    ),
    "no-setting": ([*LAW, "--set"], ["--set"]),
    "setting": ([*LAW, "--set", "surface.D:1.5"], ["'surface.D:1.5'", "NAME=VALUE"]),
    "name": ([*LAW, "--set", "D=1.5"], ["'D'", "surface.D", "surface.G", "critical_area"]),
    "name-of-another-law": ([*LAW, "--set", "sigma_y=1e9"], ["'sigma_y'", "surface.D", "H"]),
    "low": ([*LAW, "--set", "surface.D=1"], ["surface.D = 1 ", "(1, 2)", "fractal dimension"]),
    "unit": ([*LAW, "--set", "H=-1"], ["H = -1 Pa", "(0, inf)"]),
    "value-nan": ([*LAW, "--set", "mass=nan"], ["mass = nan kg", "(0, inf)"]),
    "value-inf": ([*LAW, "--set", "side1.E=inf"], ["side1.E = inf Pa", "(0, inf)"]),
    "value-word": ([*LAW, "--set", "surface.G=fine"], ["surface.G = 'fine'", "not a number", "m"]),
    "value-bool": ([*LAW, "--set", "surface.G=true"], ["surface.G = True", "not a number"]),
    "value-empty": ([*LAW, "--set", "surface.G="], ["surface.G = ''", "not a number"]),
    "choice": (
        [*LAW, "--set", "critical_area=jump"],
        ["critical_area = 'jump'", "continuity, printed, yield"],
    ),
    "choice-number": ([*LAW, "--set", "spot_stiffness=2"], ["spot_stiffness = 2.0", "hertz, family"]),
    "two": ([*LAW, "--set", "mu=0", "H=0"], ["mu = 0", "H = 0 Pa"]),
    "D-at-its-end": ([*LAW, "--set", "surface.D=1.0001"], ["D", "too small or too large"]),
    "no-file": ([*LAW, "--params", "{tmp}/none.toml"], ["none.toml", "No such file"]),
    "folder": ([*LAW, "--params", "{tmp}/folder"], ["folder", "directory"]),
    "no-toml": ([*LAW, "--params", "{tmp}/text.toml"], ["text.toml", "TOML"]),
    "binary": ([*LAW, "--params", "{tmp}/binary.toml"], ["binary.toml", "UTF-8"]),
    "another-joint": (
        [*LAW, "--params", "{tmp}/gear.toml"],
        ["gear.toml", "'gear_contact'", "'bolted_joint'"],
    ),
    "validate": (["validate", "hu2023"], ["hu2023"]),
    "fmu-name": (["build", "Gearbox"], ["'Gearbox'", "HarmonicDriveSpring", "BoltedJoint", "GearContact"]),
    "flavour": (["build", "--flavour", "fmi1"], ["'fmi1'", "python"]),
    "build-file": (["build", "--params", "{tmp}/none.toml"], ["none.toml", "No such file"]),
    "build-joint": (
        ["build", "GearContact", "--params", "{tmp}/bolts.toml", "--out", "{tmp}/out"],
        ["GearContact", "'bolted_joint'", "'gear_contact'"],
    ),
    "build-out": (["build", "GearContact", "--out", "{tmp}/text.toml"], ["text.toml", "cannot be written"]),
    "number-unit": (
        ["modes", "a.toml", "--preload", "30kN"],
        ["--preload = '30kN'", "a number in N", "write 30000"],
    ),
    "unit-psi": (
        ["modes", "a.toml", "--preload", "1kPa"],
        ["--preload = '1kPa'", "a number in N, without its unit"],
    ),
    "percent": (
        ["footprint", "import", "a.csv", "--preload", "1", "--force-tolerance", "5%"],
        ["write 0.05"],
    ),
    "comma": (["modes", "a.toml", "--preload", "30,5e3"], ["--preload = '30,5e3' has a comma", "30.5e3"]),
    "whole": (["modes", "a.toml", "--count", "3.5"], ["--count = '3.5' is not a whole number"]),
    "ramp-nothing": (["ramp"], ["FMU", "--input"]),
    "ramp-file": (["ramp", "{tmp}/none.fmu", *RAMP[2:]], ["none.fmu", "no such file"]),
    "ramp-text": (["ramp", "{tmp}/text.fmu", *RAMP[2:]], ["text.fmu", "is not an FMU"]),
    "ramp-input": (ramp(input="force"), ["'force'", "f"]),
    "ramp-output": (ramp(input="K_N"), ["'K_N'", "f"]),
    "ramp-step-0": (ramp(step="0"), ["step = 0", "(0, inf)"]),
    "ramp-step-back": (ramp(step="-1"), ["step = -1", "(0, inf)"]),
    "ramp-step-nan": (ramp(step="nan"), ["step = nan", "finite"]),
    "ramp-to-inf": (ramp(to="inf"), ["to = inf", "finite"]),
    "ramp-endless": (ramp(to="1e9", step="1e-9"), ["step = 1e-09", "1e7"]),
    "ramp-name": ([*RAMP, "--set", "load=1"], ["'load'", "e", "lambda", "surface1.D"]),
    "ramp-value": ([*RAMP, "--set", "e=1.5"], ["e = 1.5", "[0, 1)"]),
    "ramp-word": ([*RAMP, "--set", "e=round"], ["e = 'round'", "number"]),
    "ramp-csv": ([*RAMP, "--csv", "{tmp}/text.toml/x.csv"], ["x.csv", "cannot be written"]),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_refused_in_one_line(run, places, case):
    args, words = BAD[case]
    for extra in ([], ["--json"]):
        if not args:
            extra = []
        status, out, err = run(*(arg.format(**places) for arg in args), *extra)
        assert status == 2
        assert out == ""
        assert len(err.splitlines()) == 1
        assert err.startswith("jointfmu")
        assert "Traceback" not in err
        for word in words:
            assert word in err
    assert sorted(p.name for p in places["tmp"].iterdir() if p.name != "fmus") == [
        *("binary.toml", "bolts.toml", "folder", "gear.toml", "text.fmu", "text.toml"),
    ]


@pytest.mark.parametrize(
    "text",
    [
        'joint = ["bolted_joint"]\nschema = 1',
        "schema = 1\njoint = {}",
        "schema = 1\njoint = 5",
        "[schema]",
        "a=1",
    ],
)
def test_strange_files_are_refused_in_one_line(run, tmp_path, text):
    path = tmp_path / "strange.toml"
    path.write_text(text)
    status, out, err = run(*LAW, "--params", path)
    assert (status, out, len(err.splitlines())) == (2, "", 1)
    assert str(path) in err


def test_a_parameter_beyond_what_is_possible_is_refused_in_one_line(run, tmp_path):
    path = tmp_path / "stiff.toml"
    text = format_parameter_file(load_default("harmonic_drive", "catalogue"))
    path.write_text(re.sub(r"^(K1 = { value = )[^,]*", r"\g<1>1e30", text, flags=re.MULTILINE))
    status, out, err = run("export", "modelica", "curve", "--params", path, "--out", tmp_path / "curve.txt")
    assert (status, out, len(err.splitlines())) == (2, "", 1)
    assert "K1 = 1e+30 N.m/rad is outside (0, 1e+12]" in err
    assert not (tmp_path / "curve.txt").exists()


@pytest.mark.parametrize(
    "args",
    [
        ["zhao2018", "--pressure", "1e300"],
        ["hu2023", "--pressure", "1e300"],
        ["yu2022", "--pressure", "1e300"],
        ["zhao2018", "--pressure", "1e-300"],
        ["hu2023", "--pressure", "1e-300"],
        ["yu2022", "--pressure", "1e-300"],
        ["zhao2018", "--largest-spot", "1e300"],
        ["yu2022", "--largest-spot", "1e-300"],
        ["zhao2018", "--pressure", "1e6", "--set", "surface.G=1e300"],
        ["zhao2018", "--pressure", "1e6", "--set", "surface.G=1e-300"],
        ["hu2023", "--pressure", "1e6", "--set", "side1.E=1e308", "side2.E=1e308"],
        ["yu2022", "--pressure", "1e6", "--set", "A_0=1e-300"],
        ["yu2022", "--pressure", "1e6", "--set", "e=0.999999999999"],
    ],
    ids=" ".join,
)
def test_numbers_at_the_ends_of_floats(run, args):
    """The command prints force, real area and stiffness, or one error line; never a traceback or a
    warning."""
    status, out, err = run("law", *args, "--json")
    if status == 0:
        assert err == ""
        (row,) = json.loads(out)["rows"]
        for name in ("F", "A_r", "K_N"):
            assert row[name] is not None, name
            assert math.isfinite(row[name])
    else:
        assert (status, out, len(err.splitlines())) == (2, "", 1)


# The rest


@pytest.mark.parametrize(
    "args", [[], ["law"], ["build"], ["ramp"], ["validate"]], ids=lambda a: "".join(a) or "top"
)
def test_help(run, args):
    status, out, err = run(*args, "--help")
    assert (status, err) == (0, "")
    assert out.startswith("usage: jointfmu" + "".join(f" {a}" for a in args))
    options = {
        "": ["law", "build", "ramp", "validate"],
        "law": ["--pressure", "--largest-spot", "--params", "--set", "--json", *LAWS],
        "build": ["--flavour", "--params", "--out", "NAME"],
        "ramp": ["--input", "--to", "--step", "--set", "--csv", "FMU"],
        "validate": ["--json"],
    }
    for word in options["".join(args)]:
        assert word in out


def test_version(run):
    assert run("--version") == (0, f"jointfmu {__version__}\n", "")


def test_as_a_module():
    """`python -m jointfmu` runs in a process of its own: exit status, standard output and standard error."""
    command = [sys.executable, "-m", "jointfmu", "law", "zhao2018", "--json", "--pressure"]
    good = subprocess.run([*command, "1e6"], capture_output=True, text=True, timeout=60)
    assert (good.returncode, good.stderr) == (0, "")
    assert json.loads(good.stdout)["rows"][0]["pressure"] == pytest.approx(1e6, rel=1e-12)
    bad = subprocess.run([*command, "-1"], capture_output=True, text=True, timeout=60)
    assert (bad.returncode, bad.stdout) == (2, "")
    assert bad.stderr == "jointfmu law: pressure = -1 Pa is outside [0, inf): nominal contact pressure\n"


def test_a_closed_pipe_is_no_error():
    """`jointfmu validate | head -1` ends without a message."""
    program = "import sys, time; time.sleep(0.5); from jointfmu_tools.cli import main; sys.exit(main())"
    with subprocess.Popen(
        [sys.executable, "-c", program, "validate"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        process.stdout.close()
        assert process.stderr.read() == ""
        assert process.wait(timeout=60) in (0, 120)  # 120: Python could not flush, said by nobody


@pytest.mark.parametrize("package", ["argparse", "numpy", "fmpy"])
@pytest.mark.parametrize("raised", ["KeyboardInterrupt", "ImportError"])
def test_ctrl_c_while_packages_are_imported(package, raised, tmp_path):
    """The command prints one line, even if Ctrl-C comes during the import of commands or packages.

    Packages with C++ bindings raise ImportError in place of KeyboardInterrupt.
    """
    (tmp_path / "any.fmu").touch()
    program = f"""
import signal, sys

class Finder:
    def find_spec(self, name, path, target=None):
        if name == {package!r}:
            try:
                signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt as interrupt:
                raise {raised} from interrupt

sys.meta_path.insert(0, Finder())
sys.modules.pop({package!r}, None)
from jointfmu_tools.cli import main
sys.exit(main(["ramp", "any.fmu", "--input", "f", "--to", "1", "--step", "1"]))
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr in ("jointfmu: interrupted\n", "jointfmu ramp: interrupted\n")
