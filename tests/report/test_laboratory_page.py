"""Laboratory page: self-contained, small, labelled, usable by keyboard and on a phone; opening and saving
files."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Browser, browser
from clients import needs
from conftest import made_once
from joint_cases import JOINTS
from jointfmu_tools import cli
from jointfmu_tools.pages.laboratory.assemble import write_laboratory
from jointfmu_tools.pages.laboratory.describe import list_modules

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

pytestmark = pytest.mark.slow

needed = needs("Chromium")
LARGEST = 1.5e6
"""Size limit of the page [bytes]."""
PHONE, DESKTOP = (390, 800), (1400, 1000)


@pytest.fixture(scope="session")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = made_once(tmp_path_factory, "page", lambda out: write_laboratory(out / "laboratory.html"))
    return folder / "laboratory.html"


@pytest.fixture(scope="module")
def shown(page: Path) -> Iterator[Browser]:
    with browser() as one:
        one.shape(*DESKTOP)
        one.open(page)
        one.run("laboratory.then(() => true)")
        yield one


def choose(shown: Browser, model: str, index: int = 0) -> None:
    shown.run(f"laboratory.then((lab) => lab.choose({json.dumps(model)}, {index}))")


def drop(shown: Browser, name: str, text: str) -> str:
    """Open a file as a user does: message of the page."""
    script = f"""(async () => {{
      const lab = await laboratory;
      await lab.read(new File([{json.dumps(text)}], {json.dumps(name)}));
      lab.draw();
      return document.getElementById("done").textContent;
    }})()"""
    return str(shown.run(script))


def test_the_page_is_alone_and_small(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size <= LARGEST
    without = re.sub(r'(<script type="text/plain" id="content">).*?(</script>)', r"\1\2", text)
    without = re.sub(r"<summary>Licences</summary>\n<pre>.*?</pre>", "", without, flags=re.DOTALL)
    for word in ("http:", "https:", "fetch(", "XMLHttpRequest", "import(", "<link", " src="):
        assert word not in without.replace("http://www.w3.org/2000/svg", ""), word


def test_the_page_carries_the_licences_of_what_is_linked_into_its_modules(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for owner in ("the jointfmu authors", "wasi-libc as a whole", "Rich Felker", "Nuxi"):
        assert owner in text, owner


def test_all_models_and_parameter_files_are_there() -> None:
    every = list_modules()
    assert {m.fmu_model.name for m in every} == set(MODELS)
    for kind in KINDS.values():
        stems = {path.stem for path in kind.default_file().parent.glob("*.toml")}
        names = {file.name for m in every if m.fmu_model.joint == kind.name for file in m.parameter_files}
        shipped = {load_parameter_file(kind.default_file().with_name(f"{stem}.toml")).name for stem in stems}
        assert names == shipped


@needed
@pytest.mark.parametrize("name", MODELS)
def test_each_joint_is_drawn_without_errors(shown: Browser, name: str) -> None:
    choose(shown, name)
    drawn = "[...document.querySelectorAll('main svg.plot')].filter((s) => s.closest('[hidden]') === null)"
    lines = shown.run(f"{drawn}.map((s) => s.querySelectorAll('path, circle').length)")
    assert lines
    assert 0 not in lines
    parts = "[...document.querySelectorAll('main svg [d], main svg [cx]')]"
    assert shown.run(f"{parts}.filter((p) => /NaN|Infinity/.test(p.outerHTML)).length") == 0
    assert not shown.run("document.body.classList.contains('refused')")


@needed
@pytest.mark.parametrize("name", MODELS)
def test_the_first_loop_starts_without_a_jump_and_loads_the_joint(shown: Browser, name: str) -> None:
    choose(shown, name)
    points, answer = shown.run("laboratory.then(({ path }) => [path.points, path.trace.force])")
    (first, *_), (second, *_) = points[:2]
    assert first == pytest.approx(second - first)
    assert answer[0] == 0.0
    assert any(answer)
    loss, note = shown.run(
        "laboratory.then(({ path }) => [path.trace.loss.at(-1), path.heat && path.heat.note.textContent])"
    )
    assert loss is None or note.startswith("No loss along this path") == (loss == 0.0)


@needed
def test_everything_has_a_name_and_nothing_is_wider_than_a_phone(shown: Browser) -> None:
    for name in MODELS:
        choose(shown, name)
        unnamed = shown.run(
            "[...document.querySelectorAll('input, select, button, svg.plot')].filter((e) => "
            "!(e.labels?.length || e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || "
            "e.textContent.trim())).map((e) => e.outerHTML)"
        )
        assert unnamed == []
        assert shown.run(
            "new Set([...document.querySelectorAll('[id]')].map((e) => e.id)).size"
        ) == shown.run("document.querySelectorAll('[id]').length")
        shown.shape(*PHONE, phone=True)
        assert shown.run("document.documentElement.scrollWidth") <= PHONE[0]
        sizes = (
            "[...document.querySelectorAll('body *')].map((e) => parseFloat(getComputedStyle(e).fontSize))"
        )
        assert shown.run(f"Math.min(...{sizes})") >= 11.0
        shown.shape(*DESKTOP)


@needed
def test_a_slider_moves_the_curves_and_a_refusal_is_told(shown: Browser) -> None:
    name, model = next(iter(MODELS.items()))
    choose(shown, name)
    parameter = JOINTS[model.joint].varied
    script = """(async () => {
      const lab = await laboratory, seen = () => document.querySelector("#curves").innerHTML;
      const v = lab.joint.variables.get(PARAMETER), control = lab.controls[v.name], before = seen();
      control.range.value = Number(control.range.value) + 40;
      control.range.dispatchEvent(new Event("input"));
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      const moved = seen() !== before && lab.values.get(v.name) !== lab.set.values[v.name];
      control.number.value = -1;
      control.number.dispatchEvent(new Event("input"));
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      const stale = () => document.querySelectorAll(".stale").length, greyed = stale();
      const said = document.getElementById("said").textContent;
      lab.take(lab.set);
      lab.draw();
      return [moved, said, document.getElementById("said").textContent, greyed, stale()];
    })()"""
    moved, said, after, *stale = shown.run(script.replace("PARAMETER", json.dumps(parameter)))
    assert moved
    assert re.search(rf"{re.escape(parameter)} = .* is outside ", said)
    assert stale[0] > 0  # what was drawn before is greyed
    assert stale[1] == 0
    assert after == ""


@needed
def test_arrow_keys_and_the_pointer_draw_a_path(shown: Browser) -> None:
    for name in MODELS:
        choose(shown, name)
        box = shown.run(
            "laboratory.then((lab) => { lab.path.clear(); const pad = lab.path.pad.svg; "
            "pad.scrollIntoView(); pad.focus(); const b = pad.getBoundingClientRect(); "
            "return [b.x, b.y, b.width, b.height] })"
        )
        for _ in range(3):
            shown.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight", code="ArrowRight")
        middle = [box[0] + 0.6 * box[2], box[1] + 0.4 * box[3]]
        for kind, shift in (
            ("mousePressed", 0),
            ("mouseMoved", 20),
            ("mouseMoved", 40),
            ("mouseReleased", 40),
        ):
            where = {"x": middle[0] + shift, "y": middle[1]}
            shown.call("Input.dispatchMouseEvent", type=kind, button="left", buttons=1, clickCount=1, **where)
        points, force, reading = shown.run(
            "laboratory.then(({ path }) => [path.points, path.trace.force, path.pad.reading.textContent])"
        )
        assert len(points) >= 6
        assert 0.0 < points[0][0] < points[1][0] < points[2][0]
        assert len(force) == len(points) + 1
        assert reading


@needed
def test_another_input_moves_along_a_path(shown: Browser) -> None:
    for name in MODELS:
        choose(shown, name)
        ways = shown.run("[...document.querySelectorAll('#moved option')].map((o) => o.textContent)") or []
        for i, way in enumerate(ways):
            found = shown.run(
                "laboratory.then((lab) => { const moved = document.getElementById('moved'); "
                f"moved.value = {i}; moved.dispatchEvent(new Event('change')); "
                "return [lab.path.inputs.map((v) => v.name), lab.path.trace.force.length, "
                "document.activeElement.id, document.getElementById('said').textContent] })"
            )
            assert found[0] == re.findall(r"(\w+): ", way)
            assert found[1] > 100, found[3]
            assert found[2] == "moved"


@needed
def test_on_a_phone_a_slider_and_its_curve_are_seen_together(shown: Browser) -> None:
    choose(shown, next(iter(MODELS)))
    shown.shape(*PHONE, phone=True)
    ends = shown.run(
        "new Promise((done) => { const sliders = document.getElementById('sliders'); sliders.open = true; "
        "document.getElementById('curves').scrollIntoView(); requestAnimationFrame(() => { "
        "const of = (e) => e.getBoundingClientRect(); "
        "const plot = of(document.querySelector('#curves svg')); "
        "done([plot.top, plot.bottom, of(sliders).top, of(sliders).bottom]) }) })"
    )
    shown.shape(*DESKTOP)
    top, bottom, first, last = ends
    assert 0.0 <= top < bottom <= first < last == PHONE[1]


@needed
def test_a_chart_zooms_by_pointer_and_keys(shown: Browser) -> None:
    choose(shown, next(iter(MODELS)))
    asked = "laboratory.then((lab) => lab.curves.panels[0].chart.zoom)"
    box = shown.run(
        "laboratory.then((lab) => { const { svg } = lab.curves.panels[0].chart; svg.scrollIntoView(); "
        "svg.focus(); const b = svg.getBoundingClientRect(); return [b.x, b.y, b.width, b.height] })"
    )
    for kind, part in (("mousePressed", 0.4), ("mouseReleased", 0.7)):
        where = {"x": box[0] + part * box[2], "y": box[1] + 0.5 * box[3]}
        shown.call("Input.dispatchMouseEvent", type=kind, button="left", buttons=1, clickCount=1, **where)
    low, high = shown.run(asked)
    assert 0.0 < low < high
    shown.call("Input.dispatchKeyEvent", type="keyDown", key="+", text="+")
    inner = shown.run(asked)
    assert inner[1] - inner[0] == pytest.approx(0.5 * (high - low))
    shown.call("Input.dispatchKeyEvent", type="keyDown", key="Escape")
    assert shown.run(asked) is None


@needed
def test_parameters_come_out_as_a_file_that_build_takes(shown: Browser, tmp_path: Path) -> None:
    for module in list_modules():
        name, first = module.fmu_model.name, module.parameter_files[0]
        index = [f.name for m in list_modules() if m.fmu_model.name == name for f in m.parameter_files].index(
            first.name
        )
        choose(shown, name, index)
        script = """laboratory.then((lab) => {
          for (const v of lab.about.variables) {
            if (v.bound || v.causality === "output") continue;
            const now = lab.values.get(v.name), other = v.causality === "input" ? v.span[1] / 3 : now * 1.001;
            lab.values.set(v.name, v.boolean ? !now : v.whole ? now : other);
          }
          return [lab.toml(), Object.fromEntries(lab.values)];
        })"""
        text, values = shown.run(script)
        path = tmp_path / "out.toml"
        path.write_text(text, encoding="utf-8")
        file = load_parameter_file(path, first.joint)
        assert file.law == first.law
        for key in module.fmu_model.parameter_fields():
            assert file.values_by_name[key] == values[key], key
        assert {v.name: file.start_value(v.name) for v in module.fmu_model.inputs} == {
            v.name: values[v.name] for v in module.fmu_model.inputs
        }
        others = set(file.values_by_name) - set(module.fmu_model.parameter_fields())
        assert {key: file.values_by_name[key] for key in others} == {
            key: first.values_by_name[key] for key in others
        }
        if index:
            continue  # the file is read, and builders take what is read of any law
        words = ("build", name, "--params", str(path), "--flavour", "python", "--out", str(tmp_path))
        assert cli.main(list(words)) == 0
        assert (tmp_path / "python" / f"{name}.fmu").is_file()


@needed
def test_a_parameter_file_is_shown(shown: Browser) -> None:
    for kind in KINDS.values():
        file = load_default(kind.name)
        name = next(
            name for name, value in file.values_by_name.items() if isinstance(value, float) and value > 0.0
        )
        changed = file.with_values({name: 0.99 * file.values_by_name[name]}, "user", "a test")
        said = drop(shown, "mine.toml", format_parameter_file(changed))
        assert said == f"mine.toml: {file.name} shown."
        joint, value = shown.run(
            f"laboratory.then((lab) => [lab.about.joint, lab.values.get({json.dumps(name)})])"
        )
        assert (joint, value) == (kind.name, changed.values_by_name[name])
    assert "expected a parameter file" in drop(shown, "mine.toml", "x = 1")


@needed
def test_a_measured_curve_stands_beside_the_curves_that_measure_the_same(shown: Browser) -> None:
    """Motion and force of a joint are compared with the file if the quantities are the same, in the file's
    units."""
    files = {
        "rad": ("angle [arcmin], torque [Nm]", 3437.7467707849396),
        "m": ("displacement [um]; force [kN]", 1e6),
    }
    for name in MODELS:
        choose(shown, name)
        units = shown.run("laboratory.then((lab) => [lab.path.inputs[0].unit, lab.path.force.unit])")
        base = next(unit for unit in units if unit in files)
        head, size = files[base]
        mark = ";" if ";" in head else ","
        text = f"# measured\n{head}\n" + "".join(f"{i}{mark}{2 * i}\n" for i in range(-5, 6))
        assert "11 points" in drop(shown, "loop.csv", text)
        script = """laboratory.then((lab) => {
          const series = lab.path.answer.series.at(-1);
          const first = lab.file.columns.map((c) => c.values[0]);
          return [series.name, first, lab.path.inputs[0].factor, series.x[0]];
        })"""
        title, first, factor, x = shown.run(script)
        assert title == "file: loop.csv"
        assert first[0] == pytest.approx(-5.0 / size)
        assert x == pytest.approx(factor * first[units.index(base)])
    assert "expected one in" in drop(shown, "loop.csv", "time [s], voltage [V]\n0, 1\n")
    assert "is not a number" in drop(shown, "loop.csv", "angle [rad], torque [N.m]\n0, x\n")
    assert "fit log" in drop(shown, "log.csv", "q [rad], dq [rad/s], tau [N.m]\n0, 1, 2\n1, 1, 3\n")
    assert "spans more than 0.5 rad" in drop(shown, "log.csv", "angle [deg], torque [N.m]\n0, 0\n90, 1\n")


@needed
def test_every_stop_of_every_slider_is_allowed(shown: Browser) -> None:
    """A stop is allowed even where other parameters leave a narrow interval, as for the radial deformation of
    a harmonic drive."""
    script = """laboratory.then((lab) => {
      for (const { show } of lab.fits()) show();
      const stops = (v) => [0, 200, 400, 600, 800, 1000].map((t) => onScale(v, t));
      const takes = (name, x) => lab.joint.begin(new Map(lab.values).set(name, x));
      const ranged = Object.entries(lab.controls).filter(([, control]) => control.range);
      return [
        ranged.filter(([name, { v }]) => !stops(v).every((x) => takes(name, x))).map(([name]) => name),
        ranged.filter(([name, { full }]) => !stops(full).every((x) => takes(name, x))).length,
      ];
    })"""
    narrowed = 0
    for name in MODELS:
        choose(shown, name)
        refused, less = shown.run(script)
        assert refused == [], name
        narrowed += less
    assert narrowed > len(MODELS)  # sliders over the whole span would be refused


@needed
def test_the_address_keeps_what_is_set_and_leads_back(shown: Browser) -> None:
    (first, model), *_, (last, _) = MODELS.items()
    parameter = JOINTS[model.joint].varied
    choose(shown, first)
    state = f"laboratory.then((lab) => [lab.about.name, lab.values.get({json.dumps(parameter)}), lab.end])"
    where = shown.run(f"""laboratory.then((lab) => {{
      lab.others[0].moved(1.25 * lab.end);
      lab.controls[{json.dumps(parameter)}].moved(1.01 * lab.values.get({json.dumps(parameter)}));
      lab.keep();
      return location.href;
    }})""")
    before = shown.run(state)
    shown.run(f"laboratory.then((lab) => lab.leave({json.dumps(last)}, 0))")
    assert shown.run(state)[0] == last
    shown.run(
        "new Promise((done) => { addEventListener('popstate', () => setTimeout(done, 500)); "
        "history.back(); }).then(() => true)"
    )
    assert shown.run(state) == before
    shown.call("Page.navigate", url="about:blank")
    shown.call("Page.navigate", url=where)
    while not shown.run("document.readyState === 'complete' && typeof laboratory !== 'undefined'"):
        pass
    assert shown.run(state) == before
