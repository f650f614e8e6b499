"""Pressure field in a bolted joint: reduction to few points, moment, parameter file, FMU."""

import re
from argparse import Namespace
from dataclasses import replace

import coarse
import numpy as np
import pytest
from conftest import here_alone
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools import cli
from jointfmu_tools.cli.commands.assembly import bodies
from jointfmu_tools.exchange.modelica import library
from jointfmu_tools.inputs.fields import nodal_result, reduction
from jointfmu_tools.inputs.fields.joint_parameters import insert_pressure_field, normalise_pressure_field
from jointfmu_tools.inputs.fields.nodal_result import ContactPressureField
from jointfmu_tools.inputs.fields.reduction import NODE_ROUNDING_BITS, REDUCTION_TOLERANCE, reduce_field
from jointfmu_tools.inputs.fields.sums import (
    MAX_COMPRESSION_OVER_OPENING_MOTION,
    PRELOAD_OVER_FIELD_PRELOAD_RANGE,
    ForceAndStiffnessFunctions,
    LoadCase,
)
from jointfmu_tools.joints.bolted_joint.field import PlaneLayout
from jointfmu_tools.joints.bolted_joint.published import pressure_between_bolts
from jointfmu_tools.run.ramps import ramp
from oracles import contact_patches

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import get_bolted_frame, preload_pressure
from jointfmu.mechanics.footprint.distribution import NodalField
from jointfmu.mechanics.footprint.reproducible import round_distribution
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file
from jointfmu.quantity import flatten_parameters

pytestmark = pytest.mark.slow

FILE = load_default("bolted_joint")
JOINT = FILE.values
PRELOAD = 9e3
OFFSET = np.array([0.2, -0.1])


def field(closed=0.0, moment=0.0):
    """Pressure field at the nodes of the default frame; nodes below `closed` times the mean pressure are
    open."""
    shape = get_bolted_frame(JOINT).pressure_distribution()
    mean = PRELOAD * JOINT.n_bolts / JOINT.A_0
    p = np.maximum(shape.preload_pressure_ratio - closed, 0.0)
    p *= mean / (shape.area_share @ p)
    p += moment / (JOINT.row_distance * JOINT.A_0) * shape.moment_pressure_ratio
    return ContactPressureField(shape.area_share * JOINT.A_0, shape.position + OFFSET, p)


FIELD = field()


@pytest.fixture(scope="module", params=[0.0, 0.3], ids=["closed", "open"])
def reduced(request):
    shape = normalise_pressure_field(JOINT, field(request.param), PRELOAD)
    joint = replace(JOINT, A_0=float(FIELD.nodal_area.sum()))
    return joint, shape, reduce_field(joint, shape, PRELOAD, preload_pressure)


def direct(joint, shape, load):
    """Force, K_zz, K_xx, K_rx, K_ry summed over all nodes, and their values at tightening."""
    elastic = replace(joint, memory=False)
    curve = ForceAndStiffnessFunctions.from_joint(joint, PRELOAD, preload_pressure).pressure_curve
    spring = replace(BoltedJointSpring.from_interface_nodes(elastic, shape), curve=curve)
    force = load.preload_over_field_preload * PRELOAD
    moment = load.moment_over_unloading_moment * force * joint.row_distance * joint.row_bolts
    start = spring.preloaded_approach(force, moment)
    found = []
    for s_z in (load.motion_over_opening_motion, 0.0):
        state = spring.evaluate(force, moment, (0.0, 0.0, s_z), (0.0, 0.0, 0.0))
        state["force"] = state["p_mean"] * joint.A_0
        found.append(np.array([state[n] for n in ("force", "K_zz", "K_xx", "K_rx", "K_ry")]))
        last = state
    return start, found, last["p_max"]


def test_points_keep_the_sums(reduced):
    """At loads outside the load cases of the reduction, sums are within the stated deviation; the peak
    pressure is exact."""
    joint, shape, found = reduced
    assert found.point_count < 0.35 * found.node_count
    assert found.largest_deviation <= REDUCTION_TOLERANCE
    rng = np.random.default_rng(11)
    lowest = ForceAndStiffnessFunctions.from_joint(
        joint, PRELOAD, preload_pressure
    ).pressure_curve.displacement[0]
    for _ in range(15):  # many in studies/fields_explanation.py
        load = LoadCase(
            float(np.exp(rng.uniform(*np.log(PRELOAD_OVER_FIELD_PRELOAD_RANGE)))),
            found.max_tested_over_unloading_moment * rng.uniform(-1, 1),
            0.0,
        )
        start, _, peak = direct(joint, shape, load)
        apart = rng.choice([0.0, rng.uniform(-MAX_COMPRESSION_OVER_OPENING_MOTION, 1.0)]) * (
            start.max() - lowest
        )
        _, full, _ = direct(joint, shape, load._replace(motion_over_opening_motion=apart))
        _, few, same = direct(
            joint, found.reduced_distribution, load._replace(motion_over_opening_motion=apart)
        )
        np.testing.assert_array_less(
            np.abs(few[0] - full[0]), REDUCTION_TOLERANCE * np.maximum(full[0], full[1])
        )
        assert same == pytest.approx(peak, rel=REDUCTION_TOLERANCE)  # scaled to balance


def test_points_balance(reduced):
    _, shape, found = reduced
    points = found.reduced_distribution
    assert np.all(points.area_share > 0.0)
    for one in (shape, points):
        assert one.area_share.sum() == pytest.approx(1.0, rel=1e-12)
        assert one.area_share @ one.preload_pressure_ratio == pytest.approx(1.0, rel=1e-12)
        assert one.area_share @ one.moment_pressure_ratio == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(one.area_share @ one.position, 0.0, atol=1e-14)
        # a moment M shifts M/L_a from row to row: the pressures balance it if this is L_a
        assert one.area_share @ (one.moment_pressure_ratio * one.position[:, 1]) == pytest.approx(
            JOINT.row_distance, rel=1e-6
        )


def test_a_field_that_is_a_bit_off_is_the_same():
    """The reduced field has the same bits for 10 fields with every number changed by a relative 1e-15."""
    rng, shape = np.random.default_rng(8), normalise_pressure_field(JOINT, FIELD, PRELOAD)
    before = round_distribution(shape, NODE_ROUNDING_BITS)
    numbers = ("area_share", "position", "preload_pressure_ratio", "moment_pressure_ratio")
    for _ in range(10):
        area, position, pressure = (
            values * (1.0 + 1e-15 * rng.choice([-1.0, 1.0], values.shape))
            for values in (FIELD.nodal_area, FIELD.node_positions, FIELD.nodal_pressure)
        )
        other = normalise_pressure_field(JOINT, ContactPressureField(area, position, pressure), PRELOAD)
        for name in numbers:
            assert np.array_equal(
                getattr(round_distribution(other, NODE_ROUNDING_BITS), name), getattr(before, name)
            ), name
    one, two = (
        reduce_field(JOINT, each, PRELOAD, preload_pressure).reduced_distribution for each in (shape, other)
    )
    for name in numbers:
        was = getattr(one, name)
        np.testing.assert_allclose(getattr(two, name), was, rtol=1e-9, atol=1e-9 * np.max(np.abs(was)))


def test_patches_come_from_the_nodes(tmp_path):
    """A ring under pure torsion has its moment within 2e-3, and no lateral force within 4e-3 of its friction
    limit. The file keeps the patches; patches that do not balance are refused."""
    ring = contact_patches.annulus(48, 5)
    mean = PRELOAD * JOINT.n_bolts / JOINT.A_0
    contact = ContactPressureField(
        ring.area_share * JOINT.A_0, ring.position, mean * ring.preload_pressure_ratio
    )
    (tmp_path / "ring.toml").write_text(
        format_parameter_file(insert_pressure_field(FILE, contact, PRELOAD, "a ring")[0]), encoding="utf-8"
    )
    joint = load_parameter_file(tmp_path / "ring.toml").values
    spring = BoltedJointSpring.from_joint(joint)
    assert spring.patches.area_share.tolist() == list(joint.pattern.patch_share)
    slides = spring.evaluate(PRELOAD, 0.0, (0.0, 0.0, 0.0), (0.0,) * 3, (0.0, 0.0, 1e-2))
    friction = joint.mu * PRELOAD * joint.n_bolts
    assert np.hypot(slides["f_x"], slides["f_y"]) < 4e-3 * friction
    arm = (ring.area_share * ring.preload_pressure_ratio) @ np.hypot(*ring.position.T)
    assert -slides["m_z"] == pytest.approx(friction * arm, rel=2e-3)
    share = (2.0 * joint.pattern.patch_share[0], *joint.pattern.patch_share[1:])
    with pytest.raises(ValueError, match=r"^the sum of patch_share is 1\.\d+, expected 1 within 1e-06$"):
        replace(joint.pattern, patch_share=share)


def test_few_nodes_stay_as_they_are():
    shape = normalise_pressure_field(
        JOINT, ContactPressureField(*(a[:50] for a in _parts(FIELD))), _preload(FIELD, 50)
    )
    assert reduce_field(JOINT, shape, PRELOAD, preload_pressure).reduced_distribution is shape


def test_points_that_miss_a_little_stand_for_many_nodes_alone(monkeypatch):
    shape = normalise_pressure_field(JOINT, FIELD, PRELOAD)
    parts = reduction.MAX_KEPT_NODES // shape.area_share.size + 1
    large = shape.select_nodes(np.tile(np.arange(shape.area_share.size), parts))
    large = replace(large, area_share=large.area_share / parts)
    found = [
        reduction.FieldReduction(
            shape.select_nodes(slice(99)), shape, 0.5 * reduction.LARGE_FIELD_REDUCTION_TOLERANCE
        ),
        None,
    ]
    monkeypatch.setattr(reduction, "_search_reduced_points", lambda *given: found[0])
    assert reduce_field(JOINT, shape, PRELOAD, preload_pressure).point_count == shape.area_share.size
    assert reduce_field(JOINT, large, PRELOAD, preload_pressure) is found.pop(0)
    with pytest.raises(
        RuntimeError,
        match=r"cannot be reduced: no set of points keeps its sums within 1e-05; .* 3000",
    ):
        reduce_field(JOINT, large, PRELOAD, preload_pressure)


def _parts(one):
    return one.nodal_area, one.node_positions, one.nodal_pressure


def _preload(one, count):
    return float(one.nodal_area[:count] @ one.nodal_pressure[:count]) / JOINT.n_bolts


def test_second_field_gives_the_tilt():
    """Two fields of the pattern give the moment ratio of the pattern, to round-off of its sum."""
    moment = 900.0
    found = normalise_pressure_field(JOINT, FIELD, PRELOAD, field(moment=moment), moment)
    pattern = get_bolted_frame(JOINT).pressure_distribution()
    scale = FIELD.nodal_area.sum() / JOINT.A_0
    np.testing.assert_allclose(
        found.moment_pressure_ratio,
        scale * pattern.moment_pressure_ratio,
        atol=1e-9 * np.abs(pattern.moment_pressure_ratio).max(),
    )
    with pytest.raises(ValueError, match=r"balance -0.877 times its moment of -900 N.m, allowed is 0.5"):
        normalise_pressure_field(JOINT, FIELD, PRELOAD, field(moment=moment), -moment)
    with pytest.raises(ValueError, match=r"the moment \[N.m\] of the second field is missing"):
        normalise_pressure_field(JOINT, FIELD, PRELOAD, field(moment=moment))
    moved = replace(FIELD, node_positions=FIELD.node_positions + 0.01 * OFFSET)
    with pytest.raises(ValueError, match=r"node 1 of the field with a moment is at .* expected"):
        normalise_pressure_field(JOINT, FIELD, PRELOAD, moved, moment)


@pytest.mark.parametrize("factor", [0.989, 1.011])
def test_a_force_more_than_one_per_cent_off_is_refused(factor):
    wrong = replace(FIELD, nodal_pressure=factor * FIELD.nodal_pressure)
    with pytest.raises(
        ValueError, match=r"the force of the field is .* N, expected 72000 N within 1 %: 8 bolts"
    ):
        insert_pressure_field(FILE, wrong, PRELOAD, "test")
    assert normalise_pressure_field(
        JOINT, replace(FIELD, nodal_pressure=1.009 * FIELD.nodal_pressure), PRELOAD
    )


def test_other_joints_have_no_field():
    with pytest.raises(
        ValueError, match=r"joint = 'gear_contact' has no pressure field; expected 'bolted_joint'"
    ):
        insert_pressure_field(load_default("gear_contact"), FIELD, PRELOAD, "test")


@pytest.fixture(scope="module")
def imported():
    return insert_pressure_field(FILE, FIELD, PRELOAD, "a test's field")


def test_file_survives_and_says_where_it_comes_from(imported, tmp_path):
    file, found = imported
    path = tmp_path / "joint.toml"
    path.write_text(format_parameter_file(file))
    again = load_parameter_file(path, "bolted_joint")
    assert again.values == file.values
    assert format_parameter_file(again) == format_parameter_file(file)
    assert isinstance(again.values.pattern, NodalField)
    assert float(FIELD.nodal_area.sum()) == again.values.A_0
    assert "pattern." not in " ".join(flatten_parameters(again.values))
    assert again.origins["field.tilt"] == "derived"
    assert again.sources["field.share"].endswith(f"{found.point_count} points for {found.node_count} nodes")
    assert again.sources["A_0"] == "a test's field, sum of the nodal areas"


@pytest.mark.parametrize(("change", "message"), [
    ({"pattern.decay_length": 0.01}, r"pattern.decay_length is not a parameter of a set that has \[field\]"),
    ({"field.share": (0.5, 0.6)}, r"x has \d+ numbers, expected as many as share has: 2"),
    ({"field.share": (0.5, "a")}, r"field.share\[1\] = 'a' is not a number"),
    ({"field.share": 3.0}, r"field.share = 3.0 is not a list of numbers"),
    ({"field.equal": (-1.0, 1.0)}, r"field.equal\[0\] = -1 is outside \[0, inf\)"),
])  # fmt: skip
def test_broken_field_is_refused(imported, change, message):
    with pytest.raises(ValueError, match=message):
        imported[0].with_values(change, "user", "test")


def test_a_file_with_both_sections_is_refused(imported, tmp_path):
    path = tmp_path / "joint.toml"
    pattern = format_parameter_file(FILE).partition("[pattern]\n")[2].partition("\n[")[0]
    path.write_text(f"{format_parameter_file(imported[0])}\n[pattern]\n{pattern}\n")
    with pytest.raises(ValueError, match=r"joint.toml: pattern\.\w+, .* with field\.share, .*") as error:
        load_parameter_file(path, "bolted_joint")
    assert str(error.value).endswith(": state parameters of only one section, [pattern], [plate] or [field]")
    assert "\n" not in str(error.value)


def test_unbalanced_field_is_refused():
    even = {"share": (0.5, 0.5), "x": (-1.0, 1.0), "y": (0.0, 0.0), "equal": (1.0, 1.0), "tilt": (1.0, -1.0)}
    NodalField(**even)
    for name, values, message in (
        ("share", (0.5, 0.6), "the sum of share is 1.1"),
        ("y", (1.0, 2.0), r"y \[m\] of the centroid of the points is 1.5"),
        ("equal", (1.0, 2.0), "the mean of equal over the area is 1.5"),
        ("tilt", (1.0, 1.0), "the mean of tilt over the area is 1, expected 0"),
    ):
        with pytest.raises(ValueError, match=message):
            NodalField(**even | {name: values})


def test_what_asks_for_bolts_refuses_a_field(imported):
    with pytest.raises(ValueError, match=r"the joint has \[field\], a nodal field of \d+ points; expected"):
        pressure_between_bolts(imported[0].values, PRELOAD)


def test_fmus_have_the_field(tmp_path):
    """After import, through parameter file, native FMU and ramp, the stiffnesses are the direct sums over all
    nodes."""
    shape = get_bolted_frame(JOINT).pressure_distribution()
    mean = PRELOAD * JOINT.n_bolts / JOINT.A_0
    many = ContactPressureField(
        shape.area_share * JOINT.A_0, shape.position, mean * shape.preload_pressure_ratio
    )
    (tmp_path / "field.csv").write_text(nodal_result.format_field_csv(many))
    out = tmp_path / "joint.toml"
    line = [
        "footprint",
        "import",
        str(tmp_path / "field.csv"),
        "--preload",
        f"{PRELOAD:g}",
        "--out",
        str(out),
    ]
    assert cli.main(line) == 0
    file = load_parameter_file(out, "bolted_joint")
    assert len(file.values.pattern.share) < many.nodal_area.size
    with here_alone():
        (fmu,) = build_fmus(["BoltedJoint"], ["fmi2"], file, tmp_path)
    found = ramp.run_ramp(fmu, "preload", 27e3, 3e3).variable_columns
    full = normalise_pressure_field(JOINT, many, PRELOAD)
    for i in range(1, len(found["preload"])):
        _, (expected, _), peak = direct(file.values, full, LoadCase(found["preload"][i] / PRELOAD, 0.0, 0.0))
        got = [found["p_mean"][i] * file.values.A_0, *(found[n][i] for n in ("K_zz", "K_xx", "K_rx", "K_ry"))]
        shear = got.pop(2), expected[2]
        np.testing.assert_allclose(got, np.delete(expected, 2), rtol=1e-5)  # 120 of the points
        assert shear[0] == pytest.approx(shear[1], rel=5e-3)  # the patches of the friction
        assert found["p_max"][i] == pytest.approx(peak, rel=1e-7)  # the curve's table, 1e-8
    library.write_library(tmp_path, file, {"bolted_joint": [(PRELOAD, 0.0, 293.15)]})
    assert any("field_of_field_csv" in path.name for path in tmp_path.rglob("*.mo"))


def test_uncertainty_of_a_joint_with_a_field(imported, tmp_path, capsys):
    """The study does not know the parameters of a pattern."""
    path = tmp_path / "joint.toml"
    path.write_text(format_parameter_file(imported[0]))
    line = ["uncertainty", "bolted_joint", "--params", str(path), "--samples", "16", "--set"]
    assert cli.main([*line, "surface.D=1.40..1.44"]) == 0
    assert "16 samples, 0 refused by the law" in capsys.readouterr().out
    assert cli.main([*line, "pattern.decay_length=1e-3..2e-3"]) == 2
    assert "unknown name 'pattern.decay_length', allowed are" in capsys.readouterr().err


def test_a_force_that_is_off_is_scaled_if_that_is_asked_for(imported, tmp_path, capsys):
    """Nodal pressures of some solvers do not add up to the contact force."""
    path = tmp_path / "field.csv"
    path.write_text(nodal_result.format_field_csv(replace(FIELD, nodal_pressure=0.8 * FIELD.nodal_pressure)))
    line = ["footprint", "import", str(path), "--preload", f"{PRELOAD:g}"]
    assert cli.main(line) == 2
    assert "(--force-tolerance)" in capsys.readouterr().err
    for wrong in ("0", "1.5", "nan"):
        assert cli.main([*line, "--force-tolerance", wrong]) == 2
        assert f"force_tolerance = {wrong} is outside (0, 1)" in capsys.readouterr().err
    out = tmp_path / "joint.toml"
    assert cli.main([*line, "--force-tolerance", "0.3", "--out", str(out)]) == 0
    assert "scaled by +25 % to the force of the bolts" in capsys.readouterr().err
    right, _ = imported
    found = BoltedJointSpring.from_joint(load_parameter_file(out).values).evaluate(
        PRELOAD, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    )
    exact = BoltedJointSpring.from_joint(right.values).evaluate(
        PRELOAD, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    )
    assert found["K_zz"] == pytest.approx(exact["K_zz"], rel=1e-6)  # the points of both, 1e-6


def test_import_draws_and_refuses(tmp_path, capsys, enter):
    enter(coarse.contact_cells(4))
    path = tmp_path / "field.csv"
    path.write_text(nodal_result.format_field_csv(field(0.45)))
    line = ["footprint", "import", str(path), "--preload", f"{PRELOAD:g}"]
    assert cli.main(line) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"jointfmu footprint: {path}: line ")
    assert message.count("\n") == 1
    assert "has no pressure; " in message
    assert cli.main([*line, "--open", "drop", "--plot", str(tmp_path / "a.png"), "--json"]) == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    for more, text in (
        (["--moment", "100"], "--moment and --moment-file belong together"),
        (["--open", "maybe"], "--open = 'maybe' is not one of refuse, keep, drop"),
        (["--preload", "-1"], "preload = -1 N is outside (0, inf)"),
        (["--data", "p"], "is read as csv; point data are only for the format mesh (--data)"),
        (["--length-unit", "mm"], "a CSV file states units and plane in its heading (--length-unit)"),
        (["--with", "b.lis"], "further listings are only for the format ansys or abaqus (--with)"),
    ):
        assert cli.main([*line, "--open", "keep", *more]) == 2
        assert text in capsys.readouterr().err


@pytest.mark.parametrize(("factor", "told"), [(1e-6, "about 1e6 too small"), (1e3, "about 1e3 too large")])
def test_a_wrong_unit_of_the_pressure_is_named_and_not_scaled(factor, told):
    wrong = replace(FIELD, nodal_pressure=factor * FIELD.nodal_pressure)
    with pytest.raises(ValueError, match=told) as error:
        insert_pressure_field(FILE, wrong, PRELOAD, "test")
    assert "tolerance" not in str(error.value)


def test_the_printed_preload_gives_the_fmu_the_imported_pressure(tmp_path, capsys):
    """The imported field is that after embedding; the input `preload` is the force before embedding."""
    (tmp_path / "joint.toml").write_text(
        format_parameter_file(FILE.with_values({"embedding": 700.0}, "user", "measured"))
    )
    path, out = tmp_path / "field.csv", tmp_path / "out.toml"
    path.write_text(nodal_result.format_field_csv(FIELD))
    words = ["footprint", "import", str(path), "--preload", f"{PRELOAD:g}"]
    assert cli.main([*words, "--params", str(tmp_path / "joint.toml"), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    preload = float(re.search(r"^set preload = (\S+) N in the FMU", printed, re.MULTILINE)[1])
    found = BoltedJointSpring.from_joint(load_parameter_file(out).values).evaluate(
        preload, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    )
    mean = FIELD.normal_force / FIELD.nodal_area.sum()
    assert found["p_mean"] == pytest.approx(mean, rel=1e-4)  # the printed preload has five digits
    assert f"K_zz = {found['K_zz']:.4g} N/m" in printed


def test_positions_of_the_bolts_are_found_in_a_field():
    positions = np.array([[-0.1, -0.1], [0.1, -0.1], [-0.1, 0.1], [0.1, 0.1]])
    found, _ = insert_pressure_field(
        FILE, FIELD, PRELOAD, "test", bolt_positions=positions + FIELD.contact_centroid
    )
    layout = PlaneLayout.from_joint_parameters(found.values)
    np.testing.assert_allclose(layout.bolt_positions, positions, atol=1e-15)


@pytest.mark.parametrize("has_holes", [False, True])
def test_plates_around_a_field_have_the_size_of_the_contact(has_holes):
    """Nodes on a grid of 200 x 100 mm, edges included, with and without holes of 13.5 mm in the contact."""
    x, y = (array.ravel() for array in np.meshgrid(np.linspace(-0.1, 0.1, 81), np.linspace(-0.05, 0.05, 41)))
    share = np.where(np.abs(x) > 0.0999, 0.5, 1.0) * np.where(np.abs(y) > 0.0499, 0.5, 1.0)
    bolts, hole = np.array([[-0.08, -0.03], [0.08, -0.03], [-0.08, 0.03], [0.08, 0.03]]), 13.5e-3
    area = share / share.sum() * 0.02
    if has_holes:
        inside = (np.hypot(x[:, None] - bolts[:, 0], y[:, None] - bolts[:, 1]) < 0.5 * hole).any(axis=1)
        x, y, area = x[~inside], y[~inside], area[~inside]
        area *= (0.02 - len(bolts) * 0.25 * np.pi * hole**2) / area.sum()
    contact = ContactPressureField(area, np.column_stack([x, y]), np.ones(area.size))
    stated = Namespace(hole="13.5", head="18", thickness=("20", "20"))
    assembly, notes = bodies.build_assembly(stated, FILE, contact, bolts)
    assert (assembly.side1.length, assembly.side1.width) == pytest.approx((0.2, 0.1), rel=1e-12)
    assert "200 x 100 mm, of which the contact covers 100%" in notes[0]
