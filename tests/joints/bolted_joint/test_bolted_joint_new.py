"""Bolted joints from a drawing: layouts, VDI 2230 against printed numbers, all options and refusals."""

import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import coarse
import numpy as np
import pytest
from clients import needs
from conftest import Fmu, here_alone, refused_line, warnings_but_shape
from jointfmu_tools import cli
from jointfmu_tools.common.shown import list_parameter_file_entries
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.inputs.drawing import vdi2230
from jointfmu_tools.inputs.drawing.tables import (
    find_thread,
    read_property_classes,
    read_threads,
    read_tightening_methods,
    read_washers,
)
from jointfmu_tools.joints.bolted_joint.gross_slip import compute_friction_results, compute_preload_results
from jointfmu_tools.joints.bolted_joint.new import (
    NEW_JOINT_COMMAND,
    STANDARD_WASHER_OPTION,
    TIGHTENING_METHODS,
    layout,
    plate,
)
from jointfmu_tools.joints.bolted_joint.new.plate import read_drawing
from jointfmu_tools.joints.bolted_joint.report import make_preload_figures
from jointfmu_tools.studies.uncertainty.problem import define_joint_study, resolve_interval_setting

import jointfmu
from jointfmu.contact.roughness import PERSSON_GAMMA, RQ_OVER_RA
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import load_parameter_file

PLATE = ["--plate", "200x100", "--bolts", "4xM12", "--at", "160x60", "--grip", "40"]
STEEL = ["--material", "steel"]
FACES = [*STEEL, "--Ra", "0.8"]
LOAD = ["--preload", "30e3"]
DRAWING = {"plate": (200, 100), "bolts": "4xM12", "at": (160, 60), "grip": 40, "material": "steel"}
DRAWING |= {"Ra": 0.8, "sides": "rigid"}
"""Plates of the words above, for Python: the interface alone."""
STILL = (0.0, 0.0, 0.0)


def made(capsys, *words, path=None):
    """JSON object that the command prints about the interface alone; test_bolted_plate.py has the complete
    joint."""
    out = ["--out", str(path)] if path else []
    sides = ["--sides", "rigid"]
    assert cli.main(["new", "bolted-joint", *map(str, words), *sides, *out, "--json"]) == 0
    return warnings_but_shape(json.loads(capsys.readouterr().out))


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
    """Preloads agree with VDI 2230, part 1, Table A1 (mu_G = 0.12), classes 8.8, 10.9 and 12.9 in kN."""
    found = [
        vdi2230.assembly_preload(read_threads()[name], strength["yield"][0]) / 1e3
        for strength in read_property_classes().values()
    ]
    assert found == pytest.approx(printed, rel=5e-3)


@pytest.mark.parametrize(("name", "printed"), [("M6", 20.1), ("M12", 84.3), ("M20", 245.0), ("M30", 561.0)])
def test_stress_areas_of_iso_898(name, printed):
    assert vdi2230.stress_area(read_threads()[name]) * 1e6 == pytest.approx(printed, rel=2e-3)


def test_members_of_a_textbook():
    """The member stiffness is that of Shigley's Mechanical Engineering Design, example 8-2: 15.97 Mlbf/in.

    Two 1/2 in plates of steel and a 0.095 in washer, 30 Mpsi, frusta of 30 degrees from 1.5 d around a hole
    of d = 1/2 in.
    """
    inch, lbf_in = 0.0254, 4.4482216 / 0.0254
    layers = [vdi2230.ClampedPart(t * inch, 30e6 * 6894.757) for t in (0.095, 0.5, 0.5)]
    d = 0.5 * inch
    compliance = vdi2230.members_compliance(layers, 1.5 * d, d, 10.0, 0.5774, is_tapped=False)
    assert 1.0 / compliance / lbf_in == pytest.approx(15.97e6, rel=1e-3)


@pytest.mark.parametrize("outer", [0.016, 0.022, 0.03, 0.05, 0.2])
@pytest.mark.parametrize("tapped", [False, True])
def test_members_are_the_integral_over_the_cone(outer, tapped):
    """The compliance is the quadrature of dz/(E A) over the cone, cut off at D_A; for a complete cone also
    Eq. 36 of VDI 2230."""
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
    """The bolt compliance equals a calculation by hand: M12 with 40 mm grip and 19.35 mm shank.

    Lengths: 6 + 19.35 mm with the nominal area, 20.65 + 6 mm with d_3, 4.8 mm in the nut.
    """
    M12 = read_threads()["M12"]
    shank = vdi2230.unthreaded_shank_length(M12, 0.04, "hexagon", is_tapped=False)
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
    [
        (6.3, False, 9.5),
        (10.0, False, 9.5),
        (16.0, False, 11.0),
        (16.0, True, 8.0),
        (100.0, False, 14.0),
        (400.0, False, 14.0),
    ],
)
def test_embedding_of_table_5(Rz, tapped, printed):
    """Embedding [um] agrees with VDI 2230, part 1, Table 5 (axial load): thread, head, nut, one interface."""
    assert vdi2230.embedding_depth(Rz * 1e-6, 1, tapped) * 1e6 == pytest.approx(printed)


def test_embedding_takes_of_the_preload(capsys):
    """9.5 um over the compliance of bolt and members; all printed results are for the remaining preload."""
    found = facts_of(capsys, *PLATE, *FACES, *LOAD)
    loss = 9.5e-6 / (1.0 / found["bolt_stiffness"] + 1.0 / found["member_stiffness"])
    assert found["embedding"] == pytest.approx(loss)
    assert found["slip_force"] == pytest.approx(0.15 * 4.0 * (30e3 - loss))
    whole = facts_of(capsys, *PLATE, *FACES, *LOAD, "--embedding", "0")
    assert whole["slip_force"] == pytest.approx(0.15 * 4.0 * 30e3)
    assert found["p_mean"] / whole["p_mean"] == pytest.approx(1.0 - loss / 30e3)


# Preload from the tightening torque


def preload_of(torque, thread, mu_G, mu_K):
    diameter = vdi2230.head_friction_diameter(thread.hexagon_bearing_diameter, thread.hole_diameter)
    arms = vdi2230.torque_per_preload(thread.pitch, vdi2230.pitch_diameter(thread), diameter, mu_G, mu_K)
    return torque / arms


@pytest.mark.parametrize(
    ("name", "pitch", "mu", "preload", "torque"),
    [
        ("M8", None, 0.12, 18.6, 24.6),
        ("M10", None, 0.12, 29.6, 48.0),
        ("M12", None, 0.10, 44.1, 73.0),
        ("M12", None, 0.12, 43.0, 84.0),
        ("M12", None, 0.14, 41.9, 93.0),
        ("M16", None, 0.12, 80.9, 206.0),
        ("M10", 1.25e-3, 0.12, 31.6, 51.0),
        ("M12", 1.25e-3, 0.10, 49.1, 79.0),
        ("M12", 1.25e-3, 0.12, 48.0, 90.0),
        ("M16", 1.5e-3, 0.14, 85.5, 244.0),
    ],
)
def test_torques_of_tables_a1_and_a3(name, pitch, mu, preload, torque):
    """Preload [kN] and torque [N.m] agree with VDI 2230, part 1, Tables A1 and A3, class 8.8, mu_G = mu_K."""
    thread = find_thread(name, pitch)
    assert vdi2230.assembly_preload(thread, 640e6, mu) / 1e3 == pytest.approx(preload, rel=5e-3)
    assert preload_of(torque, thread, mu, mu) / 1e3 == pytest.approx(preload, rel=0.015)


def test_scatter_of_table_a8():
    """Table A8 of VDI 2230 prints alpha_A and the scatter."""
    for factor, scatter in ((1.2, 0.09), (1.4, 0.17), (1.6, 0.23), (2.0, 0.33), (2.5, 0.43), (4.0, 0.60)):
        assert vdi2230.preload_scatter(factor) == pytest.approx(scatter, abs=0.005)
    assert {*read_tightening_methods()} == {*TIGHTENING_METHODS}


TORQUE = ["--torque", "84"]
KNOWN = ["--thread-friction", "0.12", "--head-friction", "0.12"]


def test_a_torque_gives_a_preload_with_its_range(capsys, tmp_path):
    """84 N.m on M12 with mu = 0.12: Table A1 has 43.0 kN; a torque wrench scatters by a third."""
    path = tmp_path / "plate.toml"
    facts = facts_of(capsys, *PLATE, *FACES, *TORQUE, *KNOWN)
    assert facts["preload"] == pytest.approx(43.0e3, rel=0.01)
    made(capsys, *PLATE, *FACES, *TORQUE, *KNOWN, path=path)
    file = load_parameter_file(path)
    low, high = file.ranges["inputs.preload"]
    assert (low, high) == pytest.approx((facts["preload"] * 2.0 / 3.0, facts["preload"] * 4.0 / 3.0))
    assert (facts["preload_low"], facts["preload_high"]) == pytest.approx((low, high))
    assert file.origins["inputs.preload"] == "derived"
    assert "D_Km = 15.06 mm, mu_G = 0.12, mu_K = 0.12; torque wrench" in file.sources["inputs.preload"]
    assert "alpha_A = 1.6 to 2 (VDI 2230, Table A8)" in file.sources["inputs.preload"]
    left = facts["embedding"]
    for end, preload in (("low", low), ("high", high)):
        assert facts[f"slip_force_at_{end}_preload"] == pytest.approx(0.15 * 4.0 * (preload - left))
    for name in ("K_zz", "K_xx", "opening_load"):
        assert facts[f"{name}_at_low_preload"] < facts[f"{name}_at_high_preload"]
    # the stiffness is that of the FMU, the interface opens at the preload of all bolts and what they add
    spring = BoltedJointSpring.from_joint(file.values)
    K = spring.evaluate(low, 0.0, STILL, STILL)["K_zz"]
    assert facts["K_zz_at_low_preload"] == pytest.approx(float(K), rel=1e-6)
    assert facts["opening_load_at_low_preload"] == pytest.approx(4.0 * (low - left), rel=0.05)


def test_python_takes_a_torque_too(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    made(capsys, *PLATE, *FACES, *TORQUE, *KNOWN, "--tightening", "angle", path=path)
    friction = {"thread_friction": 0.12, "head_friction": 0.12}
    joint = jointfmu.bolted_joint(**DRAWING, torque=84, tightening="angle", **friction)
    file = load_parameter_file(path)
    assert joint.file.inputs == file.inputs
    assert joint.file.ranges == file.ranges
    with pytest.raises(ValueError, match=r"^torque with preload: state one of them"):
        jointfmu.bolted_joint(**DRAWING, torque=84, preload="43kN")


def test_friction_of_a_torque_widens_the_range(capsys):
    """The interval of the friction adds to the range if the method depends on friction, as a torque wrench
    does."""
    known = facts_of(capsys, *PLATE, *FACES, *TORQUE, *KNOWN)
    usual = facts_of(capsys, *PLATE, *FACES, *TORQUE)
    assert usual["preload"] == known["preload"]
    assert usual["preload_low"] == known["preload_low"]
    slippery = preload_of(84.0, read_threads()["M12"], 0.08, 0.08)
    assert usual["preload_high"] == pytest.approx(slippery)
    assert slippery > known["preload_high"]
    angle = facts_of(capsys, *PLATE, *FACES, *TORQUE, "--tightening", "angle")
    assert angle["preload_high"] / angle["preload_low"] == pytest.approx(1.4)
    stated = facts_of(capsys, *PLATE, *FACES, *TORQUE, "--head-friction", "0.1..0.14", *KNOWN[:2])
    assert stated["preload_high"] == known["preload_high"]
    sticky = facts_of(capsys, *PLATE, *FACES, *TORQUE, "--head-friction", "0.18", *KNOWN[:2])
    assert sticky["preload"] < known["preload"]


def test_a_stated_preload_scatters_if_its_tightening_is_stated(capsys):
    found = facts_of(capsys, *PLATE, *FACES, *LOAD, "--tightening", "impact")
    assert (found["preload_low"], found["preload_high"]) == pytest.approx((12e3, 48e3))
    assert "preload_low" not in facts_of(capsys, *PLATE, *FACES, *LOAD)


def test_the_yield_strength_limits_the_torque(capsys):
    words = [*PLATE, *FACES, *KNOWN, "--property-class", "8.8", "--torque"]
    found = made(capsys, *words, "84")
    assert [line[:12] for line in found["warnings"]] == ["preload_high", "upper end of"]
    assert found["facts"]["yield_utilisation"]["value"] == pytest.approx(0.9, rel=0.01)
    line = made(capsys, *words, "90")["warnings"][0]
    assert (
        "uses 97% of the yield strength of M12-8.8 in tightening (VDI 2230, von Mises), allowed are" in line
    )
    line = refused_line(capsys, "new", "bolted-joint", *words, "110")
    assert "1.18 times the yield strength of M12-8.8; expected up to 83.6 N.m (VDI 2230: 90%)" in line
    for torque, advice in (("84000", "check the unit, as in 84000N.mm"), ("0.084", "as in 0.084kN.m")):
        assert refused_line(capsys, "new", "bolted-joint", *words, torque).rstrip().endswith(advice)
    line = refused_line(capsys, "new", "bolted-joint", *PLATE, *FACES, "--torque", "840")
    assert "times the yield strength of M12-12.9, the strongest class" in line


def test_the_upper_end_of_the_preload_is_checked_as_a_preload(capsys):
    """The upper end comes from the smallest friction: its utilisation is that of this friction, if stated."""
    words = [*PLATE, *FACES, *TORQUE, "--property-class", "12.9"]
    found = facts_of(capsys, *words)
    least = facts_of(capsys, *words, "--thread-friction", "0.08", "--head-friction", "0.08")
    assert found["preload_high"] == pytest.approx(least["preload"])
    assert found["yield_utilisation_high"] == pytest.approx(least["yield_utilisation"])
    # scatter alone: the friction is that of the preload, so the utilisation is proportional to the force
    angle = facts_of(capsys, *words, "--tightening", "angle")
    assert angle["yield_utilisation_high"] / angle["yield_utilisation"] == pytest.approx(
        angle["preload_high"] / angle["preload"]
    )
    words = [*words[:-1], "8.8", "--torque"]
    line, proof = made(capsys, *words, "84")["warnings"]
    assert "above 4.887e+04 N, the proof load of M12-8.8" in proof  # 580 MPa x 84.3 mm2
    safe = re.search(r"at most --torque ([\d.]+)$", line)[1]
    assert made(capsys, *words, safe)["warnings"] == []
    assert made(capsys, *words, str(1.03 * float(safe)))["warnings"]


def test_fine_threads(capsys):
    count, thread = layout.parse_bolts("4xM12x1.25")
    assert (count, thread.thread_name, thread.pitch) == (4, "M12x1.25", pytest.approx(1.25e-3))
    assert thread.hexagon_bearing_diameter == read_threads()["M12"].hexagon_bearing_diameter
    assert layout.parse_bolts("M12x1.75")[1] is read_threads()["M12"]
    with pytest.raises(
        ValueError, match=r"thread M12x1 is unknown, allowed pitches of M12 are 1.75, 1.5, 1.25 mm"
    ):
        layout.parse_bolts("4xM12x1")
    fine = facts_of(capsys, "--plate", "200x100", "--bolts", "4xM12x1.25", *PLATE[4:], *FACES)
    assert fine["preload"] == pytest.approx(48.0e3, rel=5e-3)
    assert fine["bolt_stiffness"] > facts_of(capsys, *PLATE, *FACES)["bolt_stiffness"]


def test_a_preload_range_reaches_report_and_study(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    facts = facts_of(capsys, *PLATE, *FACES, *TORQUE, *KNOWN)
    made(capsys, *PLATE, *FACES, *TORQUE, *KNOWN, path=path)
    file = load_parameter_file(path)
    rows = {row.preload: row for row in compute_preload_results(file)}
    assert len(rows) == 3
    history = SimpleNamespace(file=file)
    (figure,) = make_preload_figures(history)
    assert len(figure.table_rows) == 4
    assert "torque wrench" in figure.description
    study = define_joint_study(file, {}, None, 3)
    load = study.uncertain_parameters[-1]
    left = facts["embedding"]  # the load of a study is what embedding leaves
    assert (load.name, load.support_interval) == (
        "preload", pytest.approx((facts["preload_low"] - left, facts["preload_high"] - left)),
    )  # fmt: skip
    assert study.loads == pytest.approx([facts["preload"] - left])  # nominal: that of the file
    assert "opening_load" in study.output_units
    low, high = file.ranges["inputs.preload"]  # of an FMU, whose input is what is tightened
    assert resolve_interval_setting("preload", "interval", file) == f"{low!r}..{high!r}"
    # a stated ramp takes the place of the range
    ramped = define_joint_study(file, {}, 30e3, 3).uncertain_parameters
    assert {each.name for each in ramped} == {"mu", "gamma"}
    bare = replace(file, ranges={"inputs.preload": (1e3, 50e3)})
    with pytest.raises(ValueError, match="the joint may lose all of it"):
        define_joint_study(bare, {}, None, 3)


def test_a_column_of_the_bed_thickness_tilts_as_a_large_bed():
    """Rotational stiffness of a rigid disc on a half-space, 8 G a^3/(3 (1 - nu)), is E I/T of the column."""
    a, nu = 0.05, 0.3
    side = a * math.sqrt(math.pi)  # a square of the same area
    pattern = SimpleNamespace(length=side, width=side)
    thickness = plate._compute_bed_thickness(pattern)["bed_thickness"][0]
    E = 210e9
    half_space = 8.0 * E / (2.0 * (1.0 + nu)) * a**3 / (3.0 * (1.0 - nu))
    assert E * math.pi * a**4 / 4.0 / thickness == pytest.approx(half_space, rel=0.02)  # 0.3: one digit


# Washers


ANALYSED = ["--plate", "30x30", "--bolts", "M8", "--grip", "3", "10", "--hole", "8.4", "--preload", "13e3"]
ANALYSED += ["--material", "titanium", "steel", "--Ra", "0.8"]
"""An M8 bolt through 3 mm of titanium and 10 mm of steel, in a solid of 30 mm."""


def test_load_factor_of_a_published_analysis(capsys):
    """The load factor is that of a published analysis by ECSS-E-HB-32-23A: 0.181, with a 1.5 mm washer."""
    assert facts_of(capsys, *ANALYSED)["load_factor"] > 1.05 * 0.181
    found = facts_of(capsys, *ANALYSED, "--washers", "16x1.5")
    assert found["load_factor"] == pytest.approx(0.181, rel=0.01)
    thread = read_threads()["M8"]
    shank = vdi2230.unthreaded_shank_length(thread, 14.5e-3, "hexagon", is_tapped=False)
    bolt = 1.0 / vdi2230.bolt_compliance(thread, 14.5e-3, shank, "hexagon")
    assert bolt == pytest.approx(3.001e8, rel=0.02)  # with one washer, as in the analysis


@pytest.mark.parametrize("stated", ["24x2.5", "24mmx2500um", "ISO 7089", "iso7089"])
def test_washers_of_the_standard_are_those_of_stated_size(capsys, stated):
    alone = facts_of(capsys, *PLATE, *FACES, *LOAD, "--washers")
    found = facts_of(capsys, *PLATE, *FACES, *LOAD, "--washers", stated)
    for name in ("bolt_stiffness", "member_stiffness", "washer_stiffness", "embedding", "slip_force"):
        assert found[name] == pytest.approx(alone[name], rel=1e-12), name


def test_washers_are_clamped_parts_with_the_cone_of_the_head(capsys):
    """The cone of VDI 2230 from the head through washer, both plates and washer, with equal hole
    diameters."""
    words = [*PLATE, *FACES, *LOAD, "--hole", "13"]
    found, base = facts_of(capsys, *words, "--washers"), facts_of(capsys, *words)
    layers = [vdi2230.ClampedPart(t, E) for t, E in ((2.5e-3, 205e9), (0.04, 210e9), (2.5e-3, 205e9))]
    slope = vdi2230.cone_slope(0.045, 16.63e-3, 0.04, is_tapped=False)
    delta_P = vdi2230.members_compliance(layers, 16.63e-3, 0.013, 0.04, slope, is_tapped=False)
    assert 1.0 / found["member_stiffness"] == pytest.approx(delta_P, rel=1e-9)
    thread = read_threads()["M12"]
    shank = vdi2230.unthreaded_shank_length(thread, 0.045, "hexagon", is_tapped=False)
    delta_S = vdi2230.bolt_compliance(thread, 0.045, shank, "hexagon")
    assert found["load_factor"] == pytest.approx(delta_P / (delta_S + delta_P), rel=1e-9)
    series = delta_S + 1.0 / found["washer_stiffness"]
    assert found["bolt_stiffness"] == pytest.approx(1.0 / series, rel=1e-9)
    assert found["embedding"] == pytest.approx(12.5e-6 / (delta_S + delta_P), rel=1e-9)  # 9.5 um + 2 x 1.5 um
    assert found["plate.cone_diameter"] > base["plate.cone_diameter"]
    assert found["interface_K_zz"] == pytest.approx(base["interface_K_zz"], rel=0.05)


def test_a_washer_limits_the_cone(capsys):
    """With a washer 6 mm thick, the cone from the head reaches the outer diameter of 18 mm inside
    the washer."""
    narrow = vdi2230.washer_compliance(16.63e-3, replace(read_washers()["M12"], outer_diameter=18e-3,
                                                         thickness=6e-3), 0.5)  # fmt: skip
    z = (np.arange(100_000) + 0.5) * 6e-3 / 100_000
    area = 0.25 * np.pi * (np.minimum(16.63e-3 + z, 18e-3) ** 2 - 13e-3**2)
    assert narrow == pytest.approx(np.mean(6e-3 / (205e9 * area)), rel=1e-6)
    found = facts_of(capsys, *PLATE, *FACES, *LOAD, "--washers", "18x6")
    slope = vdi2230.cone_slope(0.052, 16.63e-3, 0.04, is_tapped=False)
    assert found["plate.cone_diameter"] == pytest.approx(18e-3 + 2.0 * 20e-3 * slope)


def test_finite_elements_and_file_have_the_washers(capsys, tmp_path):
    """The bearing face is the cone below the washer, at most D; the washers are in series with the bolt."""
    drawing = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options)
    drawing |= {"plate": "200x100", "bolts": "4xM12", "at": ["160x60"], "grip": ["40"]}
    drawing |= {"material": ["steel"], "Ra": ["0.8"], "preload": "30e3"}
    seats = [
        read_drawing(drawing | {"washers": washers}).bolted_plates.bearing_diameter
        for washers in (None, STANDARD_WASHER_OPTION, "18x2.5")
    ]
    slope = vdi2230.cone_slope(0.045, 16.63e-3, 0.04, is_tapped=False)
    assert seats == pytest.approx([16.63e-3, 16.63e-3 + 2.0 * 2.5e-3 * slope, 18e-3])
    path = tmp_path / "plate.toml"
    facts = made(capsys, *PLATE, *FACES, *LOAD, "--washers", "18x2.5", path=path)["facts"]
    file = load_parameter_file(path)
    assert file.values.bolt_stiffness == facts["bolt_stiffness"]["value"]
    assert "5 mm of washers, in series with two washers of 18 x 2.5 mm" in file.sources["bolt_stiffness"]
    assert "three interfaces (plates, two washers)" in file.sources["embedding"]
    assert (
        "cone from d_w = 16.63 mm through 2.5 mm of washer and 20 mm" in file.sources["plate.cone_diameter"]
    )
    assert "# washer_stiffness = " in path.read_text()


def test_a_tapped_thread_has_one_washer(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    both = facts_of(capsys, *PLATE, *FACES, *LOAD, "--washers")
    one = facts_of(capsys, *PLATE, *FACES, *LOAD, "--tapped", "--washers")
    assert one["washer_stiffness"] == pytest.approx(2.0 * both["washer_stiffness"], rel=0.1)
    made(capsys, *PLATE, *FACES, *LOAD, "--tapped", "--washers", path=path)
    source = load_parameter_file(path).sources["embedding"]
    assert "8.5 um (Table 5: thread, head, two interfaces (plates, washer)" in source


def test_the_torque_turns_the_head_on_the_washer(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    made(capsys, *PLATE, *FACES, *TORQUE, *KNOWN, "--washers", "30x4", path=path)
    assert "D_Km = 14.81 mm" in load_parameter_file(path).sources["inputs.preload"]  # (16.63 + 13)/2


def test_python_takes_washers(capsys):
    none, standard, stated, without = (
        jointfmu.bolted_joint(**DRAWING, preload=30e3, washers=washers)
        for washers in (None, True, (24, 2.5), False)
    )
    assert standard.file.values == stated.file.values
    assert without.file == none.file
    assert standard.file.values.bolt_stiffness < none.file.values.bolt_stiffness


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
    assert plate.bolt_positions_from_middle.tolist() == [
        [-0.08, -0.03],
        [0.08, -0.03],
        [-0.08, 0.03],
        [0.08, 0.03],
    ]
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
    assert text.splitlines()[1].startswith("# Computed in addition to the parameters")
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


def test_rz_gives_ra_with_its_scatter(capsys, tmp_path):
    """Rz 10 on a drawing is Ra 1.6: the same height, with the range of Rz/Ra from 4 to 10."""
    path = tmp_path / "plate.toml"
    known = facts_of(capsys, *PLATE, *STEEL, "--Ra", "1.6", *LOAD)
    found = made(capsys, *PLATE, *STEEL, "--Rz", "10", *LOAD, path=path)["facts"]
    file = load_parameter_file(path)
    assert file.values.h == pytest.approx(known["h"])
    assert file.ranges["h"] == pytest.approx((known["h"] * 0.625, known["h"] * 6.25 / 4.0))
    assert dict(file.roughness) == pytest.approx({"Ra1": 1.6e-6, "Ra2": 1.6e-6})
    assert "Ra = Rz/6.25, from Rz/10 to Rz/4" in file.sources["roughness.Ra1"]
    # stiffness with the range, embedding by the Rz that is stated: 9.5 um of both
    ratio = found["interface_K_zz_high"]["value"] / found["interface_K_zz_low"]["value"]
    assert ratio == pytest.approx(2.5)
    assert found["embedding"]["value"] == pytest.approx(known["embedding"])
    depth = known["embedding"] * (1.0 / known["bolt_stiffness"] + 1.0 / known["member_stiffness"])
    assert depth == pytest.approx(9.5e-6)
    uncertain = {each.name for each in define_joint_study(file, {}, 30e3, 3).uncertain_parameters}
    assert uncertain == {"mu", "h", "gamma"}


def test_stated_ranges_are_in_the_file(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    words = [*PLATE, *STEEL, "--Ra", "0.6..1.0um", "--mu", "0.1..0.3", "--hardness", "150..170HB"]
    made(capsys, *words, "--preload", "28..32kN", path=path)
    file = load_parameter_file(path)
    assert file.start_value("preload") == pytest.approx(30e3)
    assert file.ranges["inputs.preload"] == pytest.approx((28e3, 32e3))
    assert (file.values.mu, *file.ranges["mu"]) == pytest.approx((0.2, 0.1, 0.3))
    assert file.ranges["H"] == pytest.approx((150 * 9.80665e6, 170 * 9.80665e6))
    scale = RQ_OVER_RA * math.sqrt(2.0) * 1e-6
    assert (file.values.h, *file.ranges["h"]) == pytest.approx((0.8 * scale, 0.6 * scale, 1.0 * scale))
    assert file.origins["mu"] == "user"


# Refusals and warnings


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--plate", "200"], "--plate = '200' has 1 numbers, expected 2, as in 200x100"),
        (["--plate", "200xabc"], "--plate = 'abc' is not a number; expected a number in mm"),
        (["--plate", "200Nx100"], "--plate = '200N': unit 'N' measures another quantity than 'm'"),
        (["--plate", "-200x100"], "--plate = '-200' is outside (0, inf)"),
        (["--bolts", "four"], "--bolts = 'four' are no bolts; expected a number and a thread, as in 4xM12"),
        (["--bolts", "4xM13"], "thread M13 is unknown, allowed are M3, M4"),
        (["--bolts", "0xM12"], "--bolts = '0xM12' are no bolts"),
        (["--bolts", "5xM12"], "5 bolts fit --at LxW in several ways; state --grid"),
        (["--bolts", "M12"], "--at LxW for one bolt: expected the number of --bolts, as in 4xM12"),
        (["--mu", "15"], "--mu = '15' is outside (0, 2]: coefficient of friction of metals"),
        (["--at", "220x60"], "bolt 1 at (-110, -30) mm is not inside the plate"),
        (["--at", "190x60"], "is not inside the plate; allowed are |x| < 93.25 mm"),
        (["--at", "10x60"], "the holes of bolts 1 and 2 overlap"),
        (["--at", "0,0", "10,10"], "--at has 2 positions, expected 4: one for each of --bolts"),
        (["--at", "160x60", "80x30"], "expected one LxW, or the position X,Y of each bolt"),
        (["--grid", "3x2"], "--grid = 3x2 has 6 bolts, but --bolts states 4"),
        (["--grid", "2"], "--grid = '2' is not a grid"),
        (["--circle", "80"], "--at with --circle: expected one of them"),
        (["--grip", "0"], "--grip = '0' is outside (0, inf)"),
        (["--grip", "1", "2", "3"], "--grip has 3 values, expected both plates together, or each"),
        (["--tapped", "--grip", "10", "30"], "--grip has 2 values, expected that of side 1"),
        (["--hole", "11"], "--hole = 11 mm is outside (12, 36] mm for M12"),
        (
            ["--hole", "13500"],
            "--hole = '13500' is read as 13500 mm, plausible are 2 to 150 mm; if it is in um",
        ),
        (["--bearing", "120"], "--bearing = 120 mm is outside (13.5, 96] mm for M12"),
        (["--plate", "0.2x0.15", "--at", "0.16x0.11"], "if it is in m, write 0.2m (200 mm)"),
        (["--at", "160,5x60"], "has x and comma; write LxW with decimal points"),
        (["--bearing", "13"], "--bearing = 13 mm is outside (13.5, 96] mm for M12"),
        (["--washers", "16x2.5"], "--washers: outer diameter = 16 mm is outside (16.63, 96] mm for M12"),
        (["--washers", "24x13"], "--washers: thickness = 13 mm is outside (0, 12] mm for M12"),
        (
            ["--washers", "62x4"],
            "outer diameter = 62 mm is outside (0, 60] mm: washers of neighbouring bolts",
        ),
        (["--washers", "24"], "--washers = '24' has 1 numbers, expected 2"),
        (["--washers", "0.03x0.004"], "if it is in m, write 0.03m (30 mm)"),
        (["--washers", "--hole", "20"], "--hole = 20 mm is outside (12, 19."),
        (["--preload", "-1"], "--preload = '-1' is outside (0, inf)"),
        (["--torque", "84", "--preload", "43e3"], "--torque with --preload: state one of them"),
        (["--head-friction", "0.1"], "--head-friction has no effect without --torque"),
        (["--torque", "84kN"], "--torque = '84kN': unit 'kN' measures another quantity than 'N.m'"),
        (["--bolts", "4xM12x1"], "allowed pitches of M12 are 1.75, 1.5, 1.25 mm"),
        (["--preload", "nan"], "--preload = 'nan' is not a number"),
        (["--preload", "2kN"], "embedding takes 2643 N, the whole preload of 2000 N"),
        (["--torque", "45Ncm"], "N by --torque = '45Ncm', which is 0.45 N.m: state a larger --torque"),
        (["--material", "castiron"], "did you mean cast iron?"),
        (["--embedding", "-1"], "--embedding = '-1' is outside [0, inf) N: preload loss of a bolt"),
        (["--material", "unobtainium"], "material 'unobtainium' is unknown, allowed are steel,"),
        (["--material", "steel", "steel", "steel"], "--material has 3 values"),
        (["--Rq", "1"], "--Ra and --Rq are given together; state the roughness once"),
        (["--finish", "licked"], "finish 'licked' is unknown, allowed are turned,"),
        (["--tapped", "--field", "computed"], "--tapped needs the thickness of both plates"),
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
    assert (
        "the roughness is missing; expected --finish, --Ra, --Rq, --Rz, --surface or --interface-table"
        in line
    )
    both = ["--surface", "scan.csv", "--finish", "ground"]
    line = refused_line(capsys, "new", "bolted-joint", *PLATE, *STEEL, *both)
    assert "--surface and --finish are both given; state one of them" in line


def test_places_must_be_stated(capsys):
    words = ["--plate", "200x100", "--bolts", "4xM12", "--grip", "40", *FACES]
    assert "the positions of 4 bolts are missing" in refused_line(capsys, "new", "bolted-joint", *words)


def test_a_friction_of_no_machined_face_is_warned_of(capsys):
    (line,) = made(capsys, *PLATE, *FACES, *LOAD, "--mu", "1.5")["warnings"]
    assert line.startswith("mu = 1.5 is above 0.8")
    assert made(capsys, *PLATE, *FACES, *LOAD, "--mu", "0.1..0.8")["warnings"] == []


def test_underscores_in_names_of_materials(capsys):
    found = [
        made(capsys, *PLATE, "--material", name, "--Ra", "0.8", *LOAD)["parameters"]
        for name in ("cast_iron", "Grauguss", "cast iron")
    ]
    assert found[0] == found[1] == found[2]


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
    (line,) = made(capsys, *PLATE, *FACES, "--hardness", "10MPa", *LOAD)["warnings"]
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
    spring = BoltedJointSpring.from_joint(load_parameter_file(path).values)
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
def test_a_computed_field_is_near_the_cones(capsys, tmp_path, enter):
    """The field by finite elements of three times the size, whose error is far below the tolerance, is near
    the field of the cones."""
    enter(coarse.elements(BoltedContact, 0.35))
    files = {}
    for field in ("cones", "computed"):
        path = tmp_path / f"{field}.toml"
        words = ["--plate", "60x60", "--bolts", "M16", "--grip", "30", *FACES, "--preload", "60e3"]
        made(capsys, *words, "--field", field, path=path)
        files[field] = BoltedJointSpring.from_joint(load_parameter_file(path).values).evaluate(
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
def test_a_computed_field_of_a_tapped_joint_is_near_the_cone(capsys, tmp_path, enter):
    """In a joint without symmetry, the field is as wide as the cone of VDI 2230 for a tapped thread; under
    moments and higher preload, the hole edges reach the hardness of aluminium. The elements are coarser than
    usual."""
    enter(coarse.elements(BoltedContact, 0.7))
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
    """The range is in the file, in the file read back, in the printed slip force and loss factor, and in a
    study."""
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
    np.testing.assert_allclose(
        compute_friction_results(file, 30e3)[1], compute_friction_results(bare, left)[1], rtol=1e-9
    )
    (mu,) = (each for each in list_parameter_file_entries(file) if each.entry_name == "mu")
    assert mu.value_source.startswith(f"{low:g} to {high:g}; ")
    study = define_joint_study(file, {}, 30e3, 3)
    for each in (study, define_joint_study(file, {"mu": "interval"}, 30e3, 3)):
        intervals = {known.name: known.support_interval for known in each.uncertain_parameters}
        assert intervals == {"mu": (low, high), "gamma": file.ranges["gamma"]}
    assert "mu" not in {
        each.name
        for each in define_joint_study(file, {"mu": 0.2, "h": "+-10%"}, 30e3, 3).uncertain_parameters
    }
    assert "mu" not in file.with_values({"mu": 0.2}, "user", "set").ranges


def test_friction_that_is_stated_has_no_range(capsys, tmp_path):
    path = tmp_path / "plate.toml"
    facts = made(capsys, *PLATE, *FACES, *LOAD, "--mu", "0.2", path=path)["facts"]
    assert "mu" not in load_parameter_file(path).ranges
    assert {name for name in facts if name.startswith("slip_force")} == {"slip_force"}


@pytest.mark.parametrize("text", ["[0.2, 0.3]", "[0.1]", "[0.3, 0.1]", "[-0.1, 0.3]", "0.3", '["a", 1]'])
def test_a_range_that_does_not_hold_the_value_is_refused(capsys, tmp_path, text):
    path = tmp_path / "plate.toml"
    made(capsys, *PLATE, *FACES, *LOAD, path=path)
    path.write_text(path.read_text().replace("range = [0.1, 0.3]", f"range = {text}"))
    with pytest.raises(ValueError, match=r"mu.*range =|range of mu") as refusal:
        load_parameter_file(path)
    assert "\n" not in str(refusal.value)
