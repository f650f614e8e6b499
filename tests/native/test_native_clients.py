"""Native FMUs in other clients than fmpy: CasADi, ecos and libcosim, in processes of their own."""

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from clients import needs
from conftest import Fmu, run_client, run_host, unpack
from joint_cases import CASES, NAMES, STATE, TUNED, law, parameters, random_inputs
from natives import VERSIONS, check_slopes, close, jacobian

from jointfmu.joints import MODELS

ROUND_OFF = 1e-12
"""Round-off that a client may add [1]: CasADi scales by nominal values."""


def check(
    name: str,
    rows: list[list[float]],
    states: list[dict[str, float]],
    changes: Any = None,
    steps: bool = True,
) -> None:
    """Assert that rows of all outputs at states agree with the package.

    steps : the first state is the start, the others are steps; or all are tried after a start without input
    """
    expected, outputs = law(name, parameters(name, changes)), [v.name for v in MODELS[name].outputs]
    expected = expected if steps else expected.after()
    assert len(rows) == len(states)
    for row, state in zip(rows, states, strict=True):
        assert dict(zip(outputs, row, strict=True)) == close(expected(state))
        expected = expected.after(state) if steps else expected


# CasADi: model exchange, the outputs as a function of the inputs, with its derivatives

CASADI = """
import json, sys
import casadi as ca
file, folder = sys.argv[1:]
case = json.load(open(file))
dae = ca.DaeBuilder("fmu", folder, {})
for name, value in case["parameters"].items():
    dae.set(name, value)
f = dae.create("f", ["u"], ["y"])
jacobian, reverse = f.jacobian(), dae.create("reverse", ["u", "adj_y"], ["adj_u"])
rows = []
for u in case["states"]:
    y = f(u)
    rows.append({"y": y.full().ravel().tolist(), "jacobian": jacobian(u, y).full().tolist()})
    rows[-1]["adjoint"] = reverse(u, case["seed"]).full().ravel().tolist()
structure = ca.DM(f.jac_sparsity(0, 0), 1).full().tolist()
names = {"x": dae.x(), "u": dae.u(), "y": dae.y()}
json.dump({**names, "structure": structure, "rows": rows}, open(file, "w"))
"""


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", NAMES)
def test_casadi_evaluates_and_differentiates_it(
    native: Path, tmp_path: Path, name: str, version: str
) -> None:
    path, model = native / version / f"{name}.fmu", MODELS[name]
    inputs, outputs = [v.name for v in model.inputs], [v.name for v in model.outputs]
    folder, _ = unpack(path, path.stat().st_mtime_ns)
    states = [*random_inputs(name, 6, seed=41), dict.fromkeys(inputs, 0.0)]
    seed = list(np.random.default_rng(41).normal(size=len(outputs)))
    changes = {k: v for k, v in TUNED[name].items() if not isinstance(v, bool)}  # CasADi sets no Booleans
    given = [[s[i] for i in inputs] for s in states]
    found = run_client(CASADI, tmp_path, folder, parameters=changes, seed=seed, states=given)
    assert (found["x"], found["u"], found["y"]) == ([], inputs, outputs)
    assert found["structure"] == [[float(i in model.list_dependencies(o)) for i in inputs] for o in outputs]
    check(name, [row["y"] for row in found["rows"]], states, changes, steps=False)
    instance = Fmu(path, exchange=True).start(changes)
    nominal = {v.name: v.nominal for v in (*model.inputs, *model.outputs)}
    for state, row in zip(states, found["rows"], strict=True):
        values, J = instance.at(state), np.array(row["jacobian"])
        exact, sizes = jacobian(instance), STATE[name] | CASES[name].numbers.sizes
        for (o, i), slope in zip(itertools.product(outputs, inputs), J.ravel(), strict=True):
            # CasADi scales its seeds; terms that cancel in a slope are as large as the output over the input,
            # or, where the output is 0, as the sums over springs: far below the nominal values
            scale = max(abs(exact[o, i]), abs(values[o] / sizes[i]), 1e-3 * nominal[o] / nominal[i])
            assert abs(slope - exact[o, i]) <= ROUND_OFF * scale, (o, i)
        terms = np.array(seed)[:, None] * J
        assert np.all(np.abs(row["adjoint"] - terms.sum(axis=0)) <= ROUND_OFF * np.abs(terms).sum(axis=0))
        if not any(state.values()):
            continue
        for k, moved in enumerate(inputs):
            check_slopes(name, state, moved, dict(zip(outputs, J[:, k].tolist(), strict=True)), changes)
    instance.free_instance()


SOLVE = """
import json, sys
import casadi as ca
file, folder = sys.argv[1:]
case = json.load(open(file))
dae = ca.DaeBuilder("fmu", folder, {})
f = dae.create("f", ["u"], ["y"])
phi, tau = ca.MX.sym("phi"), ca.MX.sym("tau")
rest = f(ca.vertcat(0.0, 0.0, phi, 0.0, 293.15))[dae.y().index("tau")] - tau
newton = ca.rootfinder("newton", "newton", {"x": phi, "p": tau, "g": rest}, {"abstol": 1e-12})
found = [float(newton(x0=0.0, p=tau)["x"]) for tau in case["torques"]]
json.dump(found, open(file, "w"))
"""


@pytest.mark.parametrize("version", VERSIONS)
def test_casadi_solves_with_it(native: Path, tmp_path: Path, version: str) -> None:
    path, torques = native / version / "HarmonicDriveSpring.fmu", [0.01, 1.0, -4.0, 25.0]
    folder, _ = unpack(path, path.stat().st_mtime_ns)
    expected = law("HarmonicDriveCompliance", parameters("HarmonicDriveCompliance"))
    found = run_client(SOLVE, tmp_path, folder, torques=torques)
    assert found == close([expected({"tau": tau})["phi_rel"] for tau in torques])


# ecos: co-simulation in FMI 2.0 and 3.0

ECOS = """
import json, sys
from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
from ecospy.EcosParameterSet import EcosParameterSet
file, path = sys.argv[1:]
case = json.load(open(file))
structure, start = EcosSimulationStructure(), EcosParameterSet()
structure.add_model("fmu", path)
for name, value in {**case["parameters"], **case["states"][0]}.items():
    add = start.add_bool if isinstance(value, bool) else start.add_real
    add(f"fmu::{name}", value)
structure.add_parameter_set("start", start)
with EcosSimulation(structure=structure, step_size=0.5) as simulation:
    if not simulation.init(parameter_set="start"):
        sys.exit(EcosLib.get_last_error())
    rows = [[simulation.get_real(f"fmu::{o}") for o in case["outputs"]]]
    for state in case["states"][1:]:
        for name, value in state.items():
            simulation.set_real(f"fmu::{name}", value)
        simulation.step(2)
        rows.append([simulation.get_real(f"fmu::{o}") for o in case["outputs"]])
    assert simulation.get_time() == len(rows) - 1
    simulation.terminate()
json.dump(rows, open(file, "w"))
"""


@needs("ecos")
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", NAMES)
def test_ecos_runs_it(native: Path, tmp_path: Path, name: str, version: str) -> None:
    states, outputs = random_inputs(name, 8, seed=42), [v.name for v in MODELS[name].outputs]
    path = native / version / f"{name}.fmu"
    rows = run_client(ECOS, tmp_path, path, parameters=TUNED[name], states=states, outputs=outputs)
    check(name, rows, states, TUNED[name])


COUPLED = """
import json, sys
from ecospy import EcosSimulation, EcosSimulationStructure
from ecospy.EcosParameterSet import EcosParameterSet
file, folder = sys.argv[1:]
structure, start = EcosSimulationStructure(), EcosParameterSet()
structure.add_model("load", f"{folder}/fmi3/HarmonicDriveCompliance.fmu")
structure.add_model("drive", f"{folder}/fmi2/HarmonicDriveSpring.fmu")
structure.make_real_connection("load::phi_rel", "drive::phi2")
start.add_real("load::tau", 4.0)
structure.add_parameter_set("start", start)
with EcosSimulation(structure=structure, step_size=1.0) as simulation:
    assert simulation.init(parameter_set="start")
    simulation.step(3)
    found = {name: simulation.get_real(name) for name in ("load::phi_rel", "drive::phi_rel", "drive::tau")}
json.dump(found, open(file, "w"))
"""


@needs("ecos")
def test_ecos_connects_two_versions_of_the_standard(native: Path, tmp_path: Path) -> None:
    found = run_client(COUPLED, tmp_path, native)
    assert found["drive::phi_rel"] == found["load::phi_rel"] > 0.0
    assert found["drive::tau"] == close(4.0)


# libcosim: co-simulation in FMI 2.0

COSIM = """
import json, sys
from libcosimpy.CosimEnums import CosimExecutionState
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
file, path = sys.argv[1:]
case = json.load(open(file))
execution = CosimExecution.from_step_size(step_size=1e9)
one = execution.add_local_slave(CosimLocalSlave(fmu_path=path, instance_name="fmu"))
observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
assert execution.add_observer(observer) and execution.add_manipulator(manipulator)
reference = {v.name.decode(): v.reference for v in execution.slave_variables(one)}
for name, value in {**case["parameters"], **case["states"][0]}.items():
    give = execution.boolean_initial_value if isinstance(value, bool) else execution.real_initial_value
    assert give(one, reference[name], value), name
rows = []
for state in case["states"]:
    manipulator.slave_real_values(one, [reference[name] for name in state], list(state.values()))
    if not execution.step():
        assert execution.status().state == CosimExecutionState.ERROR.value
        rows.append("refused")
        break
    rows.append(list(observer.last_real_values(one, [reference[o] for o in case["outputs"]])))
json.dump(rows, open(file, "w"))
"""


@needs("libcosim")
@pytest.mark.parametrize("name", NAMES)
def test_libcosim_runs_it(native: Path, tmp_path: Path, name: str) -> None:
    states, outputs = random_inputs(name, 8, seed=43), [v.name for v in MODELS[name].outputs]
    path = native / "fmi2" / f"{name}.fmu"
    rows = run_client(COSIM, tmp_path, path, parameters=TUNED[name], states=states, outputs=outputs)
    check(name, rows, states, TUNED[name])


@needs("libcosim")
def test_libcosim_stops_with_the_reason_that_the_fmu_gives(native: Path, tmp_path: Path) -> None:
    file, states = tmp_path / "case.json", [{"f": 900.0}, {"f": float("nan")}, {"f": 900.0}]
    file.write_text(json.dumps({"parameters": {}, "states": states, "outputs": ["s_rel"]}))
    done = run_host(COSIM, file, native / "fmi2" / "GearContact.fmu")
    assert done.returncode == 0, done.stderr
    first, second = json.loads(file.read_text())
    assert first == close([law("GearContact", parameters("GearContact"))({"f": 900.0})["s_rel"]])
    assert second == "refused"
    assert "f = nan N is outside (-inf, inf): normal load of the tooth contact" in done.stdout + done.stderr
