"""Invalid values are refused with one line that names them; a refusal has no other effect."""

import json
import math
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from case import Beyond, Refused
from conftest import Fmu, refused_line, run_host
from joint_cases import BEYOND, CASES, GOOD, NAMES
from jointfmu_tools import cli

from jointfmu.joints import KINDS, MODELS

Host = Callable[..., Fmu]


# Parameters


@pytest.mark.parametrize(
    ("name", "refused"),
    [(name, refused) for name, case in CASES.items() for refused in case.refusals.refused],
)
def test_a_bad_parameter_is_named_with_value_unit_and_range(fmu: Host, name: str, refused: Refused) -> None:
    instance = fmu(name)
    instance.fmu.setupExperiment(startTime=0.0)
    instance.fmu.enterInitializationMode()
    instance.set_values({refused.parameter: refused.value})
    message = instance.refused(instance.fmu.exitInitializationMode)
    assert message.startswith(f"{refused.parameter} = {refused.shown} is outside {refused.allowed}: ")


SWEEP = """
import json, sys
from pathlib import Path
from conftest import Fmu
name, folder, bad, good = sys.argv[1], Path(sys.argv[2]), json.loads(sys.argv[3]), json.loads(sys.argv[4])
bystander = Fmu(folder / f"{name}.fmu").start(good)
before, instance, messages = bystander.get(), Fmu(folder / f"{name}.fmu"), []
for parameter, value in bad:
    messages.append(instance.refused(instance.start, {parameter: value}))
    instance.reset()
    assert bystander.get() == before, "another instance was harmed"
assert instance.start(good).get() == before, "wrong numbers after reset"
bystander.step()
instance.free_instance(), bystander.free_instance()
print(json.dumps(messages))
"""


@pytest.mark.parametrize("name", [kind.models[0].name for kind in KINDS.values()])
def test_every_parameter_is_checked_and_a_refusal_harms_nothing(fmus: Path, name: str) -> None:
    bad: list[tuple[str, float]] = []
    for parameter, item in MODELS[name].parameter_fields().items():
        if "unit" not in item.metadata:
            continue
        allowed = item.metadata["interval"]
        low = allowed.low if allowed.low_open else math.nextafter(allowed.low, -math.inf)
        high = allowed.high if allowed.high_open else math.nextafter(allowed.high, math.inf)
        values = [math.nan, math.inf, -math.inf, low, high]
        bad += [(parameter, v) for v in dict.fromkeys(values)]
    assert len(bad) > 50  # a crash would come after a few refusals
    host = run_host(SWEEP, name, fmus, json.dumps(bad), json.dumps(GOOD[name]))
    assert host.returncode == 0, host.stderr
    for (parameter, value), message in zip(bad, json.loads(host.stdout), strict=True):
        unit = MODELS[name].parameter_fields()[parameter].metadata["unit"]
        shown = f"{value:.10g}" + ("" if unit == "1" else f" {unit}")
        assert message.startswith(f"{parameter} = {shown} is outside "), message


def test_two_bad_parameters_are_both_named(fmu: Host) -> None:
    instance = fmu("GearContact")
    message = instance.refused(instance.start, {"e": 1.0, "sigma_y": -1.0})
    assert "e = 1 is outside [0, 1)" in message
    assert "sigma_y = -1 Pa is outside (0, inf)" in message


@pytest.mark.parametrize(
    ("name", "values", "parts"),
    [(name, *unfit) for name, case in CASES.items() for unfit in case.refusals.unfit],
)
def test_parameters_that_do_not_fit_together_are_refused(
    fmu: Host, name: str, values: dict[str, float], parts: tuple[str, ...]
) -> None:
    instance = fmu(name)
    message = instance.refused(instance.start, values)
    assert [p for p in parts if p not in message] == []


@pytest.mark.parametrize(
    ("name", "parameter", "value"),
    [(name, *absurd) for name, case in CASES.items() for absurd in case.refusals.absurd],
)
def test_an_absurd_value_in_range_is_refused_by_name_or_gives_numbers(
    fmu: Host, name: str, parameter: str, value: float
) -> None:
    from fmpy.fmi1 import FMICallException

    instance = fmu(name)
    try:
        instance.start({parameter: value} | GOOD[name])
    except FMICallException:
        (error,) = [m.message_text for m in instance.messages if m.fmi_status == 3]
        assert parameter.split(".")[-1] in error
    else:
        assert all(math.isfinite(x) for x in instance.get().values())


def test_a_refused_parameter_is_refused_wherever_an_output_is_asked_for(fmu: Host) -> None:
    instance = fmu("GearContact")
    instance.fmu.setupExperiment(startTime=0.0)
    instance.fmu.enterInitializationMode()
    instance.set_values({"e": 2.0})
    assert "e = 2 is outside [0, 1)" in instance.refused(instance.get)
    instance.set_values({"e": 0.2})  # still in initialization: a new value may come
    instance.fmu.exitInitializationMode()
    assert instance.at(GOOD["GearContact"]) == fmu("GearContact").start(GOOD["GearContact"]).get()


def test_a_fixed_parameter_cannot_be_set_after_initialization(fixed: Host) -> None:
    for values in ({"e": 0.3}, {"rigid_flat": False}):
        instance = fixed("GearContact").start(GOOD["GearContact"])
        before = instance.get()
        (name,) = values
        assert instance.refused(instance.set_values, values).startswith(f"{name} is a fixed parameter")
        assert instance.get() == before
        instance.step()
        assert instance.get() == before
        assert instance.get("e") == {"e": 0.2}


def test_a_wrong_value_during_a_run_is_refused_and_the_run_goes_on(fmu: Host) -> None:
    instance = fmu("GearContact").start(GOOD["GearContact"])
    before = instance.get()
    instance.set_values({"surface1.G": math.nan})
    assert "surface1.G = nan m is outside (0, inf)" in instance.refused(instance.step)
    instance.set_values({"surface1.G": fmu("GearContact").start().get("surface1.G")["surface1.G"]})
    instance.step()
    assert instance.get() == before


def test_an_output_cannot_be_set(fmu: Host) -> None:
    from fmpy.fmi1 import FMICallException

    instance = fmu("GearContact").start(GOOD["GearContact"])
    before = instance.get()
    with pytest.raises(FMICallException):
        instance.set_values({"K_N": 1.0})
    assert instance.get() == before


# Inputs


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", NAMES)
def test_an_input_that_is_no_number_is_refused_at_the_step(fmu: Host, name: str, value: float) -> None:
    bystander = fmu(name).start(GOOD[name])
    before = bystander.get()
    for variable in MODELS[name].inputs:
        instance = fmu(name).start(GOOD[name])
        instance.set_values({variable.name: value})
        for call in (instance.step, instance.get):
            message = instance.refused(call)
            assert message.startswith(f"{variable.name} = {value:g} {variable.unit} is outside ")
            assert "inf)" in message
        instance.reset()
        assert instance.start(GOOD[name]).get() == before
        instance.step()
        assert instance.get() == before
    assert bystander.get() == before


def test_a_bad_input_is_refused_at_the_end_of_initialization_too(fmu: Host) -> None:
    instance = fmu("GearContact")
    assert instance.refused(instance.start, {"f": math.nan}).startswith("f = nan N is outside (-inf, inf)")


def test_a_negative_preload_is_refused(fmu: Host) -> None:
    instance = fmu("BoltedJoint").start({"preload": 9e3})
    before = instance.get()
    instance.set_values({"preload": -1.0})
    assert instance.refused(instance.step).startswith("preload = -1 N is outside [0, inf)")
    instance.reset()
    assert instance.start({"preload": 9e3}).get() == before


MANY = """
import sys, math
from pathlib import Path
from conftest import Fmu
path = Path(sys.argv[1]) / "HarmonicDriveSpring.fmu"
bystander, instance = Fmu(path).start({"phi2": 6e-4}), Fmu(path).start({"phi2": 6e-4})
before, (ratio,) = bystander.get(), instance.get("ratio").values()
for i in range(15):
    instance.set_values({"w1": math.nan})
    instance.refused(instance.step)
    instance.refused(instance.get)
    instance.set_values({"w1": 0.0, "ratio": 0.0})
    instance.refused(instance.step)
    instance.set_values({"ratio": ratio})
    if i % 3 == 0:
        instance.reset()
        instance.refused(instance.start, {"ratio": 0.0})
        instance.reset()
        instance.start({"phi2": 6e-4})
    instance.set_values({"w1": 0.0})
    assert instance.get() == before and bystander.get() == before
for i in range(10):
    third = Fmu(path)
    third.refused(third.start, {"mu": math.nan})
    third.free_instance()
assert bystander.get() == before
instance.free_instance(), bystander.free_instance()
print("alive")
"""


def test_many_refusals_in_a_row_do_not_crash_the_process(fmus: Path) -> None:
    host = run_host(MANY, fmus)
    assert (host.returncode, host.stdout) == (0, "alive\n"), host.stderr


WRONG_CALL = """
import sys
from pathlib import Path
from conftest import Fmu
from fmpy.fmi1 import FMICallException
path = Path(sys.argv[1]) / "GearContact.fmu"
instance = Fmu(path).start({"f": 900.0})
before, fmu = instance.get(), instance.fmu
calls = {
    "getReal of an unknown reference": lambda: fmu.getReal([9999]),
    "setReal of an output": lambda: instance.set_values({"K_N": 1.0}),
    "getInteger of a Real": lambda: fmu.getInteger([0]),
    "setInteger of a Real": lambda: fmu.setInteger([0], [1]),
    "getString of a Real": lambda: fmu.getString([0]),
    "setString of a Real": lambda: fmu.setString([0], ["1"]),
    "getBoolean of a Real": lambda: fmu.getBoolean([0]),
    "state of rubbish": lambda: fmu.setFMUstate(fmu.deSerializeFMUstate(b"rubbish")),
    "state of nothing": lambda: fmu.setFMUstate(fmu.deSerializeFMUstate(b"{}")),
}
for name, call in calls.items():
    print(name, flush=True)
    for _ in range(5):
        try:
            call()
        except FMICallException:
            assert instance.get() == before
        else:
            raise SystemExit("was not refused")
instance.free_instance()
print("alive")
"""


def test_wrong_calls_repeated_by_the_host_do_not_crash_the_process(fmus: Path) -> None:
    """The process survives every wrong call; otherwise its output ends with the call before the crash."""
    host = run_host(WRONG_CALL, fmus)
    assert host.returncode == 0, (host.stdout, host.stderr[-300:])
    *called, last = host.stdout.splitlines()
    assert (len(called), last) == (9, "alive")


# Beyond the table: warned once, continued with the last tangent


@pytest.mark.parametrize(("name", "beyond"), BEYOND)
def test_beyond_the_table_the_last_tangent_continues_with_one_warning(
    fmu: Host, name: str, beyond: Beyond
) -> None:
    driven, far, answer, stiffness, text, inverse, lever = beyond
    instance = fmu(name).start(GOOD[name])
    assert not instance.messages
    x, found = [far, 1.5 * far, 2.0 * far], []
    for value in x:
        found.append(instance.at({driven: value}))
        instance.step()
    (warning,) = instance.warnings
    assert text in warning
    assert " is outside " in warning
    assert "outside the tabulated law, the curve continues with its last tangent" in warning
    assert not [m for m in instance.messages if m.fmi_status > 1]
    assert all(math.isfinite(v) for f in found for v in f.values())
    y = [f[answer] for f in found]
    # a straight line: three points, to round-off of values much larger than their difference
    assert y[2] - y[1] == pytest.approx(y[1] - y[0], rel=1e-9)
    slope = abs((y[1] - y[0]) / (x[1] - x[0])) / lever
    if inverse:
        slope = 1.0 / slope
    assert [f[stiffness] for f in found] == pytest.approx([slope] * 3, rel=1e-9)
    other = fmu(name).start()
    assert other.messages == []
    other.at({driven: far})
    assert len(other.warnings) == 1  # each instance has its own


def test_the_negative_end_of_the_table_warns_too(fmu: Host) -> None:
    spring = fmu("HarmonicDriveSpring").start()
    there, back = spring.at({"phi2": 0.01}), spring.at({"phi2": -0.01})
    assert back["tau"] == -there["tau"]
    assert len(spring.warnings) == 1
    compliance = fmu("HarmonicDriveCompliance").start({"tau": -100.0})
    assert "tau = -100 N.m is outside [-30, 30] N.m" in compliance.warnings[0]


def test_separated_teeth_carry_no_force_and_warn_once(fmu: Host) -> None:
    instance = fmu("GearContact").start({"f": 900.0})
    for f in (-5.0, -7.0):
        assert list(instance.at({"f": f}).values()) == [0.0] * 4
        instance.step()
    (warning,) = instance.warnings
    assert warning.startswith("f = -5 N is outside [0, inf) N: the force is tensile")
    instance.at({"f": 1e6})
    assert len(instance.warnings) == 2  # another limit, its own warning


def test_a_moment_that_opens_a_row_warns(fmu: Host) -> None:
    instance = fmu("BoltedJoint").start({"preload": 1e3, "moment": 800.0})
    assert not instance.messages  # 800 N.m shift 889 N: both rows still hold
    opened = instance.at({"moment": 1800.0})
    instance.step()
    (warning,) = instance.warnings
    assert warning.startswith("moment = 1800 N.m is outside [-900, 900] N.m: a bolt force would be negative")
    assert all(math.isfinite(v) for v in opened.values())
    assert opened["p_max"] > 0.0


def test_outputs_stay_finite_at_any_finite_displacement(fmu: Host) -> None:
    instance = fmu("BoltedJoint").start({"preload": 9e3})
    for axis in "xyz":
        for value in (1e3, -1e3, 1e9):
            found = instance.at({"s_rel_x": 0.0, "s_rel_y": 0.0, "s_rel_z": 0.0, f"s_rel_{axis}": value})
            assert all(math.isfinite(v) for v in found.values()), (axis, value)


# Broken FMUs and bad command lines


def without(source: Path, target: Path, part: str) -> Path:
    """Copy an FMU without the members whose path contains `part`."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        names = [n for n in old.namelist() if part not in n]
        assert len(names) < len(old.namelist())
        for name in names:
            new.writestr(name, old.read(name))
    return target


RAMP = ("--input", "f", "--to", "100", "--step", "10")


def broken(kind: str, whole: Path, folder: Path) -> Path:
    path = folder / "broken.fmu"
    if kind == "missing":
        return path
    if kind == "directory":
        path.mkdir()
    elif kind == "text":
        path.write_text("this is not an FMU\n")
    elif kind == "empty":
        path.write_bytes(b"")
    elif kind == "half":
        path.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    elif kind == "damaged":
        data = bytearray(whole.read_bytes())
        data[2000:3000] = bytes(1000)
        path.write_bytes(data)
    elif kind == "bad xml":
        with zipfile.ZipFile(path, "w") as file:
            file.writestr("modelDescription.xml", "<fmiModelDescription")
    elif kind == "other zip":
        with zipfile.ZipFile(path, "w") as file:
            file.writestr("readme.txt", "hello")
    elif kind in CHANGES:
        changed(whole, path, CHANGES[kind])
    else:
        without(whole, path, kind)
    return path


def changed(source: Path, target: Path, change: Callable[[str, bytes], bytes]) -> Path:
    """Copy an FMU with its members changed by a function."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            new.writestr(name, change(name, old.read(name)))
    return target


def description(old: bytes, new: bytes) -> Callable[[str, bytes], bytes]:
    """Change for `changed`: replace a pattern in the model description."""
    return lambda name, data: re.sub(old, new, data) if name == "modelDescription.xml" else data


FMI_1 = b"""
<fmiModelDescription fmiVersion="1.0" modelName="one" modelIdentifier="one" guid="{1}"
numberOfContinuousStates="0" numberOfEventIndicators="0"/>"""
CHANGES = {
    "corrupt library": lambda name, data: b"\x7fELF" if name.startswith("binaries/") else data,
    "foreign library": description(b'modelIdentifier="[^"]*"', b'modelIdentifier="other"'),
    "model exchange": description(b"(?s)<CoSimulation.*?/>", b""),
    "FMI 1.0": description(rb"(?s)\A.*", FMI_1.strip()),
}
REASONS = {
    "corrupt library": "the library in the FMU cannot be loaded (binaries",
    "foreign library": "the library in the FMU cannot be loaded (Cannot find shared library binaries",
    "model exchange": "has no co-simulation",
    "FMI 1.0": "is an FMU of FMI 1.0, allowed are 2.0 and 3.0",
}


@pytest.mark.parametrize(
    "kind",
    [
        "missing",
        "directory",
        "text",
        "empty",
        "half",
        "damaged",
        "bad xml",
        "other zip",
        "binaries/",
        *CHANGES,
    ],
)
def test_what_is_no_fmu_is_refused_with_one_line(
    fmus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    path, here = broken(kind, fmus / "GearContact.fmu", tmp_path), Path.cwd()
    line = refused_line(capsys, "ramp", path, *RAMP)
    assert str(path) in line
    assert REASONS.get(kind, "") in line
    assert Path.cwd() == here


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--input", "g", "--to", "1", "--step", "1"), ("'g'", "allowed are f")),
        (("--input", "K_N", "--to", "1", "--step", "1"), ("'K_N'", "allowed are f")),
        (("--input", "f", "--to", "1", "--step", "0"), ("step = 0", "(0, inf)")),
        (("--input", "f", "--to", "1", "--step", "-1"), ("step = -1", "(0, inf)")),
        (("--input", "f", "--to", "-1", "--step", "1"), ("step = 1", "(-inf, 0)")),
        (("--input", "f", "--to", "nan", "--step", "1"), ("to = nan", "finite")),
        (("--input", "f", "--to", "inf", "--step", "1"), ("to = inf", "finite")),
        (("--input", "f", "--to", "1", "--step", "nan"), ("step = nan", "finite")),
        (("--input", "f", "--to", "1", "--step", "1e-9"), ("step = 1e-09", "1e7")),
        (("--input", "f", "--to", "high", "--step", "1"), ("--to", "'high'")),
        ((*RAMP, "--set", "q=1"), ("'q'", "allowed are f, surface1.D")),
        ((*RAMP, "--set", "K_N=1"), ("'K_N'", "allowed are")),
        ((*RAMP, "--set", "e=much"), ("e = 'much'", "number")),
        ((*RAMP, "--set", "rigid_flat=2"), ("rigid_flat = 2.0", "true or false")),
        ((*RAMP, "--set", "e=1.5"), ("e = 1.5 is outside [0, 1)",)),
        ((*RAMP, "--set", "e=nan"), ("e = nan is outside [0, 1)",)),
        ((*RAMP, "--set", "e"), ("'e'", "NAME=VALUE")),
        ((*RAMP, "--csv", "{file}/below.csv"), ("below.csv", "cannot be written")),
    ],
)
def test_bad_ramps_are_refused_with_one_line(
    fmus: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    parts: tuple[str, ...],
) -> None:
    file = tmp_path / "file"
    file.write_text("")
    given = [a.replace("{file}", str(file)) for a in arguments]
    line = refused_line(capsys, "ramp", fmus / "GearContact.fmu", *given)
    assert [p for p in parts if p not in line] == []


def test_a_ramp_into_bad_values_names_them(fmus: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = fmus / "BoltedJoint.fmu"
    line = refused_line(capsys, "ramp", path, "--input", "preload", "--to", "-100", "--step", "-10")
    assert "preload = -10 N is outside [0, inf)" in line


def test_an_error_is_named_not_the_warning_before_it(fmus: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """At 0 K, the start of the ramp, the FMU warns of a lost start value; at -5 K it refuses the input."""
    path = fmus / "BoltedJoint.fmu"
    line = refused_line(capsys, "ramp", path, "--input", "temperature", "--to", "-10", "--step", "-5")
    assert "temperature = -5 K is outside [0, inf)" in line
    assert "start value" not in line


def test_json_prints_one_object_and_a_warning_goes_to_standard_error(
    fmus: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = fmus / "GearContact.fmu"
    status = cli.main(["ramp", str(path), "--input", "f", "--to", "-20", "--step", "-10", "--json"])
    out, err = capsys.readouterr()
    assert status == 0
    found = json.loads(out)
    assert found["columns"]["f"] == [0.0, -10.0, -20.0]
    assert found["units"]["K_N"] == "N/m"
    assert err.startswith("warning: f = -10 N is outside [0, inf) N: the force is tensile")
    assert err.count("\n") == 1


COMMAND = "import sys; from jointfmu_tools.cli import main; sys.exit(main(sys.argv[1:]))"


@pytest.mark.parametrize(
    ("part", "reason"),
    [
        ("parameters.toml", "parameters.toml: cannot be read"),
        ("python/slave.py", "slave"),
        ("resources/GearContact_", "GearContact_"),
        ("slavemodule.txt", "slavemodule.txt"),
    ],
)
def test_an_fmu_without_a_resource_fails_with_the_reason(
    fmus: Path, tmp_path: Path, part: str, reason: str
) -> None:
    path = without(fmus / "GearContact.fmu", tmp_path / "broken.fmu", part)
    host = run_host(COMMAND, "ramp", path, *RAMP)
    assert host.returncode in (1, 2), f"crashed with {host.returncode}"
    assert host.stdout == ""
    assert reason in host.stderr
    assert host.stderr.count("\n") == 1, host.stderr
