"""Text exports of instruments: matrices of heights with and without header, tables with further columns."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.inputs.surfaces import scan_text
from jointfmu_tools.inputs.surfaces.heights import ArealMap, Profile
from jointfmu_tools.inputs.surfaces.reading import read_heights

DATA = Path(__file__).parent / "data"
VR, VK = DATA / "keyence_vr_headerless_mm.csv", DATA / "keyence_vk_header.csv"
PROFILOMETER = DATA / "profilometer_counter_altitude.txt"
VR_OPTIONS = ("--unit", "mm", "--spacing", "10um", "--missing", "-99999.9999")


def test_matrix_without_header():
    found = read_heights(VR, "mm", point_spacing=(1e-5, 2e-5), missing_value=-99999.9999)
    cells = np.array([line.split(",") for line in VR.read_text().split()])
    missing = cells == "-99999.9999"
    assert isinstance(found, ArealMap)
    assert (found.dx, found.dy) == (1e-5, 2e-5)
    np.testing.assert_array_equal(np.isnan(found.z), missing)
    np.testing.assert_allclose(found.z[~missing], cells[~missing].astype(float) * 1e-3, rtol=1e-15)


def test_matrix_with_header_of_keyence():
    found = read_heights(VK)
    rows = [line for line in VK.read_text("latin-1").splitlines() if line.count(",") == 69]
    values = np.array([[float(cell.strip('"')) for cell in row.split(",")] for row in rows])
    assert isinstance(found, ArealMap)
    assert (found.dx, found.dy) == (pytest.approx(138.6e-9, rel=1e-12),) * 2
    np.testing.assert_allclose(found.z, values * 1e-6, rtol=1e-15)


def test_table_with_counter_and_encoders():
    found = read_heights(PROFILOMETER)
    altitude, encoder = np.loadtxt(PROFILOMETER, skiprows=1, usecols=(1, 2), unpack=True, encoding="utf-8")
    assert isinstance(found, Profile)
    assert found.dx == pytest.approx(5e-6, rel=1e-9)
    np.testing.assert_allclose(found.z, altitude * 1e-6, rtol=1e-15)
    assert found.side_lengths[0] - found.dx == pytest.approx(np.ptp(encoder) * 1e-6)


def test_table_with_two_moving_encoders_is_a_map(tmp_path):
    y, x = (index.ravel() for index in np.mgrid[:64, :70])
    z = np.random.default_rng(1).standard_normal(x.size)
    rows = [
        f"{i}\t{c:.6f}\t{2 * a}\t{3 * b}\t{b}"
        for i, (a, b, c) in enumerate(zip(x, y, z, strict=True))
    ]  # fmt: skip
    head = "Counter\tAltitude (nm)\tEncoder1 (µm)\tEncoder2 (µm)\tRow number"
    (tmp_path / "map.txt").write_text("\n".join([head, *rows]), encoding="utf-8")
    found = read_heights(tmp_path / "map.txt")
    assert (found.dx, found.dy) == (pytest.approx(2e-6), pytest.approx(3e-6))
    np.testing.assert_allclose(found.z.ravel(), z * 1e-9, atol=1e-15)


def test_one_column_of_heights_is_a_profile(tmp_path):
    z = np.random.default_rng(2).standard_normal(200)
    (tmp_path / "line.txt").write_text("\n".join(f"{value:.9f}" for value in z))
    found = read_heights(tmp_path / "line.txt", "um", point_spacing=(5e-7, 5e-7))
    assert isinstance(found, Profile)
    assert found.dx == 5e-7
    np.testing.assert_allclose(found.z, z * 1e-6, atol=1e-15)


@pytest.mark.parametrize("head", ["", "x [um], z [um]\n", "# profile: x [um], z [um]\n"])
def test_missing_value_of_columns(tmp_path, head):
    rows = [f"{x}, {-999 if x == 7 else 0.1 * (x % 5)}" for x in range(200)]
    (tmp_path / "line.csv").write_text(head + "\n".join(rows))
    found = read_heights(tmp_path / "line.csv", None if head else "um", missing_value=-999.0)
    assert list(np.flatnonzero(np.isnan(found.z))) == [7]


def test_text_with_comments_is_read_by_surfacetopography(tmp_path):
    z = np.random.default_rng(3).standard_normal((64, 80))
    head = "# Channel: Height\n# Width: 80 µm\n# Height: 64 µm\n# Value units: nm\n"
    rows = "\n".join("\t".join(f"{value:.6f}" for value in row) for row in z)
    (tmp_path / "gwyddion.txt").write_text(head + rows, encoding="utf-8")
    found = read_heights(tmp_path / "gwyddion.txt")
    assert (found.dx, found.dy) == (pytest.approx(1e-6), pytest.approx(1e-6))
    assert np.std(found.z) == pytest.approx(1e-9 * np.std(z), rel=1e-6)
    says = r"gwyddion\.txt: states its lateral size; leave the spacing out"
    with pytest.raises(ValueError, match=says):
        read_heights(tmp_path / "gwyddion.txt", point_spacing=(1e-6, 1e-6))


@pytest.mark.slow
def test_command_reads_a_matrix(capsys):
    assert cli.main(["surface", str(VR), *VR_OPTIONS, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["kind"] == "areal"
    (repair,) = found["repairs"]
    assert repair["count"] == VR.read_text().count("-99999.9999")
    assert 1e-6 < found["roughness"]["h"] < 3e-6


def new_joint(*words):
    """Command that makes a bolted joint with the scan VR as both faces."""
    plate = "--plate 80x40 --bolts 2xM10 --at 40x0 --grip 25 --sides rigid --material steel --preload 20e3"
    return ("new", "bolted-joint", *plate.split(), "--surface", str(VR), *words)


@pytest.mark.slow
def test_new_reads_a_matrix(tmp_path, capsys):
    out = tmp_path / "joint.toml"
    assert cli.main([*new_joint(*VR_OPTIONS), "--out", str(out), "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert cli.main(["surface", str(VR), *VR_OPTIONS, "--side", "both", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert made["parameters"]["h"] == pytest.approx(found["roughness"]["h"], rel=1e-9)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--unit", "mm"), "states no spacing of its points; state it, e.g. 5um (--spacing)"),
        (VR_OPTIONS[:4], "state the number that marks a missing point (--missing)"),
        ((*VR_OPTIONS[:4], "--missing", "none"), "--missing = 'none' is not a number; expected a number"),
    ],
)
def test_refusals_of_new(tmp_path, capsys, words, says):
    assert says in refused_line(capsys, *new_joint(*words), "--out", tmp_path / "joint.toml")


@pytest.mark.parametrize(
    ("file", "options", "says"),
    [
        (VR, (), f"{VR}: states no spacing of its points; state it, e.g. 5um (--spacing)"),
        (VR, VR_OPTIONS[2:], f"{VR}: states no length unit of its heights; state it, one of m, mm, um, nm"),
        (VR, VR_OPTIONS[:4], "148 heights are -99999.9999, all others -0.0064 to 0.0079; state the number"),
        (VR, (*VR_OPTIONS, "--unit-x", "um"), "has no columns x and y; leave out the unit um (--unit-x)"),
        (VK, ("--spacing", "1um"), "states its spacing 138.6 nm; leave the spacing out (--spacing)"),
        (VK, ("--unit", "um"), "states the unit µm of its heights; leave the unit out (--unit)"),
        (PROFILOMETER, ("--spacing", "5um"), "states the positions of its points; leave the spacing out"),
        (PROFILOMETER, ("--unit", "um"), "states its units; leave the unit um out (--unit)"),
        (VR, ("--spacing", "5"), "spacing '5' is not a length; expected a number and a unit, e.g. 5um"),
        (VR, ("--spacing", "5furlong"), "unit 'furlong' is not one of m, mm, um, nm (--spacing)"),
        (VR, ("--spacing", "0um"), "spacing '0um' is outside (0, inf) (--spacing)"),
        (VR, ("--spacing", *3 * ["1um"]), "3 spacings; expected one, or two (along x and y) (--spacing)"),
    ],
)
def test_refusals(capsys, file, options, says):
    assert says in refused_line(capsys, "surface", file, *options)


def test_table_without_a_column_of_heights(tmp_path, capsys):
    rows = "\n".join(f"{i}\t{i}\t{i}\t1" for i in range(200))
    (tmp_path / "t.txt").write_text("Counter\tEncoder1 (um)\tEncoder2 (um)\tRow\n" + rows)
    line = refused_line(capsys, "surface", tmp_path / "t.txt")
    assert (
        "its columns are Counter, Encoder1 (um), Encoder2 (um), Row; expected one column of heights" in line
    )


def test_messages_have_no_names_of_variables(tmp_path, monkeypatch):
    import SurfaceTopography

    def fail(path):
        raise RuntimeError("`height_scale` could not be extracted from file")

    monkeypatch.setattr(SurfaceTopography, "read_topography", fail)
    (tmp_path / "t.foo").write_bytes(bytes(1000))
    with pytest.raises(ValueError, match=r"can read \(its content does not match its format\)"):
        read_heights(tmp_path / "t.foo")


def test_spacing_of_both_axes():
    assert scan_text.parse_spacing(["5um"]) == (pytest.approx(5e-6),) * 2
    assert scan_text.parse_spacing(["5 um", "0,01mm"]) == (pytest.approx(5e-6), pytest.approx(1e-5))
