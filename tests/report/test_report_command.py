"""`jointfmu report`: the page states the behaviour of a user's joint and the sources of its numbers."""

import json
import re
from contextlib import chdir
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_fmu_src.native.page import find_load_ramp_panels, make_documentation
from jointfmu_fmu_src.proof.experiments import compute_reference_experiments
from jointfmu_tools import cli
from jointfmu_tools.common.pressure import judge_joint_stiffness
from jointfmu_tools.pages.report.joint import VALIDITY_HEADINGS, _describe_stiffness, write_joint_report
from jointfmu_tools.pages.report.load_history import LoadHistory
from surroundings import Enter

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import ParameterFile, format_parameter_file, load_default
from jointfmu.quantity import units

ROOT = Path(__file__).resolve().parents[2]
PLATES = ["--plate", "100x100", "--bolts", "4xM12", "--at", "60x60", "--grip", "20", "--sides", "rigid"]
LAWS = [(kind.name, law) for kind in KINDS.values() for law in kind.laws]


def written(folder: Path, file: ParameterFile, fmu: str | None = None) -> str:
    write_joint_report(folder / "page.html", file, fmu)
    return (folder / "page.html").read_text(encoding="utf-8")


def figures(page: str) -> list[list[dict]]:
    """Data of the panels of each figure of a report."""
    return [json.loads(text) for text in re.findall(r'<script type="application/json">(.*?)</script>', page)]


@pytest.mark.slow
@pytest.mark.parametrize(("joint", "law"), LAWS)
def test_the_page_of_every_law_says_each_number_and_its_source(joint: str, law: str, tmp_path: Path) -> None:
    file = load_default(joint, law)
    page = unescape(written(tmp_path, file))
    for name in file.values_by_name:
        (row,) = re.findall(rf"<tr><td><code>{re.escape(name)}</code></td>(.*?)</tr>", page)
        assert f"<td>{file.origins.get(name, 'default')}</td>" in row, name
        span = f"{file.ranges[name][0]:g} to {file.ranges[name][1]:g}; " if name in file.ranges else ""
        assert f">{span}{file.sources.get(name, 'default choice')}</td>" in row, name
    for line in judge_joint_stiffness(file).format_lines():
        assert line in page
    (opening,) = re.findall(r"<main[^>]*>\s*<p>(.*?)</p>", page)
    assert KINDS[joint].title in opening
    assert re.search(r"The stiffness \w+ (rises|falls|is) .*\d", opening)
    # one file: nothing is fetched
    assert not re.search(r"<link|<script[^>]*\bsrc=|<img[^>]*\bsrc=(?!\"data:)|@import|url\(", page)


def test_titles_are_words_and_nothing_unknown_or_zero_is_drawn(tmp_path: Path) -> None:
    """A catalogue drive has no K_TS, and no loops without hysteresis; stiffnesses have the prefix kilo."""
    page = written(tmp_path, load_default("harmonic_drive", "catalogue"))
    titles = [panel["title"] for panels in figures(page) for panel in panels]
    assert titles[:2] == ["Output torque over wind-up at the output", "Tangent stiffness over output torque"]
    names = {series["name"] for panels in figures(page) for panel in panels for series in panel["series"]}
    assert "K_TS" not in names
    assert "<h2>Loops</h2>" not in page
    plate = unescape(written(tmp_path, load_default("bolted_joint")))
    assert "kN/µm" in plate
    assert "e+04" not in plate
    assert "e+05" not in plate


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_curves_are_those_of_the_spring(name: str, tmp_path: Path) -> None:
    model, file = MODELS[name], load_default(MODELS[name].joint)
    drawn = figures(written(tmp_path, file, name))[0]
    spring = model.tabulate(file.values)
    rest = {v.name: file.start_value(v.name) for v in model.inputs}
    variables = {v.name: v for v in (*model.inputs, *model.outputs)}
    ramp = model.with_load_range(spring, rest).ramp.sample_inputs(101)
    for panel, (over, names) in zip(drawn, find_load_ramp_panels(model), strict=True):
        shown = panel["y"].rpartition("[")[2].rstrip("]").replace("µ", "u").replace(" ", ".")
        factor = units.conversion_factor(variables[names[0]].unit, shown)
        for series in panel["series"]:
            for i in (0, 50, 100):
                inputs = {**rest, model.ramp.input_name: float(ramp[i])}
                value = float(model.evaluate(spring, inputs)[series["name"]])
                # the page has seven digits
                assert series["y"][i] == pytest.approx(factor * value, rel=1e-6), (over, i)


def test_kinds_of_sources_are_what_they_are(tmp_path, enter):
    """A file from a catalogue name has no number of the user; moduli from a standard are not from a paper."""
    enter(chdir(tmp_path))
    drive = ["new", "harmonic-drive", "--catalogue", "CSG-25-100", "--out", "drive.toml"]
    plates = [
        "--plate",
        "100x100",
        "--bolts",
        "4xM12",
        "--at",
        "60x60",
        "--grip",
        "20",
        "--material",
        "steel",
    ]
    bolts = ["new", "bolted-joint", *plates, "--finish", "milled", "--sides", "rigid", "--out", "joint.toml"]
    for command in (drive, bolts, ["report", "drive.toml"], ["report", "joint.toml"]):
        assert cli.main(command) == 0
    drive_page, joint_page = (
        Path(f"{name}.html").read_text(encoding="utf-8").partition("Where each number comes from")[2]
        for name in ("drive", "joint")
    )
    assert "<em>user</em>" not in drive_page
    assert "<em>default</em>, not stated, the default of the package: 18" in drive_page
    assert "<em>catalogue</em>" in drive_page
    assert "<em>standard</em>, a value of a standard: " in joint_page
    assert "<em>paper</em>" not in joint_page


def test_what_the_user_changed_is_there_with_his_words(
    tmp_path: Path, enter: Enter, capsys: pytest.CaptureFixture[str]
) -> None:
    enter(chdir(tmp_path))
    file = load_default("gear_contact")
    name = next(n for n, value in file.values_by_name.items() if isinstance(value, float) and value > 0.0)
    words = 'drawing 4711, <b>rev.</b> C & "all"'
    Path("mine.toml").write_text(
        format_parameter_file(file.with_values({name: file.values_by_name[name]}, "user", words))
    )
    assert cli.main(["report", "mine.toml", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"report": "mine.html"}
    page = Path("mine.html").read_text(encoding="utf-8")
    assert "drawing 4711, &lt;b&gt;rev.&lt;/b&gt; C &amp; &#34;all&#34;" in page
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.html", "mine.toml"]


@pytest.mark.parametrize("name", [name for name, model in MODELS.items() if model.load_cycle])
def test_loops_lose_what_the_joint_says_it_lost(name: str) -> None:
    model = MODELS[name]
    own = {n: v for n, v in model.load_cycle.variable_values.items() if n in model.parameter_fields()}
    file = load_default(model.joint).with_values(own, "user", "with memory")
    loops = LoadHistory(model, file).compute_loops()
    for row in loops.compute_quantities_of_loops():
        # trapezoids over 80 points of a cycle, a branch of which is about a parabola: 1/40^2 of it
        assert row["loss"] == pytest.approx(row["E_loss"], rel=2e-2)
        assert row["loss"] > 0.0


CATALOGUE = load_default("harmonic_drive", "catalogue")
FAR = [
    ("GearMesh", load_default("gear_mesh").with_values({"backlash": 2e-3}, "user", "loose"), "K", 0.9),
    ("HarmonicDriveSpring", CATALOGUE, "K_WTS", CATALOGUE.values_by_name["K3"]),
    ("HarmonicDriveCompliance", CATALOGUE, "K_WTS", CATALOGUE.values_by_name["K3"]),
]


@pytest.mark.parametrize(("name", "file", "stiffness", "least"), FAR, ids=[name for name, *_ in FAR])
def test_the_ramp_reaches_where_the_joint_is_loaded(
    name: str, file: ParameterFile, stiffness: str, least: float
) -> None:
    """Report, page and proof show a mesh beyond its backlash, and the last line of a catalogue."""
    model = MODELS[name].with_parameters(file.joint, file.values)
    course = LoadHistory(model, file)
    columns = course.compute_ramp()
    if name == "GearMesh":
        assert np.count_nonzero(columns["f"]) >= columns["f"].size - 1
        least *= file.values_by_name["contact_ratio"] // 1.0 * file.values_by_name["K_tooth"]
    else:
        assert columns["tau"][-1] == pytest.approx(file.values_by_name["max_torque"], rel=1e-9)
    assert columns[stiffness][-1] >= least * (1.0 - 1e-9)
    stem = {"GearMesh": "phi1", "HarmonicDriveSpring": "phi2"}.get(name, "tau")
    said = f"<code>{stem}</code> from 0 to {course.model.ramp.end_value:.6g} "
    assert said in make_documentation(model, file)["index.html"].decode()
    ramp = next(
        one for one in compute_reference_experiments(model, file) if one.experiment_name == "load ramp"
    )
    assert ramp.input_stimulus.input_levels[-1] == pytest.approx(course.model.ramp.end_value, rel=1e-8)
    assert ramp.reference_results.columns[stiffness][-1] == pytest.approx(columns[stiffness][-1], rel=1e-6)
    assert np.all(ramp.reference_results.columns[stiffness][1:] > 0.0)


def test_a_stiffness_that_settles_is_said_to() -> None:
    """The last line of a catalogue begins at T2, after a rounded corner; the ramp ends beyond."""
    model = MODELS["HarmonicDriveCompliance"].with_parameters(CATALOGUE.joint, CATALOGUE.values)
    text = _describe_stiffness(LoadHistory(model, CATALOGUE))
    load = float(re.search(r"at tau = ([\d.]+) N m, by", text)[1])
    assert 1.0 < load / CATALOGUE.values_by_name["T2"] < 1.2
    assert "less than 1 %" in text


def test_what_is_said_of_the_end_of_the_law_is_so_there() -> None:
    for name, model in MODELS.items():
        course = LoadHistory(model, load_default(model.joint))
        assert course.model.ramp.end_value > course.start_values[model.ramp.input_name], name
        if course.law_limit:
            value, text = course.law_limit
            inputs = {**course.start_values, model.ramp.input_name: value}
            outputs = model.evaluate(course.tabulated_joint, inputs)
            assert text in model.find_warnings(course.tabulated_joint, {**inputs, **outputs}).values()
            below = {**course.start_values, model.ramp.input_name: 0.99 * value}
            assert text.split("=")[0] not in "".join(
                model.find_warnings(
                    course.tabulated_joint, {**below, **model.evaluate(course.tabulated_joint, below)}
                ).values()
            )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("absent.toml",), "absent.toml: cannot be read"),
        (("broken.toml",), "broken.toml: joint = 'nothing', allowed are"),
        (("good.toml", "--fmu", "Nothing"), "fmu = 'Nothing' is not a model of a"),
        (("good.toml", "--out", "good.toml"), "good.toml: is also an input of this command"),
        (("good.toml", "--out", "page.txt"), "allowed is .html"),
        (("good.toml", "--out", "folder.html"), "is a folder"),
    ],
)
def test_what_makes_no_page_is_one_line(
    words: tuple[str, ...],
    said: str,
    tmp_path: Path,
    enter: Enter,
    capsys: pytest.CaptureFixture[str],
) -> None:
    enter(chdir(tmp_path))
    Path("good.toml").write_text(format_parameter_file(load_default(next(iter(KINDS)))))
    Path("broken.toml").write_text('schema = 1\njoint = "nothing"\n')
    Path("folder.html").mkdir()
    before = {path.name: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()}
    assert said in refused_line(capsys, "report", *words)
    assert {path.name: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()} == before


def test_topics_are_headings_of_the_pages_on_validity() -> None:
    for page, headings in VALIDITY_HEADINGS.items():
        text = (ROOT / page).read_text(encoding="utf-8")
        for heading in headings:
            assert f"\n## {heading}\n" in text


@pytest.mark.parametrize(
    ("stated", "limit"),
    [
        ([], "81.7 kN, the proof load of M12, class 12.9"),
        (["--property-class", "8.8"], "48.9 kN, the proof load of M12-8.8 (ISO 898-1)"),
    ],
)
def test_the_lesser_of_the_limits_of_law_and_bolts_is_said(tmp_path, enter, stated, limit):
    """The range of the law ends far above the load that an M12 bears. ISO 898-1: class 8.8 has 580 MPa on
    84.3 mm2."""
    enter(chdir(tmp_path))
    faces = ["--material", "steel", "--finish", "milled"]
    assert cli.main(["new", "bolted-joint", *PLATES, *faces, *stated, "--out", "joint.toml"]) == 0
    assert cli.main(["report", "joint.toml"]) == 0
    (said,) = re.findall(r"Range of the law\.</b> (.*?)</li>", Path("joint.html").read_text(encoding="utf-8"))
    assert said.startswith(f"Use it up to preload = {limit}")
