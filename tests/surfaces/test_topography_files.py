"""Surface files and the command `jointfmu surface`: reading, repair, refusals, writing."""

import json
import re
import subprocess
import sys
from contextlib import chdir
from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.inputs.surfaces import csvfile, reading, synthesis
from jointfmu_tools.inputs.surfaces import heights as sift
from jointfmu_tools.inputs.surfaces.form import fill_gaps, remove_form, remove_spikes
from jointfmu_tools.inputs.surfaces.heights import ArealMap, Profile
from jointfmu_tools.inputs.surfaces.reading import read_heights

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.contact.roughness import RQ_OVER_RA
from jointfmu.joints import KINDS
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file


@pytest.fixture(scope="module")
def area():
    return synthesis.synthesize_isotropic(
        synthesis.FractalWaves(size=1e-3, points=128, gamma=1.5), 2.5, 1e-9, 20, 1
    )


@pytest.fixture(scope="module")
def line():
    return synthesis.synthesize_profile(
        synthesis.FractalWaves(size=1e-3, points=1024, gamma=1.5), 1.42, 1.21e-8, 1
    )


@pytest.fixture
def folder(tmp_path, area, line, enter):
    enter(chdir(tmp_path))
    (tmp_path / "area.csv").write_text(csvfile.format_scan_csv(area))
    (tmp_path / "line.csv").write_text(csvfile.format_scan_csv(line))
    return tmp_path


def run(capsys, *arguments):
    assert cli.main([str(a) for a in arguments]) == 0
    return capsys.readouterr()


def test_our_csv_is_read_back(folder, area, line):
    again, profile = read_heights("area.csv"), read_heights("line.csv")
    assert isinstance(again, ArealMap)
    assert isinstance(profile, Profile)
    np.testing.assert_allclose(again.z, area.z, rtol=1e-6, atol=1e-6 * np.ptp(area.z))
    np.testing.assert_allclose(profile.z, line.z, rtol=1e-6, atol=1e-6 * np.ptp(line.z))
    assert (again.dx, again.dy) == (area.dx, area.dy)
    assert profile.dx == pytest.approx(line.dx, rel=1e-9)


def test_points_with_units_and_gaps(folder, area):
    y, x = np.mgrid[:128, :128]
    rows = [
        f"{0.5 * a:g}; {2 * b:g}; {c * 1e9:.9g}"
        for a, b, c in zip(x.ravel(), y.ravel(), area.z.ravel(), strict=True)
    ]
    del rows[1000]
    rows[2000] = rows[2000].rpartition(";")[0] + ";"
    (folder / "p.csv").write_text("# points: x [um], y [mm], z [nm]\n" + "\n".join(rows) + "\n")
    found = read_heights("p.csv")
    assert (found.dx, found.dy) == (pytest.approx(0.5e-6), pytest.approx(2e-3))
    assert np.isnan(found.z).sum() == 2
    good = np.isfinite(found.z)
    np.testing.assert_allclose(found.z[good], area.z[good], rtol=1e-7, atol=1e-15)


@pytest.mark.parametrize("suffix", ["x3p", "nc", "gwy"])
def test_instrument_files_keep_axes_and_units(folder, suffix):
    import SurfaceTopography

    z = np.add.outer(np.arange(70.0), 10.0 * np.arange(90.0)) ** 1.1  # (nx, ny), in um
    made = SurfaceTopography.Topography(z, (140.0, 45.0), unit="um")
    {"x3p": made.to_x3p, "nc": made.to_netcdf, "gwy": made.to_gwy}[suffix](str(folder / f"t.{suffix}"))
    found = read_heights(f"t.{suffix}")
    assert found.z.shape == (90, 70)
    assert (found.dx, found.dy) == (pytest.approx(2e-6), pytest.approx(0.5e-6))
    np.testing.assert_allclose(found.z - found.z[0, 0], (z.T - z[0, 0]) * 1e-6, rtol=1e-6, atol=1e-12)
    with pytest.raises(ValueError, match=r"states its unit .* itself; leave the unit um out"):
        read_heights(f"t.{suffix}", "um")


@pytest.mark.slow
def test_missing_points_and_spikes_are_repaired_and_counted(folder, area, capsys):
    z = area.z.copy()
    rng = np.random.default_rng(0)
    at = rng.choice(z.size, 300, replace=False)
    z.flat[at[:200]] = np.nan
    z.flat[at[200:]] += 20.0 * area.z.std()
    (folder / "bad.csv").write_text(csvfile.format_scan_csv(area.replace_heights(z)))
    out = json.loads(run(capsys, "surface", "bad.csv", "--json").out)
    repairs = {one["repair"]: one["count"] for one in out["repairs"]}
    assert repairs == {"spikes taken as missing": 100, "missing points filled harmonically": 300}
    good = json.loads(run(capsys, "surface", "area.csv", "--json").out)
    assert good["repairs"] == []
    for bad, fine in zip(out["results"], good["results"], strict=True):
        if bad["direction"] == "areal" and bad["method"] == "structure":
            assert bad["surface"]["D_s"]["value"] == pytest.approx(fine["surface"]["D_s"]["value"], abs=0.03)
    text = run(capsys, "surface", "bad.csv").out
    assert (
        "repaired in bad.csv: spikes taken as missing: 100 of 16384 points (0.61 %); with them Sq is " in text
    )
    kept = json.loads(run(capsys, "surface", "bad.csv", "--json", "--keep-spikes").out)
    assert [repair["repair"] for repair in kept["repairs"]] == ["missing points filled harmonically"]


def test_the_effect_of_spikes_on_sq_is_said(area):
    """Heights of rms s with a share q of spikes of height H: Sq^2 is about s^2 + q (1 - q) H^2."""
    z = area.z.copy()
    z.ravel()[:: z.size // 100] += 1e-4
    (repair,) = remove_spikes(replace(area, z=z))[1]
    said = float(repair.effect_note.split("Sq is ")[1].split()[0])
    share = repair.repaired_point_count / repair.total_point_count
    expected = np.hypot(np.std(remove_form(area).z), 1e-4 * np.sqrt(share * (1.0 - share)))
    assert said == pytest.approx(expected / np.std(remove_form(area).z), rel=0.02)  # three digits, 0.6 %


def test_clean_surfaces_have_no_spikes():
    for D in (1.1, 1.5, 1.9):
        waves = synthesis.FractalWaves(size=1e-3, points=256, gamma=1.5)
        for made in (
            synthesis.synthesize_isotropic(waves, D + 1, 1e-9, 20, 1),
            synthesis.synthesize_profile(waves, D, 1e-9, 1),
        ):
            assert remove_spikes(made)[1] == []


def test_too_many_gaps_are_refused(area):
    z = area.z.copy()
    z[:40] = np.nan
    with pytest.raises(ValueError, match="5120 of 16384 points are missing or spikes, at most 20 %"):
        fill_gaps(area.replace_heights(z))


@pytest.mark.parametrize(("form", "order"), [("mean", 0), ("tilt", 1), ("curvature", 2)])
def test_form_is_removed(area, form, order):
    y, x = np.mgrid[-1:1:128j, -1:1:128j]
    shape = [3.0 + 0 * x, 3.0 + 2 * x - y, 3.0 + 2 * x - y + x * y - 4 * x**2 + y**2][order]
    flat = remove_form(area, form).z
    both = remove_form(area.replace_heights(area.z + shape), form).z
    np.testing.assert_allclose(both, flat, atol=1e-13)
    assert abs(flat.mean()) < 1e-18 + 1e-12 * flat.std()


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("none.csv", None, "none.csv: does not exist"),
        ("xy.csv", "x [um],y [um]\n" + "0,0\n4,0\n0,4\n4,4\n", "three columns: x, y and the heights z"),
        ("empty.csv", "", "empty.csv: is not a surface scan: the file is empty"),
        ("words.csv", "hello 1 2\n", "words.csv: is not a surface scan: a text of 2 numbers"),
        (
            "junk.vk4",
            "\x00\x01junk",
            "is not a surface scan: it has not the content of a .vk4 file",
        ),
        ("odd.foo", "\x00\x01junk", "odd.foo: is not a surface scan: neither CSV nor another format"),
        ("scan.pdf", "%PDF-1.7", "scan.pdf: is not a surface scan: it is a PDF"),
        (
            "bare.csv",
            "0,1\n1,2\n" * 99,
            "bare.csv: states no length unit; state it, one of m, mm",
        ),
        (
            "unit.csv",
            "# profile: x, z\n0,1\n",
            "unit.csv: the header has no unit for x, z; write it as x [um]",
        ),
        ("inch.csv", "# profile: x [in], z [in]\n0,1\n", "unit 'in' is not one of m, mm, um, nm"),
        ("step.csv", "# grid: dy = 1 um, z [um]\n0,1\n", "step.csv: the header states no dx"),
        (
            "few.csv",
            "# profile: x [m], z [m]\n" + "".join(f"{i},{i % 7}\n" for i in range(99)),
            "at least 128",
        ),
        ("patch.csv", "# grid: dx = 1 um, dy = 1 um, z [m]\n" + "1,2,3\n" * 99, "at least 64 x 64"),
        (
            "flat.csv",
            "# profile: x [m], z [m]\n" + "".join(f"{i},5\n" for i in range(200)),
            "constant surface",
        ),
        (
            "ramp.csv",
            "# profile: x [um], z [um]\n" + "".join(f"{i},{0.1 * i:.1f}\n" for i in range(200)),
            "ramp.csv: without its tilt the surface is smooth, it has no D and no G",
        ),
        (
            "nan.csv",
            "# profile: x [m], z [m]\n" + "".join(f"{i},nan\n" for i in range(200)),
            "all 200 heights",
        ),
        (
            "text.csv",
            "# profile: x [m], z [m]\n1,abc\n",
            "is not a surface scan: line 2: 'abc' is not a number",
        ),
        ("short.csv", "# profile: x [m], z [m]\n1,2\n\n3\n", "short.csv: line 4 has 1 columns, expected 2"),
        ("head.csv", "# profile: x [m], z [m]\n", "head.csv: is not a surface scan: it holds no numbers"),
        ("cols.csv", "# profile: x [m], z [m]\n1,2,3\n", "has 3 columns, its header declares 2"),
        ("twice.csv", "# profile: x [m], z [m]\n" + "1,2\n" * 200, "x has repeated values"),
        (
            "uneven.csv",
            "# profile: x [um], z [um]\n" + "".join(f"{i**1.1},{i % 7}\n" for i in range(200)),
            "spacing of x varies",
        ),
    ],
)
def test_what_is_refused_by_name(folder, capsys, name, content, says):
    if content is not None:
        (folder / name).write_text(content)
    assert says in refused_line(capsys, "surface", name)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--unit", "in"], "unit = 'in' is not one of m, mm, um, nm (--unit)"),
        (["--unit", "um"], "states its units"),
        (["--range", "2", "1"], "expected 0 < LOW < HIGH"),
        (["--range", "1", "2"], "holds 0 values"),
        (["--out", "x.toml"], "needs --joint"),
        (["--joint", "glue"], "invalid choice: 'glue'"),
        (["--plot", "x.pdf"], "suffix '.pdf' is not that of a picture, allowed are .png, .svg"),
        (["--gamma", "1"], "gamma = 1 is outside (1, inf)"),
        (["--form", "cone"], "invalid choice: 'cone'"),
        (["--joint", "bolted_joint", "--out", "x.toml"], "is one side of the contact; state which"),
        (["--side", "3"], "invalid choice: '3'"),
        (["line.csv", "--side", "1"], "side = 1 is given with two files"),
        (["--longest-wave", "-1"], "longest wave = -1 m is outside (0, inf)"),
        (["--longest-wave", "2e-3"], "line.csv: longest wave = 0.002 m is outside [1.95e-05, 0.001]"),
        (["line.csv", "line.csv"], "3 files given"),
        (["area.csv"], "two of the same kind"),
    ],
)
def test_options_are_refused_by_name(folder, capsys, options, says):
    assert says in refused_line(capsys, "surface", "line.csv", *options)
    assert not (folder / "x.toml").exists()


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
def test_cells_of_numbers(folder, mark):
    """An empty cell is a missing point, text after # a comment; without separator blanks separate."""
    gap = "nan" if mark == " " else ""
    lines = ["# x", f"1{mark} 2.5{mark}3  # here", "", f"{gap}{mark}-1e-3{mark} {gap}"]
    (folder / "n.csv").write_text("\n".join(lines))
    expected = [[1.0, 2.5, 3.0], [np.nan, -1e-3, np.nan]]
    np.testing.assert_array_equal(csvfile.read_number_table(folder / "n.csv"), expected)


def test_bare_columns_take_the_unit(folder, line, capsys):
    rows = "".join(f"{i * line.dx * 1e6:.9g} {z * 1e6:.9g}\n" for i, z in enumerate(line.z))
    (folder / "bare.txt").write_text(rows)
    bare = json.loads(run(capsys, "surface", "bare.txt", "--unit", "um", "--json").out)
    ours = json.loads(run(capsys, "surface", "line.csv", "--json").out)
    assert bare["kind"] == "profile"
    for one, other in zip(bare["results"], ours["results"], strict=True):
        # both files hold rounded heights
        assert one["profile"]["D"]["value"] == pytest.approx(other["profile"]["D"]["value"], abs=1e-4)


def test_table_names_both_dimensions(folder, capsys):
    text = run(capsys, "surface", "line.csv").out
    assert "D, profile" in text
    assert "D_s, surface" in text
    assert "harmonic_drive (D_s of the surface, " in text
    assert "bolted_joint (D of the profile, " in text
    assert "gear_contact (D of the profile, " in text


def test_json_is_one_object(folder, capsys):
    captured = run(capsys, "surface", "line.csv", "line.csv", "--json")
    out = json.loads(captured.out)
    assert captured.err == ""
    assert out["pair"] is True
    assert {(one["method"], one["direction"]) for one in out["results"]} == {
        ("structure", "profile"),
        ("psd", "profile"),
    }
    for one in out["results"]:
        assert one["surface"]["D_s"]["value"] == pytest.approx(one["profile"]["D"]["value"] + 1.0, rel=1e-12)
        assert one["G_eq30"] < one["profile"]["G"]["value"]  # ln 1.5 < 1


def test_help_shows_both_sub_commands(capsys):
    for words, shown in ((["--help"], "synthesize"), (["a.csv", "--help"], "--range LOW HIGH")):
        with pytest.raises(SystemExit) as end:
            cli.main(["surface", *words])
        assert end.value.code == 0
        said = capsys.readouterr().out
        assert "identify" in said
        assert shown in said


def test_sub_command_may_be_named(folder, capsys):
    named = run(capsys, "surface", "identify", "line.csv", "--json").out
    assert named == run(capsys, "surface", "--json", "line.csv").out


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_plot(folder, capsys, suffix):
    run(capsys, "surface", "line.csv", "--plot", f"p.{suffix}")
    start = (folder / f"p.{suffix}").read_bytes()[:200]
    assert (b"PNG" in start) if suffix == "png" else (b"<?xml" in start)


@pytest.mark.slow
def test_written_parameters_build(folder, line, capsys):
    """The flank is smooth enough for the law; on too rough flanks no spot is elastic."""
    (folder / "line.csv").write_text(csvfile.format_scan_csv(replace(line, z=0.01 * line.z)))
    run(capsys, "surface", "line.csv", "--side=1", "--joint=gear_contact", "--law=yu2022", "--out=gear.toml")
    file = load_parameter_file("gear.toml", "gear_contact")
    assert file.sources["surface1.D"].startswith("identified from line.csv (side 1, the other smooth) by ")
    assert file.values.e == load_default("gear_contact").values.e
    run(capsys, "build", "GearContact", "--flavour", "python", "--params", "gear.toml", "--out", "dist")
    assert (folder / "dist" / "python" / "GearContact.fmu").is_file()


def test_params_choose_the_start(folder, capsys):
    run(
        capsys,
        "surface",
        "line.csv",
        "--side=1",
        "--joint",
        "bolted_joint",
        "--law=zhao2018",
        "--write",
        "a.toml",
    )  # the other name of --out
    changed = (folder / "a.toml").read_text().replace("H = { value = 1960000000.0", "H = { value = 2.5e9")
    (folder / "a.toml").write_text(changed)
    run(capsys, "surface", "area.csv", "--params", "a.toml", "--side", "2", "--out", "b.toml")
    file = load_parameter_file("b.toml", "bolted_joint")
    assert file.values.H == 2.5e9
    assert "area.csv" in file.sources["surface.G"]
    assert "joint = 'bolted_joint'" in refused_line(
        capsys, "surface", "area.csv", "--params", "a.toml", "--joint", "gear_contact"
    )


@pytest.mark.parametrize(
    ("shape", "D", "G"),
    [
        ("isotropic", ["2.5"], ["1e-9"]),
        ("textured", ["1.3", "1.6"], ["1e-9", "1e-10"]),
        ("profile", ["1.4"], ["1e-9"]),
    ],
)
def test_synthesize(folder, capsys, shape, D, G):
    command = ["surface", "synthesize", "--shape", shape, "--size", "1e-3", "--points", "128"]
    out = json.loads(run(capsys, *command, "--D", *D, "--G", *G, "--seed", 7, "--out", "s.csv", "--json").out)
    first = (folder / "s.csv").read_text()
    assert read_heights("s.csv").z.std() == pytest.approx(out["rms"], rel=1e-5)
    run(capsys, *command, "--D", *D, "--G", *G, "--seed", 7, "--out", "s.csv")
    assert (folder / "s.csv").read_text() == first
    run(capsys, *command, "--D", *D, "--G", *G, "--seed", 8, "--out", "s.csv")
    assert (folder / "s.csv").read_text() != first


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (["--D", "1.5"], "D = 1.5 is outside (2, 3): fractal dimension of the surface"),
        (["--D", "2.5", "2.5"], "--D has 2 values, expected 1 for the shape isotropic"),
        (["--G", "0"], "G = 0 m is outside (0, inf)"),
        (["--G", "nan"], "G = nan m is outside (0, inf)"),
        (["--gamma", "1"], "gamma = 1 is outside (1, inf)"),
        (["--size", "-1"], "size = -1 m is outside (0, inf)"),
        (["--points", "10"], "10 x 10 points, an areal map needs at least 64 x 64"),
        (["--points", "0"], "points = 0 is outside"),
        (["--seed", "-1"], "seed = -1 is negative"),
        (["--ridges", "0"], "ridges = 0"),
        (["--out", "s.png"], ".png is the suffix of another kind of file; expected .csv"),
        (["--points", "1000000"], "points = 1000000 take 6.4e+04 GB, allowed are 2 GB: at most 5590 points"),
        (["--shape", "profile", "--points", "100000000"], "at most 10526315 points along a side of shape"),
        (["--ridges", "100000"], "ridges = 100000, allowed are 1, 2, 3, ... 1000"),
        (["--shape", "cone"], "invalid choice: 'cone'"),
    ],
)
def test_synthesize_refuses_by_name(folder, capsys, change, says):
    command = ["--size", "1e-3", "--points", "128", "--D", "2.5", "--G", "1e-9", "--out", "s.csv", *change]
    assert says in refused_line(capsys, "surface", "synthesize", *command)
    assert not (folder / "s.csv").exists()


def columns(folder, x, z, decimals, unit="um"):
    """Profile file with rounded x."""
    rows = "".join(f"{a:.{decimals}f},{b:.6g}\n" for a, b in zip(x, z, strict=True))
    (folder / "c.csv").write_text(f"# profile: x [{unit}], z [um]\n{rows}")
    return read_heights("c.csv")


@pytest.mark.parametrize("decimals", [1, 4])
@pytest.mark.parametrize("step", [0.1563, 0.041, 0.5])
def test_rounded_positions_are_read(folder, step, decimals):
    """One decimal for steps of 0.16 and 0.04 um, as stylus instruments print: unequal steps and repeated
    values."""
    x, z = step * np.arange(1300), np.random.default_rng(0).standard_normal(1300)
    for order in (slice(None), slice(None, None, -1)):
        found = columns(folder, x[order], z[order], decimals)
        assert found.dx == pytest.approx(1e-6 * step, rel=2.0 * 10.0**-decimals / x[-1] + 1e-12)
        np.testing.assert_allclose(found.z, 1e-6 * z, rtol=1e-5)


def test_significant_digits_are_rounding_too(folder):
    x = 0.1563 * np.arange(1000)
    rows = "".join(f"{a:.4g},{i % 7}\n" for i, a in enumerate(x))
    (folder / "s.csv").write_text("# profile: x [um], z [um]\n" + rows)
    assert read_heights("s.csv").dx == pytest.approx(1.563e-7, rel=1e-3)


def test_missing_rows_of_a_profile_are_missing_points(folder):
    x, z = 0.5 * np.arange(500), np.random.default_rng(0).standard_normal(500)
    keep = np.ones(500, dtype=bool)
    keep[[3, 4, 5, 200, 201, 202, 203]] = False
    found = columns(folder, x[keep], z[keep], 1)
    assert found.dx == pytest.approx(5e-7)
    assert np.array_equal(np.isfinite(found.z), keep)
    np.testing.assert_allclose(found.z[keep], 1e-6 * z[keep], rtol=1e-5)


@pytest.mark.parametrize(
    ("x", "says"),
    [
        (np.floor(np.arange(500) ** 1.1), "spacing of x varies"),
        (np.concatenate([np.arange(250.0), np.arange(250.0)[::-1]]), "x has repeated values"),
        (np.arange(500) + 0.2 * (-1.0) ** (np.arange(500) // 7), "spacing of x varies"),
    ],
    ids=["uneven", "there and back", "shaken"],
)
def test_what_no_rounding_explains_is_refused(folder, x, says):
    with pytest.raises(ValueError, match=says):
        columns(folder, x, np.arange(500) % 7, 3)


def test_points_given_twice_are_refused(folder):
    rows = [f"{i % 70},{i // 70},{i % 11}" for i in range(70 * 70)]
    (folder / "t.csv").write_text("# points: x [um], y [um], z [um]\n" + "\n".join([*rows, rows[5]]))
    with pytest.raises(ValueError, match=r"some points \(x, y\) are repeated"):
        read_heights("t.csv")


@pytest.mark.parametrize(
    ("unit", "step", "says"),
    [
        (
            "m",
            0.16,
            "the field is 163.8 m with lengths in m, scans have 5e-05 to 1 m; are the lengths in um",
        ),
        ("um", 5e-5, "the field is 5.12e-08 m with lengths in um"),
    ],
)
def test_a_field_of_no_scan_asks_back(folder, capsys, unit, step, says):
    x, walk = step * np.arange(1024), np.cumsum(np.random.default_rng(0).standard_normal(1024))
    rows = "".join(f"{a:.6g} {b:.6g}\n" for a, b in zip(x, walk, strict=True))
    (folder / "f.txt").write_text(rows)
    refused = refused_line(capsys, "surface", "f.txt", "--unit", unit)
    assert says in refused
    assert refused.endswith("or confirm the size (--force)\n")
    run(capsys, "surface", "f.txt", "--unit", unit, "--force")


def test_a_field_of_an_atomic_force_microscope_is_none_to_ask_about(folder, capsys):
    """A map is accepted; a profile of this length needs a confirmation."""
    walk = np.cumsum(np.random.default_rng(0).standard_normal((72, 72)), axis=1)
    rows = "".join(f"{7e-3 * i:.6g} {7e-3 * j:.6g} {1e-3 * walk[i, j]:.6g}\n" for i, j in np.ndindex(72, 72))
    (folder / "f.txt").write_text(rows)
    run(capsys, "surface", "f.txt", "--unit", "um")
    (folder / "p.txt").write_text("".join(f"{7e-3 * i:.6g} {walk.flat[i]:.6g}\n" for i in range(1024)))
    assert "the field is 7.168e-06 m" in refused_line(capsys, "surface", "p.txt", "--unit", "um")


@pytest.mark.parametrize(
    ("heads", "factors", "options"),
    [
        ("X [mm];Z [um]", (1e3, 1e6), ()),
        ("x (mm);z (um)", (1e3, 1e6), ()),
        ("x/mm;z/um", (1e3, 1e6), ()),
        ("\ufeffPosition [mm];Höhe [µm]", (1e3, 1e6), ()),
        ("X;Z", (1e3, 1e6), ("--unit-x", "mm", "--unit-z", "um")),
        ("X [mm];Z", (1e3, 1e6), ("--unit-z", "um")),
        (None, (1e3, 1e6), ("--unit-x", "mm", "--unit-z", "um")),
    ],
)
def test_units_of_each_column(folder, line, capsys, heads, factors, options):
    """Each column has its own unit, with decimal commas; all files give the same heights as our own
    format."""
    x = np.arange(line.z.size) * line.dx
    numbers = [f"{factors[0] * a:.9g};{factors[1] * z:.9g}" for a, z in zip(x, line.z, strict=True)]
    text = "\n".join([*([heads] if heads else []), *numbers]).replace(".", ",")
    (folder / "titled.csv").write_text(text, encoding="utf-8")
    found = json.loads(run(capsys, "surface", "titled.csv", *options, "--json").out)
    ours = json.loads(run(capsys, "surface", "line.csv", "--json").out)
    for one, other in zip(found["roughness"]["scans"], ours["roughness"]["scans"], strict=True):
        assert one["Rq"] == pytest.approx(other["Rq"], rel=1e-6)  # of nine digits
        assert one["slope"] == pytest.approx(other["slope"], rel=1e-6)


def test_the_micro_sign_of_latin_1_is_read_and_other_encodings_are_refused(folder, line, capsys):
    rows = "".join(f"{1e6 * i * line.dx:.9g};{1e6 * z:.9g}\n" for i, z in enumerate(line.z))
    for heads in ("X [µm];Z [µm]", "# profile: x [µm], z [µm]"):
        (folder / "l.csv").write_text(f"{heads}\n{rows}", encoding="latin-1")
        assert read_heights(folder / "l.csv").z == pytest.approx(line.z, rel=1e-8)
    (folder / "l.csv").write_text(f"X [µm];Z [µm]\n{rows}", encoding="utf-16")
    assert "l.csv: is not a text file; expected CSV (UTF-8)" in refused_line(capsys, "surface", "l.csv")


@pytest.mark.parametrize(
    ("heads", "options", "says"),
    [
        ("X [mm];Z", (), "column 'Z' states no length unit; state it, one of m, mm"),
        ("X [mm];Z [um]", ("--unit", "mm"), "column 'X' states its unit mm; leave out the unit mm"),
        ("X [mm];Z [V]", (), "unit 'V' is not one of m, mm, um, nm"),
        ("X [mm];Z [mm]", (), "the rms height is"),
        ("X [mm];Z [um]", ("--unit-z", "in"), "unit_z = 'in' is not one of m, mm, um, nm (--unit-z)"),
    ],
)
def test_columns_whose_units_cannot_be(folder, line, capsys, heads, options, says):
    x = np.arange(line.z.size) * line.dx
    rows = "".join(f"{1e3 * a:.9g};{1e6 * z:.9g}\n" for a, z in zip(x, line.z, strict=True))
    (folder / "titled.csv").write_text(f"{heads}\n{rows}")
    assert says in refused_line(capsys, "surface", "titled.csv", *options)


def test_units_as_instruments_write_them():
    """A .sur file in UTF-8 is read as Latin-1: µm becomes Âµm."""
    assert reading.length_unit_size("Âµm") == pytest.approx(1e-6)
    with pytest.raises(ValueError, match="its unit 'furlong' is not a known unit of length"):
        reading.length_unit_size("furlong")


@pytest.mark.parametrize("unit", ["um", "µm", "μm"])
def test_micrometres_in_all_spellings(folder, unit, line):
    found = columns(folder, np.arange(200), np.arange(200) % 7, 0, unit)
    assert found.dx == pytest.approx(1e-6)


def test_refused_without_slow_imports(folder):
    """The imports of scipy's fits, matplotlib and SurfaceTopography take a second or two."""
    (folder / "a.png").write_bytes(b"\x89PNG" + bytes(100))
    (folder / "a.sur").write_bytes(bytes(1000))
    (folder / "a.txt").write_text("1 2\n" * 200)
    code = (
        "import sys; from jointfmu_tools import cli; "
        "assert [cli.main(['surface', f'a.{s}']) for s in ('png', 'sur', 'txt')] == [2, 2, 2]; "
        "print([m for m in ('scipy.optimize', 'matplotlib', 'SurfaceTopography') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_signatures_are_those_of_the_installed_readers():
    from SurfaceTopography.IO import MagicMatch, readers

    for reader in readers:
        for place, mark in getattr(reader, "_magic", None) or []:
            assert sift.has_scan_signature(bytes(place) + mark), reader
        if reader.can_read(b"\x00\x01junk" * 100) != MagicMatch.NO:
            assert not set(reader._file_extensions) & set(sift.SUFFIXES_WITH_SIGNATURE), reader


def test_roughness_and_level_are_printed(folder, capsys, area):
    out = json.loads(run(capsys, "surface", "area.csv", "--json").out)
    rough = out["roughness"]
    flat = remove_form(area)
    assert rough["scans"][0]["Sq"] == pytest.approx(flat.z.std(), rel=1e-5)
    assert rough["scans"][0]["Sa"] == pytest.approx(np.abs(flat.z).mean(), rel=1e-5)
    assert rough["longest_wave"] == pytest.approx(1e-3)
    assert 0.9 * flat.z.std() < rough["h"] <= flat.z.std() * (1.0 + 1e-5)
    assert rough["stiffness_per_MPa"] == pytest.approx(1e6 / (0.45 * rough["h"]), rel=1e-12)
    short = json.loads(run(capsys, "surface", "area.csv", "--longest-wave", "2e-4", "--json").out)
    assert short["roughness"]["h"] < 0.6 * rough["h"]
    text = run(capsys, "surface", "area.csv").out
    assert f"Sq = {1e6 * flat.z.std():.4g} um, Sa = {1e6 * np.abs(flat.z).mean():.4g} um, h = " in text
    assert f"stiffness per area p/(0.45 h) = {1e6 / (0.45 * rough['h']):.3g} N/m3 per MPa" in text
    assert "Rq = " in run(capsys, "surface", "line.csv").out


def test_sides_are_written_where_they_belong(folder, capsys):
    """The other side of a default joint does not get the scan; a given file keeps its own surface there."""
    start = ["surface", "line.csv", "--joint=bolted_joint", "--law=zhao2018", "--out=s.toml", "--side"]
    h = json.loads(run(capsys, "surface", "line.csv", "--json").out)["roughness"]["h"]
    for side, names in (("1", ["Rq1"]), ("2", ["Rq2"]), ("both", ["Rq1", "Rq2"])):
        run(capsys, *start, side)
        assert load_parameter_file("s.toml").roughness == dict.fromkeys(names, h)
    run(capsys, *start, "2")
    said = run(capsys, "surface", "area.csv", "--params", "s.toml", "--side", "1", "--out", "t.toml")
    file = load_parameter_file("t.toml")
    assert file.roughness["Rq2"] == h
    assert set(file.roughness) == {"Rq1", "Rq2"}
    assert "surface.D, surface.G are values of side 1 alone" in said.err
    together = float(np.hypot(file.roughness["Rq1"], h))
    assert f"(h = {1e6 * together:.4g} um of both sides)" in said.out
    run(capsys, "surface", "line.csv", "line.csv", "--params", "s.toml", "--out", "p.toml")
    assert load_parameter_file("p.toml").roughness == {"Rq1": h, "Rq2": h}


def test_a_joint_by_its_roughness_gets_h_and_its_kin(folder, capsys):
    given = load_default("bolted_joint", "roughness")
    (folder / "r.toml").write_text(format_parameter_file(given))
    command = ["surface", "line.csv", "--params", "r.toml", "--side", "both", "--longest-wave", "5e-4"]
    out = json.loads(run(capsys, *command, "--out", "s.toml", "--json").out)
    file = load_parameter_file("s.toml")
    assert file.law == "roughness"
    assert file.roughness == dict.fromkeys(("Rq1", "Rq2"), out["roughness"]["scans"][0]["h"])
    assert file.values.h == pytest.approx(out["roughness"]["h"])
    assert file.values.h == pytest.approx(np.sqrt(2.0) * out["roughness"]["scans"][0]["h"])
    assert (file.values.longest_wave, file.values.slope) == (5e-4, out["roughness"]["slope"])
    assert file.values.hurst == pytest.approx(2.0 - 1.42, abs=0.03)
    assert file.values.H == given.values.H


def test_the_other_side_of_a_drawing_stays(folder, capsys):
    """h from a scan of side 1 and Ra 0.4 um of side 2; then from two scans, one after the other."""
    flanks = ["--width", "20", "--radii", "12", "30", "--load", "2000", "--material", "steel", "--Ra", "0.4"]
    run(capsys, "new", "gear-contact", *flanks, "--out", "g.toml")
    drawn = load_parameter_file("g.toml")
    assert (drawn.roughness, drawn.sources["roughness.Ra2"]) == (
        {"Ra1": pytest.approx(4e-7), "Ra2": pytest.approx(4e-7)},
        "Ra 0.4 um of the drawing",
    )
    said = run(capsys, "surface", "line.csv", "--side", "1", "--params", "g.toml", "--out", "s.toml")
    file = load_parameter_file("s.toml")
    assert set(file.roughness) == {"Rq1", "Ra2"}
    assert file.values.h == pytest.approx(np.hypot(file.roughness["Rq1"], RQ_OVER_RA * 4e-7), rel=1e-12)
    assert "slope, hurst are values of side 1 alone" in said.err
    assert f"(h = {1e6 * file.values.h:.4g} um of both sides)" in said.out
    run(capsys, "surface", "line.csv", "--side", "2", "--params", "s.toml", "--out", "t.toml")
    assert load_parameter_file("t.toml").values.h == pytest.approx(
        np.sqrt(2.0) * file.roughness["Rq1"], rel=1e-12
    )
    (folder / "h.toml").write_text(
        format_parameter_file(drawn.with_values({"h": 1e-6}, "user", "known together"))
    )
    line = refused_line(capsys, "surface", "line.csv", "--side", "1", "--params", "h.toml", "--out", "s.toml")
    assert "h.toml: states h = 1e-06 m of both sides together; state Ra2 or Rq2 of the other side" in line


@pytest.mark.parametrize("joint", [name for name, kind in KINDS.items() if kind.surfaces])
def test_the_scan_acts(folder, line, capsys, joint):
    """Without --law the joint has the law `roughness` with h of the scan; half the height gives twice K."""
    stiffness, heights = [], []
    for scale in (0.01, 0.005):
        (folder / "line.csv").write_text(csvfile.format_scan_csv(replace(line, z=scale * line.z)))
        words = ("surface", "line.csv", "--side=both", "--joint", joint, "--out=j.toml", "--json")
        found = json.loads(run(capsys, *words).out)
        file = load_parameter_file("j.toml", joint)
        assert (file.law, found["law"]) == ("roughness", "roughness")
        assert file.values_by_name["h"] == found["roughness"]["h"]
        heights.append(file.values_by_name["h"])
        law = KINDS[joint].extract_law(file.values)
        stiffness.append(float(evaluate_at_pressure(law, np.array([1e5]))["K_N"][0]))
    assert heights[0] == pytest.approx(2.0 * heights[1], rel=1e-6)  # of the file's seven digits
    # K ~ 1/h, a little less: the slope halves too, and less of the contact flows
    assert stiffness[1] / stiffness[0] == pytest.approx(2.0, rel=0.05)


def test_another_law_is_shown_beside_the_roughness(folder, capsys):
    words = ("surface", "line.csv", "--side=both", "--joint=bolted_joint", "--out=j.toml")
    said = run(capsys, *words, "--law=zhao2018").out
    assert load_parameter_file("j.toml").law == "zhao2018"
    assert re.search(r"^law zhao2018: .*p/\(0\.45 h\)", said, re.M)
    assert "law zhao2018" not in run(capsys, *words).out


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            ("--law", "yu2022", "--joint", "bolted_joint"),
            "bolted_joint has no law 'yu2022', allowed are zhao2018",
        ),
        (("--law", "yu2022"), "law yu2022 needs --joint"),
        (
            ("--law", "zhao2018", "--params", "j.toml"),
            "has law = 'roughness', not 'zhao2018'; leave the option out (--law)",
        ),
    ],
)
def test_laws_that_cannot_be(folder, capsys, options, says):
    run(capsys, "surface", "line.csv", "--side=both", "--joint=bolted_joint", "--out=j.toml")
    assert says in refused_line(capsys, "surface", "line.csv", *options)
