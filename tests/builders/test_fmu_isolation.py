"""Instances, threads, builds and hosts in one process do not affect each other."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fmu, unpack
from fmpy import platform, sharedLibraryExtension
from jointfmu_fmu_src.building import build_fmus
from jointfmu_fmu_src.python import build as python_build
from jointfmu_tools.run.ramps import ramp

from jointfmu.joints import KINDS, MODELS
from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.parameters import load_default

Host = Callable[..., Fmu]
NAMES = list(MODELS)


def trace(instance: Fmu, name: str, points: int = 10) -> list[dict[str, float]]:
    """Outputs of an FMU along a load ramp, one step per point."""
    driven, end = MODELS[name].ramp.input_name, MODELS[name].ramp.end_value
    found = []
    for value in np.linspace(0.1, 1.0, points) * end:
        found.append(instance.at({driven: float(value)}))
        instance.step()
    return found


# Instances


@pytest.mark.parametrize("name", NAMES)
def test_two_instances_do_not_see_each_other(fmu: Host, name: str) -> None:
    alone = {g: trace(fmu(name).start({"surface.gamma": g}), name) for g in (1.4, 1.6)}
    a, b = fmu(name, instance_name="a"), fmu(name, instance_name="b")
    a.start({"surface.gamma": 1.4})
    b.start({"surface.gamma": 1.6})
    driven, end = MODELS[name].ramp.input_name, MODELS[name].ramp.end_value
    for i, value in enumerate(np.linspace(0.1, 1.0, 10) * end):
        a.set_values({driven: float(value)})
        b.set_values({driven: float(value)})
        b.step()
        assert a.get() == alone[1.4][i]
        assert b.get() == alone[1.6][i]
        a.step()
        b.at({driven: 0.5 * end})
        assert a.get() == alone[1.4][i]
    assert alone[1.4] != alone[1.6]


def test_messages_go_to_the_instance_that_logged_them(fmu: Host) -> None:
    quiet, loud = fmu("GearContact").start(), fmu("GearContact").start()
    loud.at({"f": -1.0})
    quiet.at({"f": 1.0})
    assert len(loud.warnings) == 1
    assert quiet.messages == []


@pytest.mark.parametrize("name", ["GearContact", "BoltedJoint"])
def test_instances_can_be_made_and_freed_repeatedly(fmus: Path, name: str) -> None:
    bystander = Fmu(fmus / f"{name}.fmu").start()
    # numpy sums in another order where memory is aligned otherwise
    expected = [pytest.approx(row, rel=1e-14) for row in trace(bystander, name, 2)]
    for _ in range(10):
        instance = Fmu(fmus / f"{name}.fmu").start()
        assert trace(instance, name, 2) == expected
        instance.free_instance()
    assert trace(bystander, name, 2) == expected
    bystander.free_instance()


def test_many_instances_at_once(fmu: Host) -> None:
    gammas = np.linspace(1.3, 1.7, 20)
    instances = [fmu("GearContact", instance_name=f"gear {g}") for g in gammas]
    for instance, gamma in zip(instances, gammas, strict=True):
        instance.start({"surface.gamma": float(gamma), "f": 900.0})
    stiffness = [instance.get("K_N")["K_N"] for instance in instances]
    alone = [
        GearContactSpring.tabulate(
            load_default("gear_contact").with_values({"surface.gamma": float(g)}, "user", "test").values
        ).evaluate(900.0)["K_N"]
        for g in gammas
    ]
    assert stiffness == pytest.approx([float(k) for k in alone], rel=1e-12)  # the same calls
    assert len(set(stiffness)) == 20


# Threads


def test_threads_with_their_own_instances_give_the_numbers_of_a_serial_run(fmus: Path) -> None:
    jobs = [(name, gamma) for gamma in (1.45, 1.55) for name in NAMES]

    def work(job: tuple[str, float]) -> list[dict[str, float]]:
        name, gamma = job
        instance = Fmu(fmus / f"{name}.fmu", f"{name} {gamma}")
        instance.start({"surface.gamma": gamma})
        found = trace(instance, name)
        instance.reset()
        assert trace(instance.start({"surface.gamma": gamma}), name) == found
        assert instance.messages == []
        instance.free_instance()
        return found

    path, here = list(sys.path), Path.cwd()
    serial = [work(job) for job in jobs]
    with ThreadPoolExecutor(4) as pool:
        parallel = list(pool.map(work, jobs))
    sys.path[:] = path
    assert parallel == serial
    assert Path.cwd() == here  # fmpy goes to each library's folder as it loads


def test_an_instance_may_move_between_threads(fmu: Host) -> None:
    expected = trace(fmu("GearContact").start(), "GearContact")
    instance = fmu("GearContact")
    for _ in range(4):
        with ThreadPoolExecutor(1) as pool:
            assert pool.submit(lambda: trace(instance.start(), "GearContact")).result() == expected
            pool.submit(instance.reset).result()


# Builds of other content


@pytest.fixture(scope="module")
def other_parameters(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("other_parameters")
    for joint in KINDS:
        build_fmus(
            [], ["python"], load_default(joint).with_values({"surface.gamma": 1.6}, "user", "test"), out
        )
    return out / "python"


@pytest.fixture(scope="module")
def doubled_sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sources of a package whose gear contact has twice the stiffness, and its FMUs."""
    out = tmp_path_factory.mktemp("doubled_sources")
    sources = python_build.collect_runtime_sources(KINDS["gear_contact"])
    sources["joints/gear_contact/spring.py"] += """
_single = GearContactSpring.evaluate
GearContactSpring.evaluate = lambda self, f: _single(self, f) | {"K_N": 2.0 * _single(self, f)["K_N"]}
"""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(python_build, "collect_runtime_sources", lambda kind: sources)
        build_fmus(["GearContact", "BoltedJoint"], ["python"], None, out)
    return out / "python"


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_fmus_of_different_builds_live_in_one_process(
    fmu: Host, fmus: Path, other_parameters: Path, doubled_sources: Path, order: tuple[int, ...]
) -> None:
    folders = [fmus, other_parameters, doubled_sources]
    instances: dict[int, Fmu] = {i: fmu("GearContact", folders[i]).start({"f": 900.0}) for i in order}
    K, other, doubled = (instances[i].get("K_N")["K_N"] for i in range(3))
    assert doubled == 2.0 * K
    changed = load_default("gear_contact").with_values({"surface.gamma": 1.6}, "user", "test").values
    expected = float(GearContactSpring.tabulate(changed).evaluate(900.0)["K_N"])
    assert other == pytest.approx(expected, rel=1e-12)  # the same call
    assert abs(other / K - 1.0) > 0.01
    for i in order:  # still so after a reset, which makes a new slave
        instances[i].reset()
        assert instances[i].start({"f": 900.0}).get("K_N")["K_N"] == (K, other, doubled)[i]


def test_one_after_another_in_one_process_too(
    fmus: Path, other_parameters: Path, doubled_sources: Path
) -> None:
    def stiffness(folder: Path) -> float:
        return float(ramp.run_ramp(folder / "GearContact.fmu", "f", 900.0, 900.0).variable_columns["K_N"][-1])

    first = [stiffness(folder) for folder in (fmus, other_parameters, doubled_sources)]
    assert first[2] == 2.0 * first[0]
    assert first[1] != first[0]
    assert [stiffness(f) for f in (doubled_sources, fmus, other_parameters)] == [first[2], *first[:2]]


@pytest.mark.parametrize("name", NAMES)
def test_other_defaults_are_those_of_their_file(fmu: Host, other_parameters: Path, name: str) -> None:
    set_by_hand = fmu(name).start({"surface.gamma": 1.6})
    from_file = fmu(name, other_parameters).start()
    assert trace(from_file, name) == trace(set_by_hand, name)


def test_ramps_leave_the_import_path_as_it_was(fmus: Path) -> None:
    before = list(sys.path)
    ramp.run_ramp(fmus / "GearContact.fmu", "f", 10.0, 10.0)
    with pytest.raises(ValueError, match="e = 2 is outside"):
        ramp.run_ramp(fmus / "GearContact.fmu", "f", 10.0, 10.0, {"e": 2.0})
    assert sys.path == before


# Other hosts

C_LIKE_HOST = '''
"""A host that knows nothing but the C interface: python -I -S, library folder, packages, steps."""
import ctypes, json, pathlib, sys
from ctypes import POINTER, CFUNCTYPE, Structure, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

library, guid, packages, references, values = sys.argv[1:6]
if packages:
    sys.path.append(packages)
log = []
LOGGER = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)


class Callbacks(Structure):
    _fields_ = [
        ("logger", LOGGER), ("allocate", c_void_p), ("free", c_void_p), ("finished", c_void_p),
        ("environment", c_void_p),
    ]


logger = LOGGER(lambda env, name, status, category, text: log.append([status, text.decode()]))
libc = ctypes.CDLL(None)
cast = lambda function: ctypes.cast(function, c_void_p).value
callbacks = Callbacks(logger, cast(libc.calloc), cast(libc.free), None, None)
fmu = ctypes.CDLL(library)
fmu.fmi2Instantiate.restype = c_void_p
resources = (pathlib.Path(library).parent.parent.parent / "resources").as_uri().encode()
component = fmu.fmi2Instantiate(b"host", 1, guid.encode(), resources, byref(callbacks), 0, 1)
if not component:
    print(json.dumps({"log": log}))
    sys.exit(3)
component = c_void_p(component)
references, values = json.loads(references), json.loads(values)
def array(kind, items):
    return (kind * len(items))(*items)
status = [
    fmu.fmi2SetupExperiment(component, 0, c_double(0.0), c_double(0.0), 0, c_double(0.0)),
    fmu.fmi2EnterInitializationMode(component),
    fmu.fmi2SetReal(component, array(c_uint, references[:1]), c_size_t(1), array(c_double, values)),
    fmu.fmi2ExitInitializationMode(component),
    fmu.fmi2DoStep(component, c_double(0.0), c_double(1.0), 1),
]
out = array(c_double, [0.0] * (len(references) - 1))
status.append(fmu.fmi2GetReal(component, array(c_uint, references[1:]), c_size_t(len(out)), out))
status.append(fmu.fmi2Terminate(component))
fmu.fmi2FreeInstance(component)
print(json.dumps({"status": status, "outputs": list(out), "log": log, "modules": sorted(sys.modules)}))
'''


def c_like_host(
    path: Path, packages: Path | None, driven: str, value: float, padding: str = ""
) -> tuple[int, str, dict[str, Any]]:
    """Load and run a python FMU as a C host does: exit status, standard error, and the outputs that the host
    reads."""
    folder, description = unpack(path, path.stat().st_mtime_ns)
    library = Path(folder) / "binaries" / platform / f"{path.stem}{sharedLibraryExtension}"
    listed = {v.name: v.valueReference for v in description.modelVariables}
    references = [listed[driven]]
    references += [v.valueReference for v in description.modelVariables if v.causality == "output"]
    arguments = [str(library), description.guid, str(packages or "")]
    arguments += [json.dumps(references), json.dumps([value]), padding]
    host = subprocess.run(
        [sys.executable, "-I", "-S", "-c", C_LIKE_HOST, *arguments],
        env=os.environ | {"GLIBC_TUNABLES": "glibc.malloc.tcache_count=0"},  # shows a damaged heap
        capture_output=True,
        text=True,
        timeout=100,
    )
    assert host.stdout, host.stderr
    return host.returncode, host.stderr, json.loads(host.stdout)


@pytest.fixture(scope="module")
def only_numpy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of packages that contains numpy and nothing else."""
    folder, numpy = tmp_path_factory.mktemp("packages"), Path(np.__file__).parent
    for found in (numpy, numpy.with_name("numpy.libs")):
        if found.exists():
            (folder / found.name).symlink_to(found, target_is_directory=True)
    return folder


@pytest.mark.parametrize("name", NAMES)
def test_a_host_with_only_numpy_gets_the_numbers(fmu: Host, fmus: Path, only_numpy: Path, name: str) -> None:
    driven, value = MODELS[name].ramp.input_name, MODELS[name].ramp.end_value
    _, _, seen = c_like_host(fmus / f"{name}.fmu", only_numpy, driven, value)
    assert seen["log"] == []
    assert seen["status"] == [0] * 7
    instance = fmu(name).start({driven: value})
    assert dict(zip(instance.outputs, seen["outputs"], strict=True)) == instance.get()
    assert not {m.split(".")[0] for m in seen["modules"]} & {"jointfmu", "jointfmu_fmu_src", "scipy", "fmpy"}


def test_a_host_ends_cleanly(fmus: Path, only_numpy: Path) -> None:
    ends = []
    for length in range(0, 400, 100):  # another layout of the heap each time
        status, errors, seen = c_like_host(fmus / "GearContact.fmu", only_numpy, "f", 900.0, "x" * length)
        assert seen["status"] == [0] * 7
        ends.append((status, errors))
    assert set(ends) == {(0, "")}


@pytest.mark.parametrize("name", NAMES)
def test_a_host_without_numpy_is_told_so(fmus: Path, name: str) -> None:
    r = MODELS[name].ramp
    status, errors, seen = c_like_host(fmus / f"{name}.fmu", None, r.input_name, r.end_value)
    assert (status, errors) == (3, "")
    text = " ".join(message for _, message in seen["log"])
    assert f"{name} needs the Python package numpy" in text
    assert "-m pip install numpy" in text


def test_a_bad_parameter_leaves_a_foreign_host_alive(fmus: Path, only_numpy: Path) -> None:
    _, _, seen = c_like_host(fmus / "GearContact.fmu", only_numpy, "e", 2.0)
    assert seen["status"][3] in (3, 4)  # the end of initialization; pythonfmu knows only fatal
    assert [3, "e = 2 is outside [0, 1): eccentricity of the contact ellipses"] in seen["log"]
