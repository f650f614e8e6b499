"""Plates with bolts at any position: layouts, equilibrium, contradictions; complete joint of
`jointfmu new`."""

import json
import warnings
from dataclasses import replace

import coarse
import numpy as np
import pytest
from clients import needs
from conftest import refused_line, warnings_but_shape
from jointfmu_fmu_src.native.page import make_documentation
from jointfmu_tools import cli
from jointfmu_tools.cli.commands.assembly import replace_assembly_parameters
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate
from jointfmu_tools.inputs.drawing import vdi2230
from jointfmu_tools.joints.bolted_joint.field import PlaneLayout
from surroundings import missing_package

from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.compliances import STIFFNESS_UNITS, Compliances
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, contact_points
from jointfmu.joints.bolted_joint.law import (
    ClampedSide,
    RoughBoltedJointParameters,
    find_contradictions,
    preload_pressure,
)
from jointfmu.mechanics.footprint.plate import BoltedPlate, equivalent_bolt_rows, plate_cells, pressure_decay
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

STILL = (0.0, 0.0, 0.0)
SUM = 1e-12
"""Round-off of sums over a thousand nodes; Newton's method for the balance of a bolt ends at 1e-13."""
CIRCLE = 2.0 * np.pi * np.arange(6) / 6
LAYOUTS = {
    "one bolt": ([0.0], [0.0]),
    "one bolt off the middle": ([0.05], [-0.02]),
    "one row": ([-0.06, 0.0, 0.06], [0.01, 0.01, 0.01]),
    "a column": ([0.0, 0.0, 0.0], [-0.03, 0.0, 0.03]),
    "two by two": ([-0.08, 0.08, -0.08, 0.08], [-0.03, -0.03, 0.03, 0.03]),
    "four rows": ([0.0] * 4, [-0.036, -0.012, 0.012, 0.036]),
    "a triangle at the edges": ([-0.09, 0.0, 0.09], [-0.04, 0.04, -0.01]),
    "a circle": (0.04 * np.cos(CIRCLE), 0.04 * np.sin(CIRCLE)),
}


def plate(x, y, **changes):
    sizes = {"length": 0.2, "width": 0.1, "hole_diameter": 0.0135, "cone_diameter": 0.036}
    places = {"x": tuple(map(float, x)), "y": tuple(map(float, y))}
    return BoltedPlate(**sizes | places | changes)


def joint(pattern, **changes):
    row_bolts, row_distance = pattern.equivalent_bolt_rows
    steel = ClampedSide(E=210e9, nu=0.3)
    values = {
        "h": 1e-6, "gamma": 0.45, "longest_wave": 0.8e-3, "hurst": 0.8, "slope": 0.1, "side1": steel,
        "side2": steel, "H": 2e9, "mu": 0.15, "traction_ratio": 0.1, "A_0": pattern.area, "mass": 10.0,
        "n_bolts": float(len(pattern.x)), "row_bolts": row_bolts, "row_distance": row_distance,
        "pattern": pattern,
    }  # fmt: skip
    return RoughBoltedJointParameters(**values | changes)


@pytest.mark.parametrize("name", LAYOUTS)
def test_every_layout_balances_its_bolts(name):
    pattern = plate(*LAYOUTS[name])
    shape, areas = pattern.pressure_distribution(), plate_cells(pattern)[0]
    assert areas.sum() == pytest.approx(pattern.area, rel=5e-4)  # the edge of a hole in eighths of a cell
    assert shape.area_share.sum() == pytest.approx(1.0, rel=SUM)
    assert shape.area_share @ shape.position == pytest.approx([0.0, 0.0], abs=SUM)
    assert shape.area_share @ shape.preload_pressure_ratio == pytest.approx(1.0, rel=SUM)
    # the centre of pressure is that of the bolts, from the centroid of plate without holes
    _, places = plate_cells(pattern)
    centroid = areas @ places / areas.sum()
    centre = shape.area_share @ (shape.preload_pressure_ratio[:, None] * shape.position)
    assert centre == pytest.approx(pattern.bolt_positions_from_middle.mean(axis=0) - centroid, abs=1e-12)
    # a moment about x changes no force and is balanced by the pressure
    assert shape.area_share @ shape.moment_pressure_ratio == pytest.approx(0.0, abs=1e-11)
    assert shape.area_share @ (shape.moment_pressure_ratio * shape.position[:, 1]) == pytest.approx(
        pattern.equivalent_bolt_rows[1], rel=1e-11
    )
    assert np.all(shape.preload_pressure_ratio >= 0.0)


@pytest.mark.parametrize("name", LAYOUTS)
def test_pressures_carry_preload_and_moment(name):
    pattern = plate(*LAYOUTS[name])
    one = joint(pattern)
    moment = 0.2 * 1e4 * one.row_distance * one.row_bolts
    shape = pattern.pressure_distribution()
    p = preload_pressure(one, shape, 1e4, moment)
    force = one.A_0 * shape.area_share * p
    assert force.sum() == pytest.approx(1e4 * len(pattern.x), rel=1e-9)
    even = one.A_0 * shape.area_share * preload_pressure(one, shape, 1e4, 0.0)
    assert (force - even) @ shape.position[:, 1] == pytest.approx(moment, rel=1e-9)


def test_one_pressure_falls_as_the_polynomial_and_has_the_moment_of_its_cone():
    pattern = plate([0.0], [0.0])
    a, R = 0.5 * pattern.hole_diameter, pattern.pressure_radius
    r = np.linspace(a, R, 20001)
    p = pressure_decay(pattern, r)
    assert p[0] == 1.0
    assert pressure_decay(pattern, np.array([0.5 * a, 2.0 * R])).tolist() == [1.0, 0.0]
    slope = np.gradient(p, r)
    assert abs(slope[0]) < 1e-3 * abs(slope).max()
    assert abs(slope[-1]) < 1e-6 * abs(slope).max()
    square = np.trapezoid(p * r**3, r) / np.trapezoid(p * r, r)
    assert square == pytest.approx(0.5 * (a**2 + (0.5 * pattern.cone_diameter) ** 2), rel=1e-6)
    shape = pattern.pressure_distribution()  # and the cells have it too
    found = shape.area_share @ (shape.preload_pressure_ratio * np.sum(shape.position**2, axis=1))
    assert found == pytest.approx(square, rel=0.01)


def test_two_rows_have_their_own_distance_and_more_rows_help():
    assert equivalent_bolt_rows(np.array([-0.03, -0.03, 0.03, 0.03])) == pytest.approx((2.0, 0.06))
    assert equivalent_bolt_rows(np.array([-0.03, 0.0, 0.03])) == pytest.approx((1.0, 0.06))
    # M y_i/sum(y^2) at the outer bolts is M/(N_b L_a)
    y = np.array([-0.036, -0.012, 0.012, 0.036])
    count, distance = equivalent_bolt_rows(y)
    assert 1.0 / (count * distance) == pytest.approx(0.036 / (y @ y))


def test_as_many_places_along_as_across():
    with pytest.raises(ValueError, match="y has 1 numbers, expected as many as x: 2"):
        plate([0.0, 0.05], [0.0])


def test_the_moment_of_two_rows_is_that_of_a_frame():
    """The bolt forces of a plate with two rows are those of Zhao 2018, section 3."""
    pattern = plate(*LAYOUTS["two by two"])
    shape = pattern.pressure_distribution()
    upper = shape.position[:, 1] > 0.0
    one = joint(pattern)
    p = preload_pressure(one, shape, 2e4, 600.0)
    force = one.A_0 * shape.area_share * p
    shift = 600.0 / (0.06 * 2)
    # a bolt's disc does not reach across the middle here
    assert force[upper].sum() == pytest.approx(2 * (2e4 + shift), rel=1e-9)
    assert force[~upper].sum() == pytest.approx(2 * (2e4 - shift), rel=1e-9)


def test_the_contact_of_one_row_opens_where_the_rows_say():
    pattern = plate(*LAYOUTS["one row"])
    one, shape = joint(pattern), pattern.pressure_distribution()
    opening = 1e4 * one.row_distance * one.row_bolts
    pressed = shape.preload_pressure_ratio > 0.0
    held, open_ = (
        np.array([preload_pressure(one, shape, 1e4, sign * part * opening)[pressed] for sign in (1.0, -1.0)])
        for part in (0.999, 1.001)
    )
    assert np.all(held > 0.0)
    assert np.any(open_ == 0.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"x": (0.0, 0.0), "y": (0.0, 0.013)}, ("overlap", "(0, 0.013)")),
        ({"x": (0.096,)}, ("bolt 1 at (0.096, 0) m", "is not inside the plate", "|x| < 0.09325 m")),
        ({"x": (0.0, 0.01), "y": (0.0, 0.0)}, ("bolts 1 and 2 overlap", "0.0135 m is outside (0, 0.01)")),
        ({"hole_diameter": 0.12, "cone_diameter": 0.2}, ("is not inside the plate",)),
        ({"cone_diameter": 0.0135}, ("cone_diameter = 0.0135 m is outside (0.0135, inf)",)),
        ({"length": -0.2}, ("length = -0.2 m",)),
    ],
)
def test_a_plate_that_cannot_be_is_refused(changes, words):
    with pytest.raises(ValueError, match=" m ") as error:
        plate(**{"x": [0.0], "y": [0.0]} | changes)
    assert all(word in str(error.value) for word in words), error.value


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"n_bolts": 5.0}, "n_bolts = 5 contradicts [plate], which has 4 bolts"),
        (
            {"A_0": 0.0185},
            "contradicts [plate], whose area without the holes is 0.0194274 m2",
        ),
        ({"row_bolts": 1.0}, "row_bolts = 1 contradicts [plate], whose rows have 2"),
        ({"row_distance": 0.05}, "row_distance = 0.05 m contradicts [plate], where it is 0.06 m"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(tmp_path, changes, text):
    one = joint(plate(*LAYOUTS["two by two"]))
    assert list(find_contradictions(one)) == []
    path = tmp_path / "joint.toml"
    file = replace(load_default("bolted_joint"), values=replace(one, **changes), roughness={})
    path.write_text(format_parameter_file(file))
    with pytest.raises(ValueError, match=r"joint\.toml") as error:
        load_parameter_file(path)
    assert text in str(error.value)
    path.write_text(format_parameter_file(replace(file, values=one)))
    assert load_parameter_file(path).values == one


def test_a_frame_of_eight_bolts_with_four_is_refused(tmp_path):
    path = tmp_path / "four.toml"
    text = format_parameter_file(load_default("bolted_joint"))
    path.write_text(
        text.replace("n_bolts = { value = 8.0", "n_bolts = { value = 4.0").replace(
            "row_bolts = { value = 3.0", "row_bolts = { value = 2.0"
        )
    )
    with pytest.raises(ValueError, match=r"n_bolts = 4 contradicts \[pattern\], which has 8 bolts"):
        load_parameter_file(path)
    path.write_text(text.replace("A_0 = { value = 0.0382", "A_0 = { value = 0.0482"))
    with pytest.raises(ValueError, match=r"A_0 = 0.0482 m2 contradicts \[pattern\], .* is 0.03807\d+ m2"):
        load_parameter_file(path)


def test_one_row_says_what_to_do():
    one = joint(plate(*LAYOUTS["one row"]))
    with pytest.raises(ValueError, match=r"row_bolts = 3 is outside \[1, 1.5\]: .* set row_bolts = 1 if"):
        replace(one, row_bolts=3.0)
    single = joint(plate([0.0], [0.0]))
    assert single.row_bolts == 1.0  # where half of a bolt would be the limit


# The bolts' own stiffness


def normal(pattern, **changes):
    """Joint with friction on the points of the normal force, as for rigid sides."""
    return BoltedJointSpring.from_interface_nodes(joint(pattern, **changes), contact_points(pattern))


def test_without_bolt_stiffness_nothing_changes():
    old = load_default("bolted_joint").values
    assert old.bolt_stiffness == 0.0
    state = (9e3, 800.0, (1e-6, -2e-6, 5e-7), (1e-3, 2e-3, -1e-3))
    plain = BoltedJointSpring.from_joint(old).evaluate(*state)
    again = BoltedJointSpring.from_joint(replace(old, bolt_stiffness=1e8)).evaluate(*state)
    same = {"f_x", "f_y", "K_xx", "K_yy", "C_xx", "C_zz", "K_rz", "p_mean", "p_max", "eta_t", "eta_n"}
    assert {name: plain[name] for name in same} == {name: again[name] for name in same}
    assert again["f_z"] - plain["f_z"] == pytest.approx(-8e8 * 5e-7, rel=1e-9)
    assert again["K_zz"] - plain["K_zz"] == pytest.approx(8e8, rel=1e-9)
    # six bolts at y = +-0.15 m, six at x = +-0.1 m
    assert again["K_rx"] - plain["K_rx"] == pytest.approx(6 * 1e8 * 0.15**2, rel=1e-6)
    assert again["K_ry"] - plain["K_ry"] == pytest.approx(6 * 1e8 * 0.1**2, rel=1e-6)


def test_bolts_carry_the_open_joint_and_the_stiffness_is_the_derivative():
    pattern = plate(*LAYOUTS["two by two"])
    spring = normal(pattern, bolt_stiffness=3e8)
    far = spring.evaluate(3e4, 0.0, (0.0, 0.0, 1e-4), STILL)
    assert far["f_z"] == pytest.approx(-4 * (3e4 + 3e8 * 1e-4), rel=1e-12)
    assert far["K_zz"] == pytest.approx(4 * 3e8, rel=1e-12)
    assert far["K_rx"] == pytest.approx(4 * 3e8 * 0.03**2, rel=1e-6)
    assert far["K_ry"] == pytest.approx(4 * 3e8 * 0.08**2, rel=1e-6)
    assert far["K_xx"] == far["K_rz"] == 0.0
    h, state = 1e-10, (3e4, 400.0)
    for z in (-2e-7, 0.0, 6e-7):
        up, down = (spring.evaluate(*state, (0.0, 0.0, z + d), STILL)["f_z"] for d in (h, -h))
        K = spring.evaluate(*state, (0.0, 0.0, z), STILL)["K_zz"]
        assert (down - up) / (2.0 * h) == pytest.approx(K, rel=1e-5)


M12 = 3.416e8
"""Stiffness [N/m] of a bolt M12 with a grip of 40 mm, VDI 2230."""


@pytest.mark.parametrize(("s_z", "by_hand"), [(1e-4, 1967.0), (3e-4, 4062.0)])
def test_bolts_off_the_centre_turn_the_open_joint(s_z, by_hand):
    pattern = plate([-0.08, 0.08, 0.0], [-0.03, -0.03, 0.03])
    spring = normal(pattern, bolt_stiffness=M12)
    open_ = spring.evaluate(3e4, 0.0, (0.0, 0.0, s_z), STILL)
    assert open_["m_x"] == pytest.approx(by_hand, rel=1e-3)  # printed to four digits
    assert open_["m_y"] == pytest.approx(0.0, abs=1e-6)


def test_bolts_on_a_diagonal_couple_both_tilts():
    spring = normal(plate([-0.08, 0.08], [-0.03, 0.03]), bolt_stiffness=M12)
    about_x = spring.evaluate(3e4, 0.0, (0.0, 0.0, 1e-4), STILL, (1e-4, 0.0, 0.0))
    assert about_x["m_y"] == pytest.approx(2 * M12 * 0.08 * 0.03 * 1e-4, rel=1e-9)  # 164 N.m
    about_y = spring.evaluate(3e4, 0.0, (0.0, 0.0, 1e-4), STILL, (0.0, 1e-4, 0.0))
    assert about_y["m_x"] == pytest.approx(2 * M12 * 0.08 * 0.03 * 1e-4, rel=1e-9)


@pytest.mark.parametrize("name", LAYOUTS)
def test_each_bolt_pulls_at_its_place(name):
    pattern = plate(*LAYOUTS[name])
    free, held = (normal(pattern, bolt_stiffness=k) for k in (0.0, M12))
    s_z, turn = 1e-4, (2e-4, -3e-4, 1e-4)
    without, with_ = (one.evaluate(3e4, 0.0, (0.0, 0.0, s_z), STILL, turn) for one in (free, held))
    areas, places = plate_cells(pattern)
    x, y = (pattern.bolt_positions_from_middle - areas @ places / areas.sum()).T
    tension = M12 * (s_z + turn[0] * y - turn[1] * x)
    cut = 1e-3 * M12 * s_z  # the centroid of cells is that of the plate within their cut at a hole's edge
    assert with_["f_z"] - without["f_z"] == pytest.approx(-tension.sum(), rel=1e-3, abs=cut)
    assert with_["m_x"] - without["m_x"] == pytest.approx(-(tension @ y), rel=1e-3, abs=0.1 * cut)
    assert with_["m_y"] - without["m_y"] == pytest.approx(tension @ x, rel=1e-3, abs=0.1 * cut)


# Assemblies whose bolts are no two rows


PLATE = Plate(length=0.2, width=0.1, thickness=0.02, E=210e9, nu=0.3, density=7850.0)


@pytest.mark.parametrize("x", [(0.0,), (-0.05, 0.0, 0.05)])
def test_the_default_joint_takes_one_row(x):
    bolts = BoltList(x=x, y=(0.0,) * len(x), hole_diameter=0.0135, head_diameter=0.018)
    joint = replace_assembly_parameters(
        load_default("bolted_joint"), Assembly("row", PLATE, PLATE, bolts), include_bolts=True
    ).values
    assert (joint.n_bolts, joint.row_bolts, joint.row_distance) == (len(x), 1.0, 0.018)


# The complete joint: interface, members and bolts side by side


M16 = ["--plate", "80x80", "--bolts", "M16", "--grip", "40", "--material", "steel", "--Ra", "0.8"]
LOAD = ["--preload", "60e3", "--embedding", "0"]
"""Options of the load; with it and with four bolts, the plates are those of test_elastic_sides.py."""


def test_the_bolt_that_gets_most_decides_when_the_interface_opens():
    """One of three bolts carries as much of a tensile load as the others together, and so does the interface
    around it. Bolts in one line through the centroid have no stiffness about this line, except round-off."""
    each = np.ones(6)
    share = np.outer([0.02, 0.02, 0.04], each)
    found = Compliances(np.stack([each, each, each]), each, np.array([0, 0, 1, 1e-28, 1, 0]), share)
    assert found.opening_load(1e3) == pytest.approx(1e3 / (0.5 * (1.0 - 0.08)))
    even = found._replace(bolt_force=np.full((3, 6), 0.02))
    assert even.opening_load(1e3) == pytest.approx(3e3 / (1.0 - 0.06))
    assert even._replace(bolt_force=np.zeros((3, 6))).opening_load(1e3) == pytest.approx(3e3)
    assert [row[2][3] for row in found.compliance_table_rows()] == [0.0, 0.0, 1.0, 0.0, 1.0, 0.0]


def made(capsys, *words):
    assert cli.main(["new", "bolted-joint", *words, "--json"]) == 0
    found = warnings_but_shape(json.loads(capsys.readouterr().out))
    return {name: fact["value"] for name, fact in found["facts"].items()}, found


@needs("gmsh")
@pytest.mark.slow
def test_a_bolt_loaded_at_its_heads_is_that_of_vdi_2230(capsys, fine_elements):
    """The cone of VDI 2230 is within 15 to 20 % of finite elements, in which the area under a head moves as
    one face; the opening load by VDI 2230 is the preload over 1 - Phi."""
    facts, _ = made(capsys, *M16, *LOAD, "--attached", "heads")
    members = facts["joint_K_zz"] - facts["bolt_stiffness"]
    assert members == pytest.approx(facts["member_stiffness"], rel=0.2)
    assert facts["joint_load_factor"] == pytest.approx(facts["load_factor"], rel=0.15)
    assert facts["opening_load"] == pytest.approx(60e3 / (1.0 - facts["joint_load_factor"]))
    assert facts["interface_share"] < 0.05


@needs("gmsh")
@pytest.mark.slow
def test_washers_widen_the_bearing_face_of_the_finite_elements(capsys):
    """Members with larger bearing faces are stiffer; a longer bolt in series with washers is less stiff."""
    bare, _ = made(capsys, *M16, *LOAD, "--attached", "heads")
    washers, found = made(capsys, *M16, *LOAD, "--attached", "heads", "--washers")
    slope = vdi2230.cone_slope(0.046, 22.49e-3, 0.08, is_tapped=False)
    assert found["parameters"]["bodies.head_diameter"] == pytest.approx(22.49e-3 + 2.0 * 3e-3 * slope)
    assert washers["bolt_stiffness"] < bare["bolt_stiffness"]
    assert washers["members_K_zz"] > 1.05 * bare["members_K_zz"]
    assert washers["joint_load_factor"] < 0.9 * bare["joint_load_factor"]
    # the load of the finite elements enters below the washers, that of VDI 2230 above them
    below = washers["joint_load_factor"]
    washer_share = washers["bolt_stiffness"] / washers["washer_stiffness"]
    assert below + (1.0 - below) * washer_share == pytest.approx(washers["load_factor"], rel=0.15)


@needs("gmsh")
@pytest.mark.slow
def test_the_load_at_the_faces_passes_the_bolts_by(capsys, fine_elements):
    """A load at the faces loads the bolts less than half as much as one at the heads, as it is nearer to the
    interface (load introduction factor n of VDI 2230)."""
    heads, _ = made(capsys, *M16, *LOAD, "--attached", "heads")
    faces, found = made(capsys, *M16, *LOAD)
    assert faces["joint_load_factor"] < 0.5 * heads["joint_load_factor"]
    assert heads["joint_K_zz"] < faces["joint_K_zz"] < faces["interface_K_zz"]
    assert (
        "between the outer faces, other motions fixed: output K_zz of the FMU at preload = 60000 N; "
        "compliance by stored energy: " in found["facts"]["joint_K_zz"]["text"]
    )
    assert "the FMU is the complete joint" in found["facts"]["interface_share"]["text"]


@needs("gmsh")
@pytest.mark.slow
def test_four_bolts_share_a_load_evenly(capsys):
    """By coarse finite elements, four bolts have equal shares of a load."""
    words = ["--plate", "80x80", "--bolts", "4xM8", "--at", "50x50", "--grip", "20", *M16[6:]]
    facts, _ = made(capsys, *words, "--preload", "15e3", "--embedding", "0")
    assert facts["joint_load_factor"] == pytest.approx(4.0 * facts["bolt_load_share"], rel=1e-2)
    assert facts["joint_K_xx"] == pytest.approx(facts["joint_K_yy"], rel=0.02)  # gmsh's mesh is not symmetric


@needs("gmsh")
@pytest.mark.slow
def test_the_whole_of_a_computed_field_is_as_stiff_as_all_its_nodes(capsys, tmp_path, enter):
    """The file has few points with the same sums. The finite elements compute the complete joint with them;
    printed values are the same. The picture shows outline and holes of the plate."""
    enter(coarse.elements(BoltedContact, 0.5))  # as the bodies' here
    path = tmp_path / "plate.toml"
    words = ["--plate", "60x30", "--bolts", "2xM8", "--at", "40x0", "--grip", "20", *M16[6:]]
    seen = enter(coarse.computed_joints())
    facts, _ = made(capsys, *words, "--preload", "15e3", "--field", "computed", "--out", str(path))
    values = load_parameter_file(path).values
    found = BoltedJointSpring.from_joint(values).compliances(15e3)
    np.testing.assert_allclose(found.total_compliance, seen[0].joint_compliances.total_compliance, rtol=2e-3)
    for name, compliance in zip(STIFFNESS_UNITS, found.total_compliance, strict=True):
        whole = facts[f"joint_K_{name if name.startswith('r') else 2 * name}"]
        assert 1.0 / compliance == pytest.approx(whole, rel=1e-9), name
    drawn = PlaneLayout.from_joint_parameters(values)
    np.testing.assert_allclose(drawn.bounding_box, [[-0.03, -0.015], [0.03, 0.015]], atol=1e-6)
    assert (len(drawn.contact_outline), drawn.hole_diameter) == (1, pytest.approx(0.009))


@pytest.mark.parametrize("package", ["gmsh", "threadpoolctl"])
def test_without_finite_elements_the_complete_joint_is_refused(capsys, enter, tmp_path, package):
    """The file would describe another joint than requested, so it is written only if `--sides
    rigid` is set."""
    enter(missing_package(package))
    path = tmp_path / "joint.toml"
    other_plate = ["--plate", "80x81"]  # not solved before by this process
    line = refused_line(capsys, "new", "bolted-joint", *M16, *other_plate, *LOAD, "--out", path)
    assert "the complete joint needs the finite elements (extra fem), which are not installed" in line
    assert "pip install 'jointfmu[fem]'; or state --sides rigid for rigid plates" in line
    assert "No module named" not in line
    assert not path.exists()
    facts, found = made(capsys, *M16, *LOAD, "--sides", "rigid", "--out", str(path))
    assert "joint_K_zz" not in facts
    assert found["warnings"] == []
    assert load_parameter_file(path).values.sides == "rigid"
    interface = 1.0 / facts["interface_K_zz"]
    assert facts["interface_share"] == pytest.approx(
        interface / (interface + 1.0 / facts["member_stiffness"])
    )
    assert "the members of the FMU are rigid" in found["facts"]["interface_share"]["text"]


def test_heads_that_do_not_fit_are_said(capsys):
    line = refused_line(capsys, "new", "bolted-joint", *M16, *LOAD, "--bearing", "90")
    assert "bolt 1 at (0, 0) mm with a head of 90 mm reaches beyond the plate of side1" in line
    assert line.endswith("; or state --sides rigid for rigid plates\n")


def test_an_unknown_attachment_is_refused(capsys):
    line = refused_line(capsys, "new", "bolted-joint", *M16, "--attached", "bolts")
    assert "--attached" in line
    assert "heads" in line


THIN = ["--plate", "40x25.4", "--bolts", "2xM6", "--at", "20x0", "--grip", "3.175", "3.175"]
THIN += ["--material", "aluminium", "--Ra", "0.8"]


@pytest.mark.parametrize("sides", ["rigid", pytest.param("elastic", marks=[pytest.mark.slow, needs("gmsh")])])
def test_a_joint_of_which_embedding_takes_much_has_a_page_and_a_report(tmp_path, few_points, sides):
    """Embedding loss of 1745 N at a preload of 1800 or 4000 N: loops are drawn at a preload that leaves a
    clamping force."""
    path, preload = tmp_path / "thin.toml", {"rigid": "1800", "elastic": "4000"}[sides]
    words = ["--preload", preload, "--attached", "edge", "--out", str(path)]
    assert cli.main(["new", "bolted-joint", *THIN, "--sides", sides, *words]) == 0
    file = load_parameter_file(path)
    assert file.values.embedding == pytest.approx(1745.0, rel=1e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = MODELS["BoltedJoint"].with_parameters(file.joint, file.values)
        assert b"Loops at preload" in make_documentation(model, file)["index.html"]
        assert cli.main(["report", str(path), "--out", str(tmp_path / "thin.html")]) == 0


def test_embedding_that_takes_all_of_the_preload_is_refused(tmp_path, capsys):
    path = tmp_path / "joint.toml"
    file = load_default("bolted_joint").with_values({"embedding": 12e3}, "user", "test")
    path.write_text(format_parameter_file(replace(file, inputs={**file.inputs, "preload": 9e3})))
    for words in (["build", "BoltedJoint", "--params", path, "--out", tmp_path], ["report", path]):
        line = refused_line(capsys, *words)
        assert (
            "preload = 9000 N is outside (12000, inf) N: embedding reduces it by 12000 N; increase preload"
            in line
        )
    # none is stated: the ramp and the loops begin with a bolt that embedding does not slacken
    page = make_documentation(MODELS["BoltedJoint"], replace(file, inputs={}))["index.html"]
    assert b"Loops at preload = 17.4 kN" in page
    model = MODELS["BoltedJoint"].with_parameters("bolted_joint", file.values)
    assert model.load_cycle.variable_values["preload"] == 24e3
