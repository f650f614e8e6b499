"""`jointfmu modes`: printed results, written files, refusals."""

import json

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.cli import main
from test_fem_contact_command import BOLTS, PLATE, PLATES, entries

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def plates(tmp_path_factory):
    path = tmp_path_factory.mktemp("assembly") / "plates.toml"
    path.write_text(PLATES.format(plate=entries(PLATE), bolts=entries(BOLTS)))
    return path


def ring(plates, capsys, *options):
    assert main(["modes", str(plates), "--preload", "5e3", "--refinement", "0.5", "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


@needs("gmsh")
def test_frequencies_rise_with_preload_and_fall_with_uneven_pressure(plates, capsys):
    found = ring(plates, capsys, "--count", "5")
    tighter = ring(plates, capsys, "--count", "5", "--preload", "1e4")
    f, g, even = (
        np.array([mode[key] for mode in one["modes"]])
        for one, key in ((found, "f"), (tighter, "f"), (found, "f_uniform_pressure"))
    )
    assert np.all(np.diff(f) > 0.0)
    assert np.all(g > f)
    # two plates held at their bolts open between them: an even pressure holds them better in the first mode
    assert even[0] > f[0]
    holes = 4 * np.pi / 4 * PLATE["thickness"] * 0.009**2
    mass = 2 * PLATE["density"] * (0.1 * 0.06 * PLATE["thickness"] - holes)
    assert found["mass"] == pytest.approx(mass, rel=5e-3)  # holes are polygons


@needs("gmsh")
def test_shapes_for_paraview(plates, capsys, tmp_path):
    import meshio

    path = tmp_path / "modes.vtu"
    found = ring(plates, capsys, "--count", "2", "--vtu", str(path))
    mesh = meshio.read(path)
    assert len(mesh.point_data) == 2
    corners = mesh.points[mesh.cells_dict["hexahedron"]]
    a, b, d, e = (corners[:, k] for k in (0, 1, 3, 4))
    assert np.all(np.einsum("ij,ij->i", np.cross(b - a, d - a), e - a) > 0.0)
    np.testing.assert_allclose(mesh.points[:, 2].min(), -PLATE["thickness"])
    np.testing.assert_allclose(mesh.points[:, 2].max(), PLATE["thickness"])
    for (name, moved), mode in zip(mesh.point_data.items(), found["modes"], strict=True):
        assert f"{mode['f']:.1f} Hz" in name
        assert np.linalg.norm(moved, axis=1).max() == pytest.approx(1.0)


@needs("gmsh")
def test_text(plates, capsys):
    assert main(["modes", str(plates), "--refinement", "0.5", "--count", "2"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("two plates: 9000 N per bolt")
    assert [line.split()[0] for line in lines[1:4]] == ["mode", "1", "2"]
    assert lines[4].startswith("stiffness by the law: ")  # the level beside the specimen's roughness
    assert len(lines) == 5


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--count", "0"], "--count = 0 is outside [1, 40]"),
        (["--refinement", "9"], "--refinement = 9 is outside [0.1, 4]"),
        (["--vtu", "shapes.png"], ".png is the suffix of another kind of file; expected .vtu"),
        (["--preload", "-1"], "preload = -1 N is outside (0, inf)"),
        (["--moment", "1e6"], "a row of bolts would lose its force"),
        (["--preload", "nan"], "preload = nan N is outside (0, inf)"),
    ],
)
def test_refusals(plates, capsys, options, text):
    assert main(["modes", str(plates), *options]) == 2
    error = capsys.readouterr().err
    assert text in error
    assert error.count("\n") == 1
