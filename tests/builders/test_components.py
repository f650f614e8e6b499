"""The WebAssembly component in FMUs of FMI 3.0: the native FMU's numbers and refusals, in wasmtime."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from components import ComponentFmu, Refused, package
from conftest import Fmu, made_once, refused_line, run_host
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from joint_cases import CASES, NAMES, STATE, random_inputs
from jointfmu_fmu_src.building import build
from jointfmu_fmu_src.native import kept
from jointfmu_fmu_src.native.build import build as build_native
from jointfmu_fmu_src.native.data import split
from jointfmu_fmu_src.partners import parameters
from jointfmu_tools.laboratory.modules import Module
from test_kept_parts import VARIANT
from test_native_binaries import members
from webassembly import random_values

from jointfmu.joints import MODELS
from jointfmu.parameters import default, dump
from jointfmu.run import ramp

SAME = 1e-12
"""The same C with another mathematical library [1]."""
CANCELLED = 1e-14
"""Round-off of an output whose terms cancel, over its nominal value [1]."""
FOLDERS = ("binaries/wasm32-wasip2/", "extra/org.modelica.fmi-ls-wasm/")
SETS, STEPS, LEVELS = 12, 4, 20


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the FMUs of the default parameters with a component."""

    def make(out: Path) -> None:
        build([], ["fmi3"], None, out, wasm=True)

    return made_once(tmp_path_factory, "components", make) / "fmi3"


@pytest.fixture(scope="module", params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def both(folder: Path, name: str) -> Iterator[tuple[Fmu, ComponentFmu]]:
    """Two instances of one FMU for co-simulation: by its library, and by its component."""
    path = folder / f"{name}.fmu"
    pair = Fmu(path), ComponentFmu(path)
    yield pair
    for one in pair:
        one.free()


def near(name: str, expected: dict[str, float]) -> dict[str, Any]:
    nominal = {v.name: v.nominal for v in MODELS[name].outputs}
    return {o: pytest.approx(x, rel=SAME, abs=CANCELLED * nominal[o]) for o, x in expected.items()}


def loop_of(name: str) -> tuple[dict[str, Any], str, Any]:
    """Settings, input and levels of a path to and fro; twice along the ramp for a joint without memory."""
    model = MODELS[name]
    if model.loop is None:
        up = np.linspace(0.0, model.ramp.end, LEVELS)
        return {}, model.ramp.input, np.concatenate([up, up[::-1]])
    phase = np.linspace(0.0, 2.5 * np.pi, 3 * LEVELS)
    settings = dict(model.loop.settings)
    middle = float(settings.get(model.loop.input, default(model.joint).start(model.loop.input)))
    return settings, model.loop.input, middle + model.loop.amplitude * np.sin(phase)


# Numbers


def test_the_load_ramp_is_that_of_the_library(name: str, both: tuple[Fmu, ComponentFmu]) -> None:
    load = MODELS[name].ramp
    for one in both:
        one.start()
    for level in np.linspace(0.0, load.end, LEVELS):
        for one in both:
            one.set({load.input: float(level)})
            one.step(load.interval)
        native, component = both
        assert component.get() == near(name, native.get())
        assert component.time == component.get("time")["time"] == native.time
    assert [m.text for m in component.messages] == [m.text for m in native.messages]


def test_a_loop_goes_on_from_a_saved_state(name: str, both: tuple[Fmu, ComponentFmu]) -> None:
    """Restored in the middle, also in another instance, it repeats every bit."""
    native, component = both
    settings, driven, levels = loop_of(name)
    for one in both:
        one.start(settings)
    half = len(levels) // 2

    def gone(one: ComponentFmu, levels: Any) -> list[dict[str, float]]:
        found = []
        for level in levels:
            one.set({driven: float(level)})
            one.step()
            found.append(one.get())
        return found

    first = gone(component, levels[:half])
    state, time = component("get-fmu-state"), component.time
    second = gone(component, levels[half:])
    for level, found in zip(levels, first + second, strict=True):
        native.set({driven: float(level)})
        native.step()
        assert found == near(name, native.get())
    component("set-fmu-state", state)
    component.time = time
    assert component("get-fmu-state") == state
    assert gone(component, levels[half:]) == second
    other = component.new(component.description.instantiationToken, "other")
    component.it.drop(component.store)
    component.it, component.time = other, time
    component("set-fmu-state", state)
    assert gone(component, levels[half:]) == second
    if MODELS[name].loop:
        component("reset")
        component.start(settings)
        component.time = 0.0
        assert gone(component, levels[half:]) != second
    with pytest.raises(Refused, match="error"):
        component("set-fmu-state", state[:-1])
    restored = native.fmu.deserializeFMUState(state)  # the bytes are those of the library, too
    native.fmu.setFMUState(restored)
    native.fmu.freeFMUState(restored)
    assert native.get() == near(name, first[-1])


def test_random_parameters_give_the_numbers_or_refusals_of_the_library(
    name: str, both: tuple[Fmu, ComponentFmu]
) -> None:
    native, component = both
    file, rng = default(MODELS[name].joint), np.random.default_rng(16)
    module = Module(MODELS[name].of(file.joint, file.values), [file])
    sets = [random_values(module, rng, switched=False) for _ in range(SETS)]
    sets += [{one.parameter: one.value} for one in CASES[name].refusals.refused]
    refused = 0
    for i, values in enumerate(sets):
        seen = [len(one.messages) for one in both]
        native.reset()
        component("reset")
        try:
            native.start(values)
        except FMICallException:
            with pytest.raises(Refused, match="error"):
                component.start(values)
            refused += 1
        else:
            component.start(values)
            for inputs in random_inputs(name, STEPS, seed=i):
                for one in both:
                    one.set(inputs)
                    one.step()
                assert component.get() == near(name, native.get())
        told, said = (one.messages[n:] for one, n in zip(both, seen, strict=True))
        assert [(m.status, m.category) for m in said] == [(m.status, m.category) for m in told]
        assert [m.text for m in said if m.status == 3] == [m.text for m in told if m.status == 3]
    assert len(CASES[name].refusals.refused) <= refused < len(sets)
    assert component.names == {"test"}


def test_derivatives_and_dependencies_are_those_of_the_library(
    name: str, both: tuple[Fmu, ComponentFmu]
) -> None:
    native, component = both
    for one in both:
        one.start(STATE[name])
        one.step()
    inputs = component.references(v.name for v in MODELS[name].inputs)
    outputs = component.references(component.outputs)
    seed = [0.5 + i for i in range(len(inputs))]
    forward = component("get-directional-derivative", outputs, inputs, seed)
    assert forward == pytest.approx(native.fmu.getDirectionalDerivative(outputs, inputs, seed), rel=1e-9)
    weights = [1.0 / (1.0 + abs(v)) for v in component.get().values()]
    back = component("get-adjoint-derivative", outputs, inputs, weights)
    assert np.dot(back, seed) == pytest.approx(np.dot(forward, weights), rel=1e-9)
    known = {u.variable.valueReference: u.dependencies for u in component.description.outputs}
    for output in outputs:
        rows = [tuple(vars(row).values()) for row in component("get-variable-dependencies", output)]
        assert component("get-number-of-variable-dependencies", output) == len(rows)
        assert rows == [(output, 0, v.valueReference, 0, "dependent") for v in known[output]]


# Model exchange


def test_model_exchange_steps_like_the_library(folder: Path, name: str) -> None:
    path = folder / f"{name}.fmu"
    native, component = Fmu(path, exchange=True), ComponentFmu(path, exchange=True)
    settings, driven, levels = loop_of(name)
    for one in (native, component):
        one.start(settings)
    info = vars(component("update-discrete-states"))
    assert (info.pop("next-event-time"), set(info.values())) == (0.0, {False})
    native.fmu.enterContinuousTimeMode()
    component("enter-continuous-time-mode")
    for i, level in enumerate(levels):
        for one in (native, component):
            one.set({driven: float(level)})
        native.fmu.setTime(float(i))
        component("set-time", float(i))
        assert component.get() == near(name, native.get())
        assert [bool(x) for x in native.fmu.completedIntegratorStep()] == [False, False]
        assert set(vars(component("completed-integrator-step", True)).values()) == {False}
    assert component("get-number-of-continuous-states") == 0
    assert component("get-number-of-event-indicators") == 0
    assert component("get-event-indicators") == component("get-continuous-states") == []
    for method in ("enter-event-mode", "enter-continuous-time-mode", "terminate"):
        component(method)
    native.free()
    component.free()


def test_states_and_time_events_of_the_partners(tmp_path: Path) -> None:
    """A mass under a constant force, by Euler's steps; and a load that announces its corners."""
    mass, load = (
        ComponentFmu(build_native(name, parameters(name), tmp_path, "3", wasm=True), exchange=True)
        for name in ("TranslationalMass", "ForceProfile")
    )
    mass.start({"f_a": 3.0, "m": 2.0})
    mass("enter-continuous-time-mode")
    assert mass("get-number-of-continuous-states") == 2
    nominals = [mass.description.modelVariables[i].nominal for i in mass.references(["s", "v"])]
    assert mass("get-nominals-of-continuous-states") == [float(x) for x in nominals]
    state, size, steps = np.zeros(2), 0.1, 10
    for i in range(steps):
        mass("set-time", size * i)
        state += size * np.array(mass("get-continuous-state-derivatives"))
        mass("set-continuous-states", state.tolist())
        assert mass("get-continuous-states") == state.tolist()
    speed = steps * size * 1.5
    assert state == pytest.approx([0.5 * (steps - 1) * size * speed, speed], rel=1e-12)
    corners = sorted(float(x) for x in parameters("ForceProfile").values.corners() if x > 0.0)
    load.start()
    info = vars(load("update-discrete-states"))
    assert info["next-event-time-defined"]
    assert info["next-event-time"] == corners[0]


# What it takes and refuses


def test_what_the_library_refuses_is_refused_in_its_words(name: str, both: tuple[Fmu, ComponentFmu]) -> None:
    native, component = both
    for one in both:
        one.start()
    unknown = 10_000
    for method, arguments in {
        "get-float64": ([unknown],),
        "set-float64": ([1, 2], [0.5]),
        "get-boolean": ([1],),
        "get-int8": ([1],),
        "set-uint64": ([1], [7]),
        "get-string": ([1],),
        "set-string": ([1], ["ü"]),
        "set-binary": ([1], [b"\0\1"]),
        "get-clock": ([1],),
        "set-clock": ([], [True]),
        "set-interval-fraction": ([], [fraction()]),
        "get-shift-fraction": ([1],),
        "get-variable-dependencies": (unknown,),
        "get-directional-derivative": ([1], [1], [1.0, 2.0]),
        "enter-event-mode": (),
        "update-discrete-states": (),
        "set-input-derivatives": ([(1, 1)], [0.0]),
        "set-debug-logging": (True, ["logEvents", "logEverything"]),
        "enter-initialization-mode": (None, 0.0, 1.0),
    }.items():
        seen = len(component.messages)
        with pytest.raises(Refused, match="error"):
            component(method, *arguments)
        (message,) = component.messages[seen:]
        assert message.status == 3
        assert "; expected" in message.text
    words = native.refused(native.read, [unknown])
    with pytest.raises(Refused):
        component("get-float64", [unknown])
    assert component.messages[-1].text == words


def fraction() -> Any:
    from wasmtime.component import Record

    found = Record()
    vars(found).update({"counter": 1, "resolution": 2})
    return found


def test_empty_lists_of_types_that_no_variable_has_are_nothing(both: tuple[Fmu, ComponentFmu]) -> None:
    _, component = both
    component.start()
    for kind in ("float32", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"):
        assert list(component(f"get-{kind}", [])) == []
        assert component(f"set-{kind}", [], b"" if kind == "uint8" else []) is None
    for kind in ("string", "clock", "interval-decimal", "interval-fraction", "shift-decimal"):
        assert component(f"get-{kind}", []) == []
        assert component(f"set-{kind}", [], []) is None
    assert component("set-debug-logging", True, ["logEvents"]) is None


def test_no_instance_is_made_of_another_fmu(folder: Path, name: str) -> None:
    component = ComponentFmu(folder / f"{name}.fmu")
    assert component.new("ä" * 50) is None
    assert "the token is '" in component.messages[-1].text
    assert component.new(component.description.instantiationToken, events=True) is None
    assert "eventModeUsed = false" in component.messages[-1].text
    assert component.new(component.description.instantiationToken, intermediate=[1]) is not None
    assert component.messages[-1].status == 1
    assert component.function("common", "get-version") == "3.0"


def test_no_call_leaves_memory_behind(folder: Path) -> None:
    """The host allows an instance 8 MB; these calls pass more than that of numbers, texts, instances."""
    component = ComponentFmu(folder / f"{NAMES[0]}.fmu").start()
    many = component.references(component.outputs) * 200
    for _ in range(12_000_000 // (12 * len(many))):
        component("get-float64", many)
    for _ in range(30):
        assert component.new("x" * 400_000) is None
        with pytest.raises(Refused, match="error"):
            component("set-debug-logging", False, ["y" * 400_000])
    component.free()
    for _ in range(300):
        component.it = component.new(component.description.instantiationToken)
        component.free()


# The file


def exports(component: ComponentFmu, kind: str) -> set[str]:
    engine = component.store.engine
    return set(component.component.type.exports(engine)[package(kind)].ty.exports(engine))


def kebab(function: str) -> str:
    """fmi3GetFMUState -> get-fmu-state, as the draft names functions."""
    return re.sub(
        r"(?<=[a-z0-9])(?=[A-Z])", "-", function.replace("UInt", "Uint").replace("FMU", "Fmu")
    ).lower()


def test_the_functions_are_those_of_fmi(folder: Path) -> None:
    """The list of FMI's own header, under the draft's names, and what the draft says beyond it."""
    header = (Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h").read_text()
    every = {kebab(f) for f in re.findall(r"fmi3(\w+)TYPE +fmi3\1;", header)}
    gone = {  # free functions, those of scheduled execution, and what is one with another function
        "get-version", "instantiate-scheduled-execution", "activate-model-partition", "free-instance",
        "free-fmu-state", "serialized-fmu-state-size", "serialize-fmu-state", "deserialize-fmu-state",
    }  # fmt: skip
    exchange = {
        "instantiate-model-exchange", "enter-continuous-time-mode", "completed-integrator-step", "set-time",
        "set-continuous-states", "get-continuous-state-derivatives", "get-event-indicators",
        "get-continuous-states", "get-nominals-of-continuous-states", "get-number-of-event-indicators",
        "get-number-of-continuous-states",
    }  # fmt: skip
    stepping = {"instantiate-co-simulation", "do-step"}
    assert gone | exchange | stepping <= every
    component = ComponentFmu(folder / f"{NAMES[0]}.fmu")
    for kind, expected in (
        ("model-exchange", every - gone - stepping),
        ("co-simulation", every - gone - exchange | {"set-input-derivatives"}),
    ):
        found = exports(component, kind)
        functions = {f.rpartition(".")[2] for f in found if f.startswith("[")}
        assert functions == expected
        assert f"{kind}-instance" in found
    assert exports(component, "common") == {"get-version"}


def test_the_rest_of_the_fmu_is_the_same(folder: Path, name: str, tmp_path: Path) -> None:
    """Without the option there is no trace of it; with it every build gives the same bytes."""
    with_it = folder / f"{name}.fmu"
    (again,) = build([name], ["fmi3"], None, tmp_path / "again", wasm=True)
    assert again.read_bytes() == with_it.read_bytes()
    (plain,) = build([name], ["fmi3"], None, tmp_path / "plain")
    found = members(with_it)
    added = {path for path in found if path.startswith(FOLDERS)}
    assert added == {
        f"binaries/wasm32-wasip2/{name}.wasm",
        "extra/org.modelica.fmi-ls-wasm/manifest.xml",
        "extra/org.modelica.fmi-ls-wasm/fmi-ls-manifest.xml",
    }
    assert members(plain) == {path: content for path, content in found.items() if path not in added}
    assert len(found[f"binaries/wasm32-wasip2/{name}.wasm"]) < 400_000
    root = ElementTree.fromstring(found["extra/org.modelica.fmi-ls-wasm/manifest.xml"])
    space = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert root.get(f"{space}fmi-ls-name") == "org.modelica.fmi-ls-wasm"
    assert root.get(f"{space}fmi-ls-version") == "0.1.0"
    assert root.get(f"{space}fmi-ls-description") == "FMI Layered Standard for WebAssembly"


def test_tools_that_know_nothing_of_it_run_the_fmu(folder: Path, name: str) -> None:
    path = folder / f"{name}.fmu"
    assert validate_fmu(str(path)) == []
    load = MODELS[name].ramp
    assert len(ramp.run(path, load.input, load.end, load.end / 4).columns[load.input]) > 4


def test_the_example_of_the_documentation_runs(folder: Path, tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "wasm.md").read_text()
    (example,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (tmp_path / "dist").mkdir()
    (tmp_path / "dist" / "fmi3").symlink_to(folder, target_is_directory=True)
    done = subprocess.run([sys.executable, "-c", example], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    (name,) = set(re.findall(r"fmi3/(\w+)\.fmu", example))
    ((driven, level),) = re.findall(r'\[references\["(\w+)"\]\], \[(.*?)\]', example)
    (read,) = set(re.findall(r'references\["(\w+)"\]', example)) - {driven}
    native = Fmu(folder / f"{name}.fmu").start()
    native.set({driven: float(level)})
    native.step()
    assert json.loads(done.stdout) == [pytest.approx(native.get()[read], rel=SAME)]
    native.free()


def test_a_named_variant_has_its_own_numbers(tmp_path: Path, name: str) -> None:
    """Numbers that a tool may not set, too: they are data in the module."""
    file = default(MODELS[name].joint)
    numbers = {n: v for n, v in file.flat.items() if type(v) is float and v and not v.is_integer()}
    changed = file.with_values({n: v * (1.0 + 1e-3) for n, v in numbers.items()}, "user", "test")
    (path,) = build([name], ["fmi3"], changed, tmp_path, alias="Mine", wasm=True)
    native, component = Fmu(path), ComponentFmu(path)
    for one in (native, component):
        one.start(STATE[name])
    assert component.get(*numbers.keys() & component.variables) == native.get(
        *numbers.keys() & native.variables
    )
    assert component.get() == near(name, native.get())
    native.free()


def test_a_variant_needs_no_compiler_once_the_module_is_kept(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, file = MODELS[NAMES[0]], default(MODELS[NAMES[0]].joint)
    parameter, value = next(iter(CASES[NAMES[0]].tuning.tuned.items()))
    changed = file.with_values({parameter: value}, "user", "test")
    (tmp_path / "variant.toml").write_text(dump(changed))
    words = (NAMES[0], tmp_path / "variant.toml", tmp_path / "out", "--wasm")
    done = run_host(VARIANT, *words)
    assert done.returncode == 0, done.stderr
    (again,) = build([NAMES[0]], ["fmi3"], changed, tmp_path / "again", wasm=True)
    assert (tmp_path / "out" / "fmi3" / again.name).read_bytes() == again.read_bytes()
    part = kept._places(kept.shipped_name(model, split(model, file)))[1]
    alone = tmp_path / "cache" / part.parent.name / part.name
    alone.parent.mkdir(parents=True)
    alone.write_bytes(part.read_bytes())
    monkeypatch.setenv(kept.CACHE, str(tmp_path / "cache"))
    done = run_host(VARIANT, *words[:2], tmp_path / "none", "--wasm")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "ziglang" in done.stderr
    assert not (tmp_path / "none").exists()


# Refusals


def test_it_is_of_fmi_3_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    for arguments, words in (
        ([NAMES[0], "--flavour", "fmi2", "python"], ["WebAssembly", "fmi3", "fmi2, python"]),
        (["--systems"], ["--wasm", "--systems"]),
    ):
        line = refused_line(capsys, "build", *arguments, "--wasm", "--out", out)
        assert [word for word in words if word not in line] == []
    assert not out.exists()
