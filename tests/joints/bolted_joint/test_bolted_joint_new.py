"""Bolted joints from a drawing: layouts, VDI 2230 against printed numbers, every option and refusal."""

import json
import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from clients import needs
from conftest import Fmu, here_alone, refused_line
from jointfmu_tools import cli
from jointfmu_tools.common.shown import list_entries
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.inputs.drawing import vdi2230
from jointfmu_tools.inputs.drawing.tables import read_property_classes, read_threads
from jointfmu_tools.joints.bolted_joint.gross_slip import friction_results
from jointfmu_tools.joints.bolted_joint.new import layout, plate_finite_elements
from jointfmu_tools.studies.uncertainty.problem import state_problem

from jointfmu.contact.roughness import PERSSON_GAMMA, RQ_OVER_RA
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import load_parameter_file

PLATE = ["--plate", "200x100", "--bolts", "4xM12", "--at", "160x60", "--grip", "40"]
STEEL = ["--material", "steel"]
FACES = [*STEEL, "--Ra", "0.8"]
LOAD = ["--preload", "30e3"]
STILL = (0.0, 0.0, 0.0)


@pytest.fixture(autouse=True)
def interface_alone(monkeypatch):
    """The finite elements of the complete joint take seconds; test_bolted_plate.py looks at them."""
    monkeypatch.setattr(
        plate_finite_elements,
        "compute_facts",
        lambda file, *arguments: plate_finite_elements.NewJoint(file, {}, []),
    )


def made(capsys, *words, path=None):
    """What the command finds, as its JSON."""
    out = ["--out", str(path)] if path else []
    assert cli.main(["new", "bolted-joint", *map(str, words), *out, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def positions(count, **given):
    everything = dict.fromkeys(("at", "circle", "grid")) | given
    return layout.bolt_positions(everything, count) * 1e3


# VDI 2230 against printed numbers


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("M8", (18.6, 27.3, 32.0)),
        ("M10", (29.6, 43.4, 50.8)),
        ("M12", (43.0, 63.2, 73.9)),
        ("M16", (80.9, 118.8, 139.0)),
    ],
)
def test_preloads_of_table_a1(name, printed):
    """VDI 2230, part 1, Table A1 (mu_G = 0.12), classes 8.8, 10.9 and 12.9 in kN."""
    found = [
        vdi2230.assembly_preload(read_threads()[name], strength["yield"][0]) / 1e3
        for strength in read_property_classes().values()
    ]
    assert found == pytest.approx(printed, rel=5e-3)


@pytest.mark.parametrize(("name", "printed"), [("M6", 20.1), ("M12", 84.3), ("M20", 245.0), ("M30", 561.0)])
def test_stress_areas_of_iso_898(name, printed):
    assert vdi2230.stress_area(read_threads()[name]) * 1e6 == pytest.approx(printed, rel=2e-3)


def test_members_of_a_textbook():
    """Shigley's Mechanical Engineering Design, example 8-2: two 1/2 in plates of steel and a 0.095 in washer,
    30 Mpsi, frusta of 30 degrees from 1.5 d around a hole of d = 1/2 in: 15.97 Mlbf/in."""
    inch, lbf_in = 0.0254, 4.4482216 / 0.0254
    layers = [vdi2230.ClampedPart(t * inch, 30e6 * 6894.757) for t in (0.095, 0.5, 0.5)]
    d = 0.5 * inch
    compliance = vdi2230.members_compliance(layers, 1.5 * d, d, 10.0, 0.5774, is_tapped=False)
    assert 1.0 / compliance / lbf_in == pytest.approx(15.97e6, rel=1e-3)


@pytest.mark.parametrize("outer", [0.016, 0.022, 0.03, 0.05, 0.2])
@pytest.mark.parametrize("tapped", [False, True])
def test_members_are_the_integral_over_the_cone(outer, tapped):
    """Quadrature of dz/(E A) over the cone, cut off at D_A; and Eq. 36 of VDI 2230 for a free one."""
    grip, bearing, hole, E = 0.04, 0.0166, 0.0135, 210e9
    slope = vdi2230.cone_slope(grip, bearing, outer, tapped)
    layers = [vdi2230.ClampedPart(0.015, E), vdi2230.ClampedPart(0.025, 2.0 * E)]
    z = (np.arange(400_000) + 0.5) * grip / 400_000
    D = np.minimum(bearing + 2.0 * slope * (z if tapped else np.minimum(z, grip - z)), outer)
    area = 0.25 * np.pi * (D**2 - hole**2)
    expected = np.sum(1.0 / (np.where(z < 0.015, E, 2.0 * E) * area)) * grip / z.size
    found = vdi2230.members_compliance(layers, bearing, hole, outer, slope, tapped)
    assert found == pytest.approx(expected, rel=1e-5)
    if outer == 0.2:
        w, one = (2.0 if tapped else 1.0), [vdi2230.ClampedPart(grip, E)]
        end = bearing + w * grip * slope
        text = (bearing + hole) * (end - hole) / ((bearing - hole) * (end + hole))
        closed = 2.0 / w * math.log(text) / (E * math.pi * hole * slope)
        assert vdi2230.members_compliance(one, bearing, hole, outer, slope, tapped) == pytest.approx(closed)


def test_a_bolt_by_hand():
    """M12 over 40 mm, 19.35 mm of it shank: 6 + 19.35 over the nominal area, 20.65 + 6 over d_3, 4.8 nut."""
    M12 = read_threads()["M12"]
    shank = vdi2230.shank_length(M12, 0.04, "hexagon", is_tapped=False)
    assert shank == pytest.approx(40e-3 + 9.6e-3 + 3.5e-3 - 30e-3)
    nominal, minor = 0.25 * math.pi * 12e-3**2, 0.25 * math.pi * 9.853e-3**2
    expected = ((6e-3 + shank + 4.8e-3) / nominal + (40e-3 - shank + 6e-3) / minor) / 205e9
    assert vdi2230.bolt_compliance(M12, 0.04, shank, "hexagon") == pytest.approx(expected, rel=1e-3)
    tapped = vdi2230.bolt_compliance(M12, 0.04, shank, "socket", thread_modulus=70e9)
    nut = 0.33 * 12e-3 / (70e9 * nominal)
    expected = ((4.8e-3 + shank) / nominal + (40e-3 - shank + 6e-3) / minor) / 205e9 + nut
    assert tapped == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("Rz", "tapped", "printed"),
    [(6.3, False, 9.5), (16.0, False, 11.0), (16.0, True, 8.0), (100.0, False, 14.0), (400.0, False, 14.0)],
)
def test_embedding_of_table_5(Rz, tapped, printed):
    """VDI 2230, part 1, Table 5, load along the bolt: thread, head and nut and one interface, in um."""
    assert vdi2230.embedding_depth(Rz * 1e-6, 1, tapped) * 1e6 == pytest.approx(printed)


def test_embedding_takes_of_the_preload(capsys):
    """9.5 um over the compliances of bolt and members; all that is told is at what it leaves."""
    found = facts_of(capsys, *PLATE, *FACES, *LOAD)
    loss = 9.5e-6 / (1.0 / found["bolt_stiffness"] + 1.0 / found["member_stiffness"])
    assert found["embedding"] == pytest.approx(loss)
    assert found["slip_force"] == pytest.approx(0.15 * 4.0 * (30e3 - loss))
    whole = facts_of(capsys, *PLATE, *FACES, *LOAD, "--embedding", "0")
    assert whole["slip_force"] == pytest.approx(0.15 * 4.0 * 30e3)
    assert found["p_mean"] / whole["p_mean"] == pytest.approx(1.0 - loss / 30e3)


# Layouts


def test_layouts():
    assert positions(4, at=["160x60"]).tolist() == [[-80, -30], [80, -30], [-80, 30], [80, 30]]
    assert positions(1).tolist() == [[0, 0]]
    assert positions(3, at=["100x0"]).tolist() == [[-50, 0], [0, 0], [50, 0]]
    assert positions(2, at=["0x40"]).tolist() == [[0, -20], [0, 20]]
    assert positions(6, at=["100x40"], grid="3x2")[:3].tolist() == [[-50, -20], [0, -20], [50, -20]]
    ring = positions(8, at=["200x300"], grid="3x3").tolist()
    assert len(ring) == 8
    assert [0.0, 0.0] not in ring
    np.testing.assert_allclose(
        positions(2, at=["-8cm,1e-2m".replace("cm", "0mm"), "80,0"]), [[-80, 10], [80, 0]]
    )
    circle = positions(6, circle="120")
    np.testing.assert_allclose(np.hypot(*circle.T), 60.0)


@pytest.mark.parametrize(
    "layouts",
    [
        ["--bolts", "M12"],
        ["--bolts", "2xM12", "--at", "-50,-10", "50,10"],
        pytest.param(["--bolts", "6xM8", "--circle", "60"], marks=pytest.mark.slow),
        pytest.param(["--bolts", "6xM10", "--at", "160x60", "--grid", "3x2"], marks=pytest.mark.slow),
    ],
)
def test_any_layout_makes_a_file_that_loads(capsys, tmp_path, layouts):
    path = tmp_path / "plate.toml"
    found = made(capsys, "--plate", "200x100", *layouts, "--grip", "40", *FACES, path=path)
    file = load_parameter_file(path)
    assert found["written"] == [str(path)]
    assert (file.law, file.values.n_bolts) == ("roughness", len(file.values.pattern.x))
    left = file.start_value("preload") - file.values.embedding
    K = left * file.values.n_bolts / (PERSSON_GAMMA * file.values.h)
    assert found["facts"]["interface_K_zz"]["value"] == pytest.approx(
        K, rel=0.05
    )  # p/(gamma h), and few spots
    # every number says where it comes from
    assert all(file.sources[name] for name in file.values_by_name)


def test_numbers_of_the_drawing_are_in_the_file(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    found = made(capsys, *PLATE, *FACES, *LOAD, path=path)
    file = load_parameter_file(path)
    joint, plate = file.values, file.values.pattern
    assert (plate.length, plate.width, plate.hole_diameter) == (0.2, 0.1, 0.0135)
    assert plate.bolts_from_middle.tolist() == [[-0.08, -0.03], [0.08, -0.03], [-0.08, 0.03], [0.08, 0.03]]
    assert (joint.n_bolts, joint.row_bolts, joint.row_distance) == pytest.approx((4.0, 2.0, 0.06))
    assert pytest.approx(0.2 * 0.1 - 4 * math.pi / 4 * 0.0135**2) == joint.A_0
    assert joint.h == pytest.approx(RQ_OVER_RA * 0.8e-6 * math.sqrt(2.0))
    assert file.start_value("preload") == 30e3
    assert file.origins["inputs.preload"] == file.origins["plate.length"] == "user"
    assert (file.origins["A_0"], file.origins["H"]) == ("derived", "estimate")
    slope = vdi2230.cone_slope(0.04, 16.63e-3, 0.04, is_tapped=False)
    assert plate.cone_diameter == pytest.approx(16.63e-3 + 2.0 * 20e-3 * slope)
    facts = {name: fact["value"] for name, fact in found["facts"].items()}
    assert facts["load_factor"] == pytest.approx(
        facts["bolt_stiffness"] / (facts["bolt_stiffness"] + facts["member_stiffness"])
    )
    assert joint.bolt_stiffness == facts["bolt_stiffness"]
    text = path.read_text()
    assert text.splitlines()[1].startswith("# Computed beside the parameters")
    assert "# member_stiffness = " in text


def facts_of(capsys, *words):
    found = made(capsys, *words)
    values = {name: fact["value"] for name, fact in found["facts"].items()}
    return found["parameters"] | values | {"law": found["law"], "name": found["name"]}


@pytest.mark.parametrize(
    ("words", "name", "value"),
    [
        (["--grip", "10mm", "0.03m"], "plate.cone_diameter", lambda old: old),  # of the thinner plate
        (["--material", "steel", "aluminium"], "side2.E", lambda old: 70e9),
        (["--material", "cast-iron"], "side1.E", lambda old: 110e9),
        (["--hardness", "2000"], "H", lambda old: 2e9),
        (["--mu", "0.2"], "mu", lambda old: 0.2),
        (["--Ra", "0.8", "1.6"], "h", lambda old: old * math.sqrt(2.5)),
        (["--longest-wave", "2.5"], "longest_wave", lambda old: 2.5e-3),
        (["--hole", "14"], "plate.hole_diameter", lambda old: 0.014),
        (["--preload", "20kN"], "preload", lambda old: 2e4),
        (["--law", "zhao2018"], "law", lambda old: "zhao2018"),
        (["--name", "my joint"], "name", lambda old: "my joint"),
    ],
)
def test_every_option_changes_its_number(capsys, words, name, value):
    base = facts_of(capsys, *PLATE, *FACES, *LOAD)
    changed = facts_of(capsys, *PLATE, *FACES, *LOAD, *words)
    expected = value(base[name])
    if name == "plate.cone_diameter":
        assert changed[name] < expected
    else:
        assert changed[name] == (expected if isinstance(expected, str) else pytest.approx(expected))


@pytest.mark.slow  # friction of six plates
def test_options_of_the_bolts(capsys):
    base = facts_of(capsys, *PLATE, *FACES, *LOAD)
    socket = facts_of(capsys, *PLATE, *FACES, *LOAD, "--head", "socket")
    assert socket["bolt_stiffness"] != base["bolt_stiffness"]
    assert socket["member_stiffness"] > base["member_stiffness"]  # a wider head
    washer = facts_of(capsys, *PLATE, *FACES, *LOAD, "--bearing", "24")
    assert washer["plate.cone_diameter"] > socket["plate.cone_diameter"]
    tapped = facts_of(capsys, *PLATE, *FACES, *LOAD, "--tapped")
    assert tapped["plate.cone_diameter"] > base["plate.cone_diameter"]  # one cone over the whole grip
    default = facts_of(capsys, *PLATE, *FACES)
    strong = facts_of(capsys, *PLATE, *FACES, "--property-class", "12.9")
    assert default["preload"] == pytest.approx(43.0e3, rel=5e-3)
    assert strong["preload"] == pytest.approx(73.9e3, rel=5e-3)


def test_zhao_2018_gets_the_same_height(capsys, tmp_path):
    from jointfmu_tools.inputs import fractal

    path = tmp_path / "plate.toml"
    made(capsys, *PLATE, *FACES, *LOAD, "--law", "zhao2018", path=path)
    file = load_parameter_file(path)
    h = fractal.rms_height(file.values.surface.D, file.values.surface.G, 0.8e-3)
    assert h == pytest.approx(RQ_OVER_RA * 0.8e-6 * math.sqrt(2.0), rel=1e-9)
    assert dict(file.roughness) == pytest.approx({"Ra1": 0.8e-6, "Ra2": 0.8e-6})
    assert file.values.spot_stiffness == "hertz"


def test_a_finish_has_a_range(capsys):
    found = made(capsys, *PLATE, *STEEL, "--finish", "ground", *LOAD)["facts"]
    ratio = found["interface_K_zz_high"]["value"] / found["interface_K_zz_low"]["value"]
    assert ratio == pytest.approx(16.0)  # Ra 0.1 to 1.6
    both = made(capsys, *PLATE, *STEEL, "--finish", "ground", "milled", *LOAD)["facts"]
    assert both["h"]["value"] > found["h"]["value"]


def test_a_scan_gives_height_and_slope(capsys, tmp_path):
    scan = tmp_path / "scan.csv"
    x = np.arange(2000) * 1e-6
    rng = np.random.default_rng(3)
    z = np.convolve(rng.standard_normal(2000), np.hanning(40), "same") * 1e-7
    rows = "\n".join(f"{a:.9g},{b:.9g}" for a, b in zip(x, z, strict=True))
    scan.write_text(f"{rows}\n")
    words = [*PLATE, *STEEL, "--surface", str(scan)]
    assert "(--unit)" in refused_line(capsys, "new", "bolted-joint", *words)
    found = made(capsys, *words, "--unit", "m", *LOAD)["parameters"]
    assert found["h"] == pytest.approx(math.sqrt(2.0) * np.std(z), rel=0.1)
    assert found["slope"] == pytest.approx(2.0 * np.std(np.diff(z) / 1e-6), rel=0.3)  # isotropic, both sides


# Refusals and warnings


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--plate", "200"], "--plate = '200' has 1 numbers, expected 2, as in 200x100"),
        (["--plate", "200xabc"], "--plate = 'abc' is not a number; expected a number in mm"),
        (["--plate", "200Nx100"], "--plate = '200N': unit 'm' does not measure what 'N' does"),
        (["--plate", "-200x100"], "--plate = '-200' is outside (0, inf)"),
        (["--bolts", "four"], "--bolts = 'four' are no bolts; expected a number and a thread, as in 4xM12"),
        (["--bolts", "4xM13"], "thread M13 is unknown, allowed are M3, M4"),
        (["--bolts", "0xM12"], "--bolts = '0xM12' are no bolts"),
        (["--bolts", "5xM12"], "5 bolts on a rectangle: expected --grid"),
        (["--bolts", "M12"], "--at LxW beside one bolt: expected the number of --bolts, as in 4xM12"),
        (["--mu", "15"], "--mu = '15' is outside (0, 2]: coefficient of friction of metals"),
        (["--at", "220x60"], "bolt 1 at (-110, -30) mm is not inside the plate"),
        (["--at", "190x60"], "is not inside the plate; allowed are |x| < 0.09325 m"),
        (["--at", "10x60"], "the holes of bolts 1 and 2 overlap"),
        (["--at", "0,0", "10,10"], "--at has 2 places, expected 4: one for each of --bolts"),
        (["--at", "160x60", "80x30"], "expected one LxW, or the place X,Y of each bolt"),
        (["--grid", "3x2"], "--grid = 3x2 has 6 bolts, but --bolts states 4"),
        (["--grid", "2"], "--grid = '2' is not a grid"),
        (["--circle", "80"], "--at beside --circle: expected one of them"),
        (["--grip", "0"], "--grip = '0' is outside (0, inf)"),
        (["--grip", "1", "2", "3"], "--grip has 3 values, expected both plates together, or each"),
        (["--tapped", "--grip", "10", "30"], "--grip has 2 values, expected that of side 1"),
        (["--hole", "11"], "--hole = 11 mm is outside (12, inf) mm"),
        (["--bearing", "13"], "--bearing = 13 mm is outside (13.5, inf) mm"),
        (["--preload", "-1"], "--preload = '-1' is outside (0, inf)"),
        (["--preload", "nan"], "--preload = 'nan' is not a number"),
        (["--preload", "2kN"], "embedding takes 2643 N of a preload of 2000 N: expected less than all"),
        (["--embedding", "-1"], "embedding = -1 N is outside [0, inf)"),
        (["--material", "unobtainium"], "material 'unobtainium' is unknown, allowed are steel,"),
        (["--material", "steel", "steel", "steel"], "--material has 3 values"),
        (["--Rq", "1"], "--Ra and --Rq are given together; state the roughness once"),
        (["--finish", "licked"], "finish 'licked' is unknown, allowed are turned,"),
        (["--tapped", "--field", "computed"], "--tapped: expected --thickness of both plates for it"),
        (["--law", "hu2023"], "invalid choice: 'hu2023'"),
    ],
)
def test_what_does_not_fit_is_refused(capsys, tmp_path, words, text):
    path = tmp_path / "plate.toml"
    line = refused_line(capsys, "new", "bolted-joint", *PLATE, *FACES, *words, "--out", path)
    assert text in line
    assert not path.exists()


def test_a_roughness_must_be_stated(capsys):
    line = refused_line(capsys, "new", "bolted-joint", *PLATE, *STEEL)
    assert "the roughness is missing; expected --finish, --Ra, --Rq or --surface" in line
    both = ["--surface", "scan.csv", "--finish", "ground"]
    line = refused_line(capsys, "new", "bolted-joint", *PLATE, *STEEL, *both)
    assert "--surface and --finish are both given; state one of them" in line


def test_places_must_be_stated(capsys):
    words = ["--plate", "200x100", "--bolts", "4xM12", "--grip", "40", *FACES]
    assert "the places of 4 bolts are missing" in refused_line(capsys, "new", "bolted-joint", *words)


def test_a_preload_no_bolt_bears_is_warned_of(capsys):
    assert made(capsys, *PLATE, *FACES, "--preload", "80e3")["warnings"] == []
    (line,) = made(capsys, *PLATE, *FACES, "--preload", "90e3")["warnings"]
    assert line == (
        "preload = 90000 N is above 8.174e+04 N, the proof load of M12, class 12.9 (ISO 898-1), "
        "the largest bolt that passes the hole"
    )
    (line,) = made(capsys, *PLATE, *FACES, "--preload", "60e3", "--property-class", "8.8")["warnings"]
    assert line.endswith("the proof load of M12-8.8 (ISO 898-1)")


def test_a_pressure_beyond_the_hardness_is_warned_of(capsys):
    (line,) = made(capsys, *PLATE, *FACES, "--hardness", "10", *LOAD)["warnings"]
    assert "above the hardness of the softer body, 1e+07 Pa" in line


# Down to the FMU


@pytest.mark.slow
def test_the_fmu_of_a_drawing_is_the_package(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    made(capsys, *PLATE, *FACES, *LOAD, path=path)
    command = ["build", "BoltedJoint", "--params", str(path), "--flavour", "fmi2", "--out", str(tmp_path)]
    with here_alone():
        assert cli.main(command) == 0
    instance = Fmu(tmp_path / "fmi2" / "BoltedJoint.fmu")
    spring = BoltedJointSpring.for_joint(load_parameter_file(path).values)
    for preload, moment, s_rel in (
        (3e4, 0.0, STILL),
        (2e4, 300.0, (1e-7, -2e-7, 3e-7)),
        (3e4, 0.0, (0.0, 0.0, 5e-5)),
    ):
        inputs = {"preload": preload, "moment": moment}
        inputs |= {f"s_rel_{axis}": value for axis, value in zip("xyz", s_rel, strict=True)}
        instance.reset()
        found, expected = instance.start(inputs).get(), spring.evaluate(preload, moment, s_rel, STILL)
        for name, value in expected.items():
            scale = 1e-9 * preload if name.startswith(("f_", "m_")) else 0.0
            assert found[name] == pytest.approx(float(value), rel=1e-9, abs=scale), name


@needs("gmsh")
@pytest.mark.slow
def test_a_computed_field_is_near_the_cones(capsys, tmp_path, monkeypatch):
    """By elements of thrice the size, whose error is far below what is asked."""
    monkeypatch.setattr(BoltedContact, "from_assembly", partial(BoltedContact.from_assembly, refinement=0.35))
    files = {}
    for field in ("cones", "computed"):
        path = tmp_path / f"{field}.toml"
        words = ["--plate", "60x60", "--bolts", "M16", "--grip", "30", *FACES, "--preload", "60e3"]
        made(capsys, *words, "--field", field, path=path)
        files[field] = BoltedJointSpring.for_joint(load_parameter_file(path).values).evaluate(
            6e4, 0.0, STILL, STILL
        )
    for name, within in (
        ("K_zz", 0.01),
        ("K_rx", 0.25),
        ("p_max", 0.4),
    ):
        assert float(files["cones"][name]) == pytest.approx(float(files["computed"][name]), rel=within), name


@needs("gmsh")
@pytest.mark.slow
def test_a_computed_field_of_a_tapped_joint_is_near_the_cone(capsys, tmp_path, monkeypatch):
    """As wide as VDI 2230's cone for a thread, in a joint without symmetry whose rims of the holes come to
    the hardness of aluminium under moments and more preload. Of coarser elements, too."""
    monkeypatch.setattr(BoltedContact, "from_assembly", partial(BoltedContact.from_assembly, refinement=0.7))
    files = {}
    for field in ("cones", "computed"):
        path = tmp_path / f"{field}.toml"
        words = ["--plate", "100x70", "--bolts", "3xM8", "--at", "-30,-20", "25,-10", "3,18", "--grip", "12"]
        words += ["--tapped", "--thickness", "12", "25", "--material", "steel", "aluminium", "--Ra", "0.8"]
        made(capsys, *words, "--field", field, path=path)
        files[field] = load_parameter_file(path).values
    sums = []
    for values in files.values():
        bolts = np.array([[-0.03, -0.02], [0.025, -0.01], [0.003, 0.018]])
        shape = values.pattern.pressure_distribution()
        centre = bolts.mean(axis=0) - (shape.area_share * shape.preload_pressure_ratio) @ shape.position
        near = np.min(np.hypot(*np.moveaxis(shape.position[:, None] + centre - bolts, -1, 0)), axis=1)
        sums.append(np.sqrt((shape.area_share * shape.preload_pressure_ratio) @ near**2))
    assert sums[1] == pytest.approx(sums[0], rel=0.12)


# The range of the friction


def test_friction_of_which_nothing_is_said_has_a_range(capsys, tmp_path):
    """In the file, read back, in what the command tells of slip and loss, and in a study."""
    path = tmp_path / "plate.toml"
    facts = {
        name: fact["value"] for name, fact in made(capsys, *PLATE, *FACES, *LOAD, path=path)["facts"].items()
    }
    file = load_parameter_file(path)
    low, high = file.ranges["mu"]
    assert low < file.values_by_name["mu"] < high
    assert "VDI 2230" in file.sources["mu"]
    left = 30e3 - facts["embedding"]
    assert facts["slip_force_low"] == pytest.approx(low * 4 * left)
    assert facts["slip_force_high"] == pytest.approx(high * 4 * left)
    # under the same shear a small loop loses as 1/mu: within what partial slip adds at a tenth of gross slip
    ratio = facts["loss_factor_low"] / facts["loss_factor_high"]
    assert ratio == pytest.approx(high / low, rel=0.1)
    assert facts["loss_factor_high"] < facts["loss_factor"] < facts["loss_factor_low"]
    bare = replace(file, values=replace(file.values, embedding=0.0))  # embedding takes of the preload once
    np.testing.assert_allclose(friction_results(file, 30e3)[1], friction_results(bare, left)[1], rtol=1e-9)
    (mu,) = (each for each in list_entries(file) if each.name == "mu")
    assert mu.source.startswith(f"{low:g} to {high:g}; ")
    study = state_problem(file, {}, 30e3, 3)
    assert [(each.name, each.support) for each in study.uncertain_parameters] == [("mu", (low, high))]
    assert state_problem(file, {"mu": "interval"}, 30e3, 3).uncertain_parameters[0].support == (low, high)
    assert "mu" not in {
        each.name for each in state_problem(file, {"mu": 0.2, "h": "+-10%"}, 30e3, 3).uncertain_parameters
    }
    assert not file.with_values({"mu": 0.2}, "user", "set").ranges


def test_friction_that_is_stated_has_no_range(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    facts = made(capsys, *PLATE, *FACES, *LOAD, "--mu", "0.2", path=path)["facts"]
    assert not load_parameter_file(path).ranges
    assert {name for name in facts if name.startswith("slip_force")} == {"slip_force"}


@pytest.mark.parametrize("text", ["[0.2, 0.3]", "[0.1]", "[0.3, 0.1]", "[-0.1, 0.3]", "0.3", '["a", 1]'])
def test_a_range_that_does_not_hold_the_value_is_refused(capsys, tmp_path, text):
    path = tmp_path / "plate.toml"
    made(capsys, *PLATE, *FACES, *LOAD, path=path)
    path.write_text(path.read_text().replace("range = [0.1, 0.3]", f"range = {text}"))
    with pytest.raises(ValueError, match=r"mu.*range =|range of mu") as refusal:
        load_parameter_file(path)
    assert "\n" not in str(refusal.value)
