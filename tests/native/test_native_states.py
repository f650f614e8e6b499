"""States of native FMUs: saved, as bytes, after a reset, with other instances and threads."""

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest
from conftest import here_alone, run_host
from joint_cases import NAMES, STATE, TUNED, random_inputs
from jointfmu_fmu_src.building import build_fmus
from natives import VERSIONS, Host, close, numbers, package, settle, slope

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_parameters


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# State


def test_a_state_is_complete(host: Host, name: str, version: str, exchange: bool) -> None:
    first, second = random_inputs(name, 2, seed=27)
    instance = host(name, version, exchange=exchange).start(TUNED[name] | first)
    settle(instance)
    before, state = numbers(instance), instance.fmu.getFMUState()
    for _ in range(2):  # a state can be restored more than once, and is not what the instance works on
        instance.reset()
        instance.start(second)
        settle(instance), settle(instance)
        assert numbers(instance) != before
        instance.fmu.setFMUState(state)
        instance.time = 1.0
        assert numbers(instance) == before
        instance.at(second | {"surface.gamma": 1.7})
        settle(instance)
    instance.fmu.freeFMUState(state)


def test_a_state_as_bytes_goes_into_an_instance_that_was_never_initialized(
    host: Host, name: str, version: str, exchange: bool
) -> None:
    first, second = random_inputs(name, 2, seed=28)
    sender, receiver = (host(name, version, exchange=exchange) for _ in range(2))
    sender.start(TUNED[name] | first)
    settle(sender)
    state = sender.fmu.getFMUState()
    data = sender.fmu.serializeFMUState(state)
    sender.fmu.freeFMUState(state)
    before, gamma = numbers(sender), sender.get("surface.gamma")["surface.gamma"]
    sender.at(second | {"surface.gamma": 1.7})  # they stay two instances
    restored = receiver.fmu.deserializeFMUState(data)
    for _ in range(2):
        receiver.fmu.setFMUState(restored)
        assert numbers(receiver) == before
        assert receiver.at(second) == sender.at({"surface.gamma": gamma})
    assert receiver.fmu.serializeFMUState(restored) == data
    receiver.fmu.setFMUState(restored)
    receiver.fmu.freeFMUState(restored)
    receiver.time = 1.0
    settle(receiver)  # and goes on where the other was
    assert receiver.get() == {k: before[k] for k in receiver.outputs}


def test_what_was_asked_before_does_not_matter(host: Host, name: str, version: str) -> None:
    """Values that an instance stores for other inputs only save time: results do not change by one bit."""
    fresh, used = host(name, version).start(), host(name, version).start()
    asked = random_inputs(name, 60, seed=61)
    swept = [asked[0] | {"s_rel_z": -2e-6 + 4e-9 * k} for k in range(1000)] if name == "BoltedJoint" else []
    for inputs in (*asked, *swept, *reversed(asked)):
        used.at(inputs)
    for inputs in (*asked[::7], *swept[::101]):
        assert fresh.at(inputs) == used.at(inputs)


def test_input_derivatives_belong_to_the_state(host: Host) -> None:
    sender, receiver = (host("GearContact", "fmi2").start({"f": f}) for f in (900.0, 500.0))
    slope(sender, f=100.0)
    data = sender.fmu.serializeFMUState(sender.fmu.getFMUState())
    receiver.fmu.setFMUState(receiver.fmu.deserializeFMUState(data))
    sender.step(), receiver.step()
    assert receiver.get("f") == {"f": 1000.0}
    assert receiver.get() == sender.get()


def test_what_was_warned_of_belongs_to_the_state(host: Host, version: str) -> None:
    instance = host("GearContact", version).start({"f": 900.0})
    inside = instance.fmu.getFMUState()
    instance.at({"f": -5.0})
    outside = instance.fmu.getFMUState()
    as_bytes = instance.fmu.deserializeFMUState(instance.fmu.serializeFMUState(outside))
    for state, count in ((outside, 1), (inside, 2), (inside, 3), (outside, 3), (as_bytes, 3)):
        instance.fmu.setFMUState(state)
        instance.at({"f": -7.0})
        assert len(instance.warnings) == count


def test_a_state_of_a_joint_with_other_parameters_is_refused_by_name(
    host: Host, tmp_path: Path, version: str
) -> None:
    """Both states have the same size; only the instantiation token distinguishes them."""
    file = load_default(MODELS["BoltedJoint"].joint).with_values({"embedding": 800.0}, "user", "test")
    with here_alone(version[-1]):
        build_fmus(["BoltedJoint"], [version], file, tmp_path)
    sender, receiver = host("BoltedJoint", version).start(), host("BoltedJoint", version, tmp_path).start()
    data = sender.fmu.serializeFMUState(sender.fmu.getFMUState())
    before = numbers(receiver)
    assert len(data) == len(receiver.fmu.serializeFMUState(receiver.fmu.getFMUState()))
    said = receiver.refused(receiver.fmu.deserializeFMUState, data)
    sent, own = (fmu.description.guid for fmu in (sender, receiver))
    assert f"a state of another FMU, with the token '{sent}'" in said
    assert f"a state serialized by BoltedJoint with the token {own}" in said
    assert numbers(receiver) == before


def test_a_state_pointer_of_another_fmu_is_refused(host: Host, version: str, exchange: bool) -> None:
    """The state of a GearContact is smaller: BoltedJoint reads only its part before the first variable."""
    bolted, gear = (host(name, version, exchange=exchange).start() for name in ("BoltedJoint", "GearContact"))
    before, foreign = numbers(bolted), gear.fmu.getFMUState()
    sizes = [len(f.fmu.serializeFMUState(f.fmu.getFMUState())) for f in (gear, bolted)]
    assert sizes[0] < sizes[1]
    for call in (bolted.fmu.setFMUState, bolted.fmu.serializeFMUState, bolted.fmu.freeFMUState):
        said = bolted.refused(call, foreign)
        assert said.endswith("was not made by BoltedJoint; expected one that this FMU returned")
        assert numbers(bolted) == before
    gear.fmu.setFMUState(foreign)  # the refusals left it as it was
    gear.fmu.freeFMUState(foreign)


RESTORE = """
import json, sys
from pathlib import Path
from conftest import Fmu
for case in json.load(sys.stdin):
    data = bytes.fromhex(case["state"])
    instance = Fmu(Path(case["path"]), exchange=case["exchange"])
    state = instance.fmu.deserializeFMUState(data)
    assert instance.fmu.serializeFMUState(state) == data
    instance.fmu.setFMUState(state)
    instance.fmu.freeFMUState(state)
    found = [value.hex() for value in instance.get().values()]
    assert found == case["outputs"], (case["path"], found)
    instance.free_instance()
print("same")
"""


def test_another_process_goes_on_with_the_same_bits(host: Host, native: Path, tmp_path: Path) -> None:
    cases = []
    for version in VERSIONS:
        for name in NAMES:
            for exchange in (False, True):
                instance = host(name, version, exchange=exchange)
                instance.start(TUNED[name] | random_inputs(name, 1, seed=29)[0])
                data = instance.fmu.serializeFMUState(instance.fmu.getFMUState())
                outputs = [value.hex() for value in instance.get().values()]
                path = str(native / version / f"{name}.fmu")
                cases.append({"path": path, "exchange": exchange, "state": data.hex(), "outputs": outputs})
    file = tmp_path / "cases.json"
    file.write_text(json.dumps(cases))
    done = run_host(RESTORE.replace("sys.stdin", "open(sys.argv[1])"), file)
    assert (done.returncode, done.stdout) == (0, "same\n"), done.stderr


def test_reset_gives_a_fresh_instance(host: Host, name: str, version: str, exchange: bool) -> None:
    fresh, used = (host(name, version, exchange=exchange) for _ in range(2))
    fresh.start()
    used.start(TUNED[name] | STATE[name])
    settle(used)
    assert numbers(used) != numbers(fresh)
    if version == "fmi2" and not exchange:
        slope(used, **dict.fromkeys(STATE[name], 1.0))
    used.reset()
    assert numbers(used.start()) == numbers(fresh)
    settle(used), settle(fresh)
    assert numbers(used) == numbers(fresh)
    used.reset()
    fresh.reset()
    later = TUNED[name] | STATE[name]
    assert numbers(used.start(later)) == numbers(fresh.start(later))


# Many instances


def test_two_instances_do_not_see_each_other(host: Host, name: str, version: str) -> None:
    one, other = (host(name, version) for _ in range(2))
    one.start(STATE[name])
    before = one.get()
    other.start(TUNED[name] | STATE[name])
    apart, changed = other.get(), package(name, TUNED[name])
    assert apart == close(changed(STATE[name])) != before
    changed = changed.after(STATE[name])
    for inputs in random_inputs(name, 5, seed=30):
        assert other.at(inputs) == close(changed(inputs))
        assert one.get() == before
        settle(other)
        changed = changed.after(inputs)
    other.set_values({"surface.gamma": -1.0})
    other.refused(other.step)
    assert one.get() == before
    other.reset()
    assert one.get() == before


def test_instances_in_parallel_threads_give_the_same_bits(host: Host, name: str, version: str) -> None:
    count, inputs = 8, random_inputs(name, 60, seed=31)
    parameter, value = next(iter(TUNED[name].items()))
    start = flatten_parameters(load_default(MODELS[name].joint).values)[parameter]
    instances = [host(name, version) for _ in range(count)]
    together = Barrier(count)

    def work(i: int) -> list[dict[str, float]]:
        found, instance = [], instances[i]
        together.wait()
        instance.start()
        for k, state in enumerate(inputs):
            if k % 10 == 0:
                instance.set_values({parameter: start + (value - start) * (i + k / 60.0) / count})
            found.append(instance.at(state))
            instance.step()
        return found

    with ThreadPoolExecutor(count) as pool:
        parallel = list(pool.map(work, range(count)))
    together = Barrier(1)
    for i, instance in enumerate(instances):
        instance.reset()
        assert work(i) == parallel[i]
    assert len({json.dumps(one) for one in parallel}) == count  # each had parameters of its own
