"""A parameter file opened in the laboratory: the page shows the joint of this file, or refuses the file.

What is accepted has the numbers of the package and, bit for bit, those of the module in another runtime. What
is refused leaves everything that was shown.
"""

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Browser, browser
from clients import needs
from conftest import made_once
from joint_cases import CASES, law
from jointfmu_fmu_src.native.data import split_parameters
from jointfmu_tools import cli
from jointfmu_tools.pages.laboratory.assemble import write_laboratory
from jointfmu_tools.pages.laboratory.describe import PageModule, list_modules
from natives import close
from webassembly import Instance, random_values

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

pytestmark = pytest.mark.slow
needed = needs("Chromium")

EVERY = list_modules()
FOLDER = KINDS["bolted_joint"].default_file().parents[1]
FOLDERS = (*KINDS, "catalogue")
"""Folders with parameter files of joints."""
SHIPPED = {path.stem: path for name in FOLDERS for path in sorted((FOLDER / name).glob("*.toml"))}
FOREIGN = sorted(path for path in FOLDER.glob("*/*.toml") if path.parent.name not in FOLDERS)
OTHER_MODEL = {"bolted_joint": "GearMesh"}
"""{joint: a model of another joint}; the bolted joint's for joints without an entry."""
COMPILED, ROUND_OFF = 1e-9, 1e-12
"""Difference between two mathematical libraries in tables; round-off of cancelling terms over the nominal
value [1]."""
STEPS = 120
"""Number of steps of the ramps that the page shows."""
STEEL = ("--material", "steel", "--Ra", "0.8")
PLATE = ("bolted-joint", "--plate", "80x80", "--bolts", "4xM8", "--at", "50x50", "--grip", "20", *STEEL)
DRAWINGS = {
    "whole_joint": PLATE,
    "interface": (*PLATE, "--sides", "rigid"),
    "contact": ("gear-contact", "--width", "20", "--radii", "12", "30", "--load", "2000", *STEEL),
    "mesh": ("gear-mesh", "--module", "4", "--teeth", "29", "45", "--width", "20", "--torque", "150", *STEEL),
    "drive": ("harmonic-drive", "--catalogue", "CSG-17-100"),
}
"""{name: words of `jointfmu new`}."""
BOUND = {"A_0", "n_bolts", "row_bolts", "row_distance"}
"""Parameters of the bolted joint that follow from the bolt positions; the page has fixed values for them."""


def entry(name: str, value: object, unit: str = "1") -> str:
    """Line of a parameter file."""
    return f'{name} = {{ value = {value}, unit = "{unit}", kind = "user", source = "x" }}\n'


def roughness(Ra: float) -> str:
    """Section `roughness` of a parameter file, without the height of both sides together."""
    return "\n[roughness]\n" + entry("Ra1", Ra, "m") + entry("Ra2", Ra, "m")


def with_entry(text: str, name: str, value: object, unit: str = "1") -> str:
    """Text of a parameter file with another value of a parameter at the top."""
    found, count = re.subn(rf"(?m)^{name} = .*\n", entry(name, value, unit), text)
    assert count == 1
    return found


def with_text(text: str, old: str, new: str) -> str:
    """Text of a parameter file with one passage replaced; the passage must exist."""
    assert old in text
    return text.replace(old, new, 1)


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = made_once(tmp_path_factory, "page", lambda out: write_laboratory(out / "laboratory.html"))
    with browser() as one:
        one.shape(1400, 1000)
        one.open(folder / "laboratory.html")
        one.run("laboratory.then(() => true)")
        yield one


@pytest.fixture(scope="session")
def drawings(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Texts of the files that `jointfmu new` writes: {name: text}."""

    def write(folder: Path) -> None:
        folder.mkdir()
        for name, words in DRAWINGS.items():
            assert cli.main(["new", *words, "--out", str(folder / f"{name}.toml")]) == 0

    folder = made_once(tmp_path_factory, "drawings", write)
    return {name: (folder / f"{name}.toml").read_text(encoding="utf-8") for name in DRAWINGS}


def choose(shown: Browser, model: str, index: int = 0) -> None:
    shown.run(f"laboratory.then((lab) => lab.choose({json.dumps(model)}, {index}))")


_OPEN = """(async () => {
  const lab = await laboratory, done = document.getElementById("done");
  const fields = () => [...document.querySelectorAll("input, select")].map((e) => [e.value, e.checked]);
  const texts = () => [document.querySelector("main").innerHTML, document.getElementById("doc").textContent];
  const joint = () => [[...lab.values], lab.set.name, lab.about.name, lab.about.law];
  const drawn = () => JSON.stringify([texts(), fields(), joint()]);
  const frames = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  await frames(); // a drawing that was asked for before
  lab.draw();
  clearTimeout(lab.rest); // what the page draws later must not come between the two pictures
  const before = drawn();
  await lab.read(new File([TEXT], "mine.toml"));
  await frames();
  const kept = drawn() === before, refused = done.classList.contains("error");
  lab.draw();
  return { said: done.textContent, refused, kept, again: drawn() === before };
})()"""


def drop(shown: Browser, text: str) -> dict[str, Any]:
    """Open a file as a user does: message of the page, and whether the page shows what it showed before."""
    found: dict[str, Any] = shown.run(_OPEN.replace("TEXT", json.dumps(text)))
    return found


def refusal(shown: Browser, text: str) -> str:
    """Message with which the page refuses a file. Asserts that the page keeps the joint that it showed
    before."""
    found = drop(shown, text)
    assert found["refused"], found["said"]
    assert found["kept"]
    assert found["again"]
    assert "\n" not in found["said"]
    return str(found["said"])


_STATE = """laboratory.then((lab) => {
  const set = document.getElementById("set").selectedOptions[0], doc = document.getElementById("doc");
  const controls = Object.entries(lab.controls).map(([name, c]) => [name, c.value ?? c.box.checked]);
  const last = ({ factor }, numbers) => numbers.at(-1) / factor;
  const curve = ({ over, chart }, v, k) =>
    [v.name, last(v, chart.series[k].y), over.name, last(over, chart.series[k].x)];
  return {
    model: lab.about.name, law: lab.about.law, values: Object.fromEntries(lab.values), now: lab.now,
    names: [lab.set.name, set.textContent, doc.textContent.split(". ")[0]],
    controls: Object.fromEntries(controls),
    ramp: [lab.about.ramp.input, lab.end],
    curves: lab.curves.panels.flatMap((panel) => panel.quantities.map((v, k) => curve(panel, v, k))),
    marks: lab.map ? lab.map.rowsShown : [],
  };
})"""


def check_shown(shown: Browser, text: str, folder: Path) -> None:
    """Assert that the page shows the joint of a file: values, outputs at the sliders, end of the ramp,
    pressure map."""
    file = load_parameter_file(write(folder / "mine.toml", text))
    found = drop(shown, text)
    assert not found["refused"], found["said"]
    assert found["said"] == f"mine.toml: {file.name} shown."
    state = shown.run(_STATE)
    model = MODELS[state["model"]]
    assert (model.joint, state["law"]) == (file.joint, file.law)
    assert state["names"] == [file.name] * 3
    exposed = {
        name: file.values_by_name[name]
        for name in model.with_parameters(file.joint, file.values).parameter_fields()
    }
    assert {name: state["values"][name] for name in exposed} == exposed
    assert state["controls"] == {name: state["values"][name] for name in state["controls"]}
    inputs = {v.name: state["values"][v.name] for v in model.inputs}
    own = {
        name: file.start_value(name) for name in inputs if file.start_value(name) or name != state["ramp"][0]
    }
    assert {name: inputs[name] for name in own} == own
    outputs = {v.name: state["now"][v.name] for v in model.outputs}
    expected = law(state["model"], file.values)(inputs)
    for v in model.outputs:
        near = pytest.approx(expected[v.name], rel=COMPILED, abs=ROUND_OFF * v.nominal)
        assert outputs[v.name] == near, v.name
    module = next(m for m in EVERY if (m.fmu_model.name, m.parameter_files[0].law) == (model.name, file.law))
    instance = Instance(module, module.compile_module(), file)
    assert instance.start(exposed | inputs)
    assert instance.get() == outputs
    if state["marks"]:
        assert np.array_equal(instance.map(), state["marks"])
    driven, end = state["ramp"]
    assert instance.start(exposed | inputs | {driven: 0.0})
    for i in range(1, STEPS + 1):
        instance.set({driven: end * i / STEPS})
        assert instance.step()
    last = instance.get() | {driven: end}
    for name, y, over, x in state["curves"]:
        assert (x, y) == (close(last[over], COMPILED), close(last[name], COMPILED)), name


def write(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


@needed
@pytest.mark.parametrize("stem", SHIPPED)
def test_a_shipped_file_is_shown_whatever_was_shown_before(shown: Browser, stem: str, tmp_path: Path) -> None:
    choose(shown, OTHER_MODEL.get(load_parameter_file(SHIPPED[stem]).joint, "BoltedJoint"))
    check_shown(shown, SHIPPED[stem].read_text(encoding="utf-8"), tmp_path)


@needed
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("module", EVERY, ids=lambda m: f"{m.fmu_model.name}, {m.parameter_files[0].law}")
def test_a_file_with_other_numbers_is_shown(
    shown: Browser, module: PageModule, seed: int, tmp_path: Path
) -> None:
    """Files with all numbers that the page can change, start values of inputs included."""
    rng = np.random.default_rng(seed)
    choose(shown, module.fmu_model.name)
    drawn = random_values(module, rng, False)
    drawn |= {name: module.parameter_files[0].values_by_name[name] for name in BOUND & drawn.keys()}
    changed = module.parameter_files[0].with_values(drawn, "user", "at random")
    inputs = CASES[module.fmu_model.name].numbers.state if seed else {}
    check_shown(shown, format_parameter_file(replace(changed, name=f"other {seed}", inputs=inputs)), tmp_path)


@needs("Chromium", "gmsh")
@pytest.mark.parametrize("name", ["contact", "mesh", "drive"])
def test_what_new_writes_without_lists_is_shown(
    shown: Browser, drawings: dict[str, str], name: str, tmp_path: Path
) -> None:
    check_shown(shown, drawings[name], tmp_path)


@needed
def test_a_file_is_read_however_it_is_written(shown: Browser, tmp_path: Path) -> None:
    """A file is read without the law, with integers, in tables and dotted keys, with comments and other line
    ends."""
    choose(shown, "HarmonicDriveSpring", 3)
    text = format_parameter_file(load_default("harmonic_drive"))
    check_shown(shown, re.sub(r"(?m)^law = .*\n", "", text), tmp_path)
    text = format_parameter_file(
        load_default("bolted_joint").with_values({"surface.D": 1.45, "H": 2e9}, "user", "x")
    )
    odd = with_entry(text, "H", "2_000_000_000 ", "Pa")
    odd = re.sub(r"(?m)^(D|G) = ", r"'\1' = ", odd)
    gamma = r'(?m)^gamma = \{ value = (\S+), unit = "1", kind = "(\w+)", source = (".*") \}$'
    dotted = r"""gamma.value = \1 # a comment, "with" { signs
gamma.unit = "1"
gamma.kind = "\2"
gamma.source = \3"""
    odd, count = re.subn(gamma, dotted, odd)
    assert count == 1
    check_shown(shown, "\ufeff" + odd.replace("\n", "\r\n"), tmp_path)


@needed
def test_roughnesses_make_the_height_of_the_law(shown: Browser, tmp_path: Path) -> None:
    text = format_parameter_file(load_default("gear_contact", "roughness"))
    alone = re.sub(r"(?m)^h = .*\n", "", text) + roughness(0.7e-6)
    check_shown(shown, alone, tmp_path)
    said = refusal(shown, text + roughness(3e-6))
    assert re.search(r"h = \S+ m does not agree with roughness.Ra1, roughness.Ra2, which give ", said)
    assert "roughness.Rq1 with roughness.Ra1" in refusal(shown, alone + entry("Rq1", 1e-6, "m"))


@needs("Chromium", "gmsh")
@pytest.mark.parametrize(
    ("name", "key"), [("whole_joint", 'sides = "elastic"'), ("interface", "plate.length = 0.08 m")]
)
def test_a_bolted_joint_of_a_drawing_is_refused(
    shown: Browser, drawings: dict[str, str], name: str, key: str
) -> None:
    """A complete joint and its interface are refused: their contact points are not those of the page."""
    for model, index in (("BoltedJoint", 0), ("BoltedJoint", 1), ("GearContact", 0)):
        choose(shown, model, index)
        said = refusal(shown, drawings[name])
        assert key in said
        assert said.endswith("jointfmu report mine.toml")


BOX = format_parameter_file(load_default("bolted_joint"))
DRIVE = format_parameter_file(load_default("harmonic_drive"))


def field_text() -> str:
    """Text of the shipped bolted joint with a field of nodal pressures instead of its pattern."""
    head, _, rest = BOX.partition("[pattern]\n")
    rows = {"share": [0.5, 0.5], "x": [-0.1, 0.1], "y": [0.0, 0.0], "equal": [1.0, 1.0], "tilt": [0.0, 0.0]}
    lines = "".join(entry(name, row, "m" if name in "xy" else "1") for name, row in rows.items())
    return f"{head}[field]\n{lines}\n[comparison]" + rest.partition("[comparison]")[2]


OTHERS = {
    "a field of pressures": (field_text(), "field.share = [0.5, 0.5] (2 numbers)"),
    "a midline": (
        with_text(
            format_parameter_file(load_default("harmonic_drive", "table")), "5.25443e-05", "5.35443e-05"
        ),
        "table.angle = [0.0000535443, 0.000101494, 0.000168896, ...] (19 numbers)",
    ),
    "a choice": (with_text(BOX, 'value = "family"', 'value = "hertz"'), 'spot_stiffness = "hertz"'),
    "places of bolts": (
        BOX.replace("row_spacing = { value = 0.3", "row_spacing = { value = 0.31").replace(
            "row_distance = { value = 0.3", "row_distance = { value = 0.31"
        ),
        "row_spacing = 0.31 m",
    ),
    "the area": (with_entry(BOX, "A_0", "0.0381", "m2"), "A_0 = 0.0381 m2"),
}
"""Joints that the page does not have: {case: (text, expected part of the refusal)}."""


@needed
@pytest.mark.parametrize("what", OTHERS)
def test_a_joint_that_the_page_does_not_have_is_refused(shown: Browser, what: str) -> None:
    text, named = OTHERS[what]
    choose(shown, "GearMesh")
    said = refusal(shown, text)
    assert named in said
    assert said.endswith("jointfmu report mine.toml")


FAULTS = {
    "an unknown name": (f"{BOX}\n[more]\n" + entry("thing", 1.5), "more.thing = 1.5, which"),
    "an unknown key": (with_text(BOX, 'kind = "paper"', 'spread = 0.1, kind = "paper"'), "spread"),
    "another unit": (with_entry(BOX, "H", "1960.0", "MPa"), 'H: unit "MPa", expected "Pa"'),
    "a missing number": (re.sub(r"(?m)^H = .*\n", "", BOX), "H is missing"),
    "text for a number": (with_entry(BOX, "H", '"hard"', "Pa"), 'H = "hard"'),
    "a list for a number": (with_entry(BOX, "H", "[1.0, 2.0]", "Pa"), "H = [1, 2] (2 numbers)"),
    "yes for a number": (with_entry(BOX, "H", "true", "Pa"), "H = true"),
    "a number for yes": (with_text(BOX, "plastic_damping = { value = false", "plastic_damping = { value = 0"),
                         "plastic_damping = 0"),
    "no number": (with_entry(BOX, "H", "nan", "Pa"), "H = NaN Pa"),
    "a number outside": (with_entry(BOX, "mu", "-0.1"), "mu = -0.1"),
    "a number that another forbids": (with_text(BOX, "value = 1.42", "value = 2.5"), "surface.D = 2.5"),
    "half a bolt": (with_entry(BOX, "n_bolts", "7.5"), "n_bolts = 7.5"),
    "a start value outside": (with_text(BOX, "preload = { value = 0", "preload = { value = -1"), "-1 N"),
    "an unknown input": (with_text(BOX, "moment = {", "moments = {"), "inputs.moments = 0"),
    "a fixed number outside": (with_entry(DRIVE, "max_torque", "-3.0", "N.m"), "max_torque = -3"),
    "a kind that is none": (with_text(BOX, 'kind = "paper"', 'kind = "guess"'), 'kind = "guess"'),
    "a value twice": (with_text(BOX, "\n[surface]", "\nH = { value = 1e9 }\n[surface]"), "expected H once"),
    "another schema": (with_text(BOX, "schema = 1", "schema = 2"), "schema = 2"),
    "another law": (with_text(BOX, 'law = "zhao2018"', 'law = "hertz"'), 'law = "hertz"'),
    "another joint": (with_text(BOX, 'joint = "bolted_joint"', 'joint = "hinge"'), 'joint = "hinge"'),
    "no TOML": (with_text(BOX, "[side1]", "[side1"), "line "),
    "a table in a list": (f"{BOX}\n[[more]]\na = 1\n", "line "),
    "nothing": ("", "schema is missing"),
}  # fmt: skip
"""Files that no command accepts: {case: (text, expected part of the refusal)}."""


@needed
@pytest.mark.parametrize("what", FAULTS)
def test_a_faulty_file_is_refused(shown: Browser, what: str, tmp_path: Path) -> None:
    text, named = FAULTS[what]
    path = write(tmp_path / "mine.toml", text)
    with pytest.raises(ValueError, match=re.escape(str(path))):
        load_parameter_file(path)
    choose(shown, "BoltedJoint")
    assert named in refusal(shown, text)


@needed
@pytest.mark.parametrize("path", FOREIGN, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_file_of_another_kind_is_refused(shown: Browser, path: Path) -> None:
    assert refusal(shown, path.read_text(encoding="utf-8")), "the page says nothing"


def reopen(shown: Browser, address: str) -> None:
    shown.call("Page.navigate", url="about:blank")
    shown.call("Page.navigate", url=address)
    while not shown.run("document.readyState === 'complete' && typeof laboratory !== 'undefined'"):
        pass
    shown.run("laboratory.then(() => true)")


@needs("Chromium", "gmsh")
@pytest.mark.parametrize("name", ["contact", "drive"])
def test_the_address_of_an_opened_file_leads_to_its_numbers(
    shown: Browser, drawings: dict[str, str], name: str
) -> None:
    drop(shown, drawings[name])
    state = (
        "laboratory.then((lab) => (lab.draw(), [lab.about.name, Object.fromEntries(lab.values), lab.now]))"
    )
    before, where = shown.run(state), shown.run("laboratory.then((lab) => (lab.keep(), location.href))")
    reopen(shown, where)
    assert shown.run(state) == before


@needed
def test_an_address_of_another_page_is_said_and_not_mixed_in(shown: Browser) -> None:
    text = with_entry(BOX, "H", "2.2e9", "Pa")
    drop(shown, text)
    where = shown.run("laboratory.then((lab) => (lab.keep(), location.href))")
    assert "H=2200000000" in where
    reopen(shown, where.replace("set=box", "set=fox"))
    assert (
        shown.run("laboratory.then((lab) => lab.values.get('H'))")
        == load_default("bolted_joint").values_by_name["H"]
    )
    assert "fox" in shown.run("document.getElementById('done').textContent")


@needs("Chromium", "gmsh")
def test_an_opened_file_is_reset_and_saved(shown: Browser, drawings: dict[str, str], tmp_path: Path) -> None:
    """The reset returns to this file; a saved file is this file with the changed values."""
    drop(shown, drawings["contact"])
    first = load_parameter_file(write(tmp_path / "first.toml", drawings["contact"]))
    text, back = shown.run("""laboratory.then((lab) => {
      lab.controls.h.moved(2 * lab.values.get("h"));
      const text = lab.toml();
      lab.take(lab.set);
      return [text, lab.toml()];
    })""")
    again = load_parameter_file(write(tmp_path / "back.toml", back))
    moved = load_parameter_file(write(tmp_path / "moved.toml", text))
    assert replace(again, inputs=first.inputs, origins=first.origins, sources=first.sources) == first
    assert "user" not in {kind for name, kind in again.origins.items() if name not in first.origins}
    assert "set in the laboratory" not in again.sources.values()
    assert moved.values_by_name == first.values_by_name | {"h": 2.0 * first.values_by_name["h"]}
    assert moved.roughness == {}  # the height stands in their place


@pytest.mark.parametrize("module", EVERY, ids=lambda m: f"{m.fmu_model.name}, {m.parameter_files[0].law}")
def test_a_number_beside_the_code_enters_the_data_as_itself_alone(module: PageModule) -> None:
    """The page may set a number that is not compiled: it changes its own value in the data only."""
    file = module.parameter_files[0]
    if "friction_1" in file.values_by_name:  # its upper limit is friction_coulomb
        file = file.with_values({"friction_coulomb": 0.1}, "user", "x")
    given = split_parameters(module.fmu_model, file)
    for name in given.data_struct_values.keys() & file.values_by_name.keys():
        value = 0.9 * file.values_by_name[name] or 1e-6
        other = split_parameters(module.fmu_model, file.with_values({name: value}, "user", "x"))
        assert other.data_struct_values == given.data_struct_values | {name: value}
        assert other.code_generation_values == given.code_generation_values
        assert {k: t.table_rows.tolist() for k, t in other.data_tables.items()} == {
            k: t.table_rows.tolist() for k, t in given.data_tables.items()
        }
