"""The Modelica library: its text, and what rumoca and pymoca make of it.

Neither brings the Modelica Standard Library. `tests/modelica/Modelica` stands in for the part that is used,
with the same names, signs and equations; for rumoca JOINTFMU_MSL may name a folder that holds the package
itself.
"""

import json
import math
import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jointfmu_fmu_src.partners import load_partner_parameters as partner_parameters
from jointfmu_tools.cli import main
from jointfmu_tools.exchange.modelica import library, records
from jointfmu_tools.exchange.modelica.records import make_identifier
from jointfmu_tools.joints.bolted_joint import modelica as bolted_modelica
from numpy.typing import NDArray
from read_modelica import Read, read, solution

from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.contact import elastic_shear
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, JointInputs
from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import format_parameter_file, load_default
from jointfmu.quantity import replace_values

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]

REPOSITORY = Path(__file__).parents[2]
COMMITTED = REPOSITORY / "models/modelica"
STAND_IN = Path(__file__).parent
MSL = Path(os.environ.get("JOINTFMU_MSL", STAND_IN))
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
EXACT = 2e-7  # twice the tolerance of the tables: the package's own is 1e-8


@pytest.fixture(scope="module")
def files() -> dict[str, str]:
    return library.render_library()


@pytest.fixture(scope="module")
def rumoca() -> Any:
    import rumoca

    return rumoca


@pytest.fixture(scope="module")
def drive() -> HarmonicDriveSpring:
    return HarmonicDriveSpring.tabulate(load_default("harmonic_drive").values)


@pytest.fixture(scope="module")
def bolted() -> BoltedJointSpring:
    return BoltedJointSpring.from_joint(load_default("bolted_joint").values)


@pytest.fixture(scope="module")
def gear() -> GearContactSpring:
    return GearContactSpring.tabulate(load_default("gear_contact").values)


def simulate(
    rumoca: Any, text: str, stop: float, step: float, written: Path = COMMITTED, rtol: float = 1e-10
) -> Any:
    """Simulate `model Top` of a text; the library is loaded if the text names it."""
    session = rumoca.Session(roots=[str(MSL), str(written)])
    model = session.loads(text, model="Top", filename="Top.mo")
    return model.simulate(t=(0.0, stop), dt=step, config=rumoca.SimConfig(rtol=rtol, atol=1e-4 * rtol))


def top(body: str, equations: str = "", before: str = "") -> str:
    declared = f"{before}\nmodel Top\n  extends Modelica.Icons.Example;\n  {body}\n"
    return f"{declared}equation\n  {equations}\nend Top;\n"


def move(domain: str, angle: str) -> str:
    """Text of a flange that moves at a constant rate."""
    return f"""
model Move
  parameter Real at = 0;
  parameter Real rate = 0;
  Modelica.Mechanics.{domain}.Interfaces.Flange_b flange;
equation
  flange.{angle} = at + rate*time;
end Move;
"""


# ---- the text ----


@pytest.mark.parametrize(
    ("block", "fmu"), [("Load", "TorqueProfile"), ("Load", "ForceProfile"), ("AngleProfile", "AngleProfile")]
)
def test_partners_have_the_defaults_of_their_fmus(files: dict[str, str], block: str, fmu: str):
    text = files[f"Components/{block}.mo"]
    stated = re.findall(r"^  parameter .*? (\w+)(?:\(.*?\))?=(\S+) ", text.partition("protected")[0], re.M)
    assert {name: float(value) for name, value in stated} == partner_parameters(fmu).values_by_name


def test_the_committed_library_is_what_the_generator_writes(files: dict[str, str]):
    root = COMMITTED / library.LIBRARY_NAME
    assert {str(p.relative_to(root)) for p in root.rglob("*") if p.is_file()} == set(files)
    for name, text in files.items():
        committed = (root / name).read_text(encoding="utf-8")
        assert NUMBER.sub("#", committed) == NUMBER.sub("#", text), name
        one, other = (np.array([float(x) for x in NUMBER.findall(t)]) for t in (committed, text))
        # other processors round differently; a node's load may be a difference of larger ones
        assert np.allclose(one, other, rtol=1e-9, atol=1e-9), name


def test_every_class_stands_in_the_order_of_its_package(files: dict[str, str]):
    for name, text in files.items():
        folder, _, leaf = name.rpartition("/")
        if leaf == "package.order":
            listed = text.split()
            prefix = f"{folder}/" if folder else ""
            here = {n[len(prefix) :] for n in files if n.startswith(prefix)}
            found = {n.removesuffix(".mo") for n in here if "/" not in n} | {
                n.split("/")[0] for n in here if "/" in n
            }
            assert sorted(listed) == sorted(found - {"package", "package.order"}), name
        else:
            within = ".".join([library.LIBRARY_NAME, *folder.split("/")]) if folder else ""
            own = folder.split("/")[-1] or library.LIBRARY_NAME
            if leaf == "package.mo":
                within = within.rpartition(".")[0]
            assert text.startswith(f"within {within};")
            assert text.rstrip().endswith(f"end {own if leaf == 'package.mo' else leaf.removesuffix('.mo')};")


def test_every_component_has_an_icon_and_documentation(files: dict[str, str]):
    for name, text in files.items():
        if name.startswith(("Components/", "Wrappers/", "Interfaces/")) and not name.endswith(
            ("package.mo", "order")
        ):
            assert "Icon(graphics=" in text, name
            assert "Documentation(info=" in text, name


def test_tables_of_examples_name_what_the_model_has(files: dict[str, str]):
    def list_names(path: str) -> set[str]:
        return set(re.findall(r"parameter [\w.]+ (\w+)", files.get(path, "")))

    for name, text in files.items():
        if not name.startswith("Examples/") or name.endswith(("package.mo", "order")):
            continue
        classes = {c: k for k, c in re.findall(r"^  (\w+(?:\.\w+)+) (\w+)\(", text, re.M)}
        rows = re.findall(r"<td><code>(\w+)\.([\w.]+)(?:\[\d+\])?</code>", text)
        assert rows
        for component, parameter in rows:
            base = classes[component].rpartition(".")[2]
            own = list_names(f"Components/{base}.mo") | {"Inertia": {"J"}, "Mass": {"m"}}.get(base, set())
            assert parameter in own | {f"data.{n}" for n in list_names(f"Data/{base}.mo")}, component


def test_interfaces_have_the_variables_of_the_fmu(files: dict[str, str]):
    pattern = re.compile(r'Real(Input|Output) (\w+)\(unit="([^"]*)"')
    for name, model in MODELS.items():
        found = pattern.findall(files[f"Interfaces/{name}.mo"])
        assert [(n, u) for kind, n, u in found if kind == "Input"] == [(v.name, v.unit) for v in model.inputs]
        assert [(n, u) for kind, n, u in found if kind == "Output"] == [
            (v.name, v.unit) for v in model.outputs
        ]


def test_wrappers_connect_every_input_once(files: dict[str, str]):
    for name, model in MODELS.items():
        text = files[f"Wrappers/{name}.mo"]
        for v in model.inputs:
            assert len(re.findall(rf"fmu\.{v.name}\b", text)) == 1, f"{name}.{v.name}"


# ---- tables ----


@pytest.mark.parametrize("kind", ["drive", "gear"])
def test_a_thinned_curve_keeps_load_and_stiffness(kind: str, request: pytest.FixtureRequest):
    curve = request.getfixturevalue(kind).curve
    table = records.decimate_curve(curve)
    assert table.table_rows.shape[0] < curve.displacement.size / 3
    x = np.linspace(curve.displacement[0], 1.1 * curve.end_point[0], 20001)[1:]
    for exact, rough in zip(
        curve.derivatives(x), records.make_curve_of_table(table).derivatives(x), strict=True
    ):
        assert np.all(np.abs(rough - exact) <= EXACT * np.abs(exact))


def test_one_total_stands_for_all_nodes_of_the_bolted_joint(bolted: BoltedJointSpring):
    joint = bolted_modelica.combine_nodes_to_spring(bolted, 15e3, 4500.0)
    total = records.make_curve_of_table(joint.force_table)
    preload = 15e3 * bolted.joint.n_bolts
    rest = bolted.evaluate(15e3, 4500.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    for s_z in (-5e-6, -1e-6, -1e-7, 0.0, 1e-7, 1e-6, 5e-6, 2e-5, 4e-5):
        exact = bolted.evaluate(15e3, 4500.0, (0.0, 0.0, s_z), (0.0, 0.0, 0.0))
        load, stiffness = (float(x) for x in total.derivatives(-s_z))
        assert load == pytest.approx(exact["f_z"], abs=EXACT * max(preload, abs(exact["f_z"])))
        assert stiffness == pytest.approx(exact["K_zz"], abs=EXACT * max(rest["K_zz"], exact["K_zz"]))
        eta = np.interp(-s_z, *joint.dissipation_factor_table.T)
        assert eta == pytest.approx(exact["eta_n"], rel=2.0 * bolted_modelica.DISSIPATION_FACTOR_TOLERANCE)


@pytest.mark.parametrize("preload", [0.0, -1.0, math.nan, 1e9])
def test_a_preload_outside_the_law_is_refused(bolted: BoltedJointSpring, preload: float):
    with pytest.raises(ValueError, match=r"preload = .* N per bolt"):
        bolted_modelica.combine_nodes_to_spring(bolted, preload, 0.0)


# ---- the command ----


def test_command_writes_the_library_of_another_joint(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """The library has the record of the stated drive, and the bolted joint under the stated preload."""
    file = load_default("harmonic_drive").with_values({"ratio": 50.0}, "user", "test")
    params = tmp_path / "mine.toml"
    params.write_text(format_parameter_file(file).replace(file.name, "my drive, 50:1"), encoding="utf-8")
    loaded = ["--preload", "20e3", "--moment", "100"]
    words = ["modelica", "--params", str(params), *loaded, "--out", str(tmp_path / "out"), "--json"]
    assert main(words) == 0
    written = [Path(p) for p in json.loads(capsys.readouterr().out)["written"]]
    record = tmp_path / "out/JointStiffness/Data/My_drive_50_1.mo"
    assert record in written
    assert "final ratio=50," in record.read_text(encoding="utf-8")
    component = tmp_path / "out/JointStiffness/Components/HarmonicDriveSpring.mo"
    assert "JointStiffness.Data.My_drive_50_1()" in component.read_text(encoding="utf-8")
    names = {p.name for p in (tmp_path / "out/JointStiffness/Data").glob("Box*")}
    assert names == {"Box_specimen_of_Zhao_2018_20_kN_100_Nm.mo"}


def test_command_takes_the_preload_of_the_file(tmp_path: Path):
    """The record of the file's preload comes first and is the component's default; the shipped systems keep
    their records."""
    text = format_parameter_file(load_default("bolted_joint")).replace(
        "preload = { value = 0.0", "preload = { value = 43.1e3"
    )
    params = tmp_path / "plate.toml"
    params.write_text(text, encoding="utf-8")
    assert main(["modelica", "--params", str(params), "--out", str(tmp_path)]) == 0
    names = {p.stem for p in (tmp_path / "JointStiffness/Data").glob("Box*")}
    own = "Box_specimen_of_Zhao_2018_43_1_kN"
    assert names == {own, *(f"Box_specimen_of_Zhao_2018_{at}" for at in ("9_kN", "15_kN", "15_kN_4500_Nm"))}
    component = (tmp_path / "JointStiffness/Components/BoltedJoint.mo").read_text(encoding="utf-8")
    assert f"data = JointStiffness.Data.{own}()" in component


def test_components_leave_the_choice_of_states_to_the_tool(files: dict[str, str]):
    """No component has `stateSelect = prefer`: with a held motor, OpenModelica would choose states without an
    equation."""
    for name, text in files.items():
        default = re.search(r"parameter StateSelect stateSelect=(.*?) \"", text)
        assert default is None or default.group(1) == "StateSelect.default", name
        assert not name.startswith("Examples/") or "StateSelect" not in text, name


def test_no_equation_sums_over_a_function_that_returns_an_array(files: dict[str, str]):
    """No equation has a sum over a function call that returns an array.

    Tools expand such a sum to one call for each entry: 44 calls for each drive and evaluation.
    """
    for name, text in files.items():
        assert not re.search(r"(sum|max|min)\(JointStiffness\.Functions\.", text), name


def test_the_parts_of_a_sliders_path_read_no_array(files: dict[str, str]):
    inner = files["Functions/slide.mo"].partition("for i in 1:parts loop")[2].partition("end for;")[0]
    assert "carries" in inner
    assert "[" not in inner


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["--moment", "1"], "--moment needs --preload"), (["--preload", "-5"], "preload = -5 N")],
)
def test_command_refuses(arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["modelica", *arguments, "--out", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err


# ---- pymoca: reads and flattens ----


def test_pymoca_reads_every_file_and_flattens_every_model():
    from pymoca import ast, parser, tree

    root = parser.parse((STAND_IN / "Modelica/package.mo").read_text(encoding="utf-8"))
    for path in sorted(COMMITTED.rglob("*.mo"), key=lambda p: (len(p.parts) - (p.name == "package.mo"), p)):
        read = parser.parse(path.read_text(encoding="utf-8"))
        assert read is not None, path
        root.extend(read)
    # variables and equations of the flat model; an if- or when-equation counts as one
    expected = {"Examples.RobotJoint": (139, 52), "Examples.BoltedColumn": (102, 48)}
    for path in sorted(COMMITTED.rglob("*.mo")):
        folder, name = path.parent.name, path.stem
        if folder in ("Components", "Wrappers", "Examples") and name != "package":
            full = f"{library.LIBRARY_NAME}.{folder}.{name}"
            flat = tree.flatten(root, ast.ComponentRef.from_string(full)).classes[full]
            assert flat.equations, full
            if f"{folder}.{name}" in expected:
                counts = len(flat.symbols), len(flat.equations)
                assert counts == expected[f"{folder}.{name}"], f"{full}: symbols and equations"


# ---- rumoca: flattens and simulates ----


def test_rumoca_finds_no_error_in_any_file(rumoca: Any):
    for path in sorted(COMMITTED.rglob("*.mo")):
        text = path.read_text(encoding="utf-8")
        syntax = [
            d for d in rumoca.validate_source(text, filename=path.name) if "parse" in str(d.rule).lower()
        ]
        assert not syntax, (path, syntax)
        rumoca.format(text, filename=path.name)  # raises where it cannot be parsed


def test_drive_component_gives_the_torque_of_the_package(rumoca: Any, drive: HarmonicDriveSpring):
    reach = 1.2 * drive.curve.end_point[0]  # beyond the table on both sides
    text = top(
        "JointStiffness.Components.HarmonicDriveSpring drive(d=0);\n"
        f"  Move motor;\n  Move load(at={-reach!r}, rate={2.0 * reach!r});",
        "connect(motor.flange, drive.flange_a);\n  connect(drive.flange_b, load.flange);",
        move("Rotational", "phi"),
    )
    found = simulate(rumoca, text, 1.0, 4e-3)
    phi = reach * (2.0 * found.time - 1.0)
    exact = drive.evaluate_motion(0.0, 0.0, phi, 0.0)
    for name, mine in (("tau", "tau"), ("K_WTS", "K_WTS"), ("K_TS", "K_TS")):
        # K_TS is a difference of compliances: its error grows by K_TS/K_WTS, at most 2
        factor = 2.5 if name == "K_TS" else 1.0
        inside = np.abs(phi) > 1e-12
        relative = np.abs(found[f"drive.{mine}"] / np.where(inside, exact[name], 1.0) - 1.0)[inside]
        assert relative.max() <= factor * EXACT, name
    assert np.array_equal(found["drive.flange_a.tau"], -found["drive.tau"] / drive.joint.ratio)


def test_drive_component_errs_as_the_package(rumoca: Any, drive: HarmonicDriveSpring):
    error = {"error_1": 3e-5, "error_1_phase": 0.7, "error_2": 2e-4, "error_4": 5e-5, "error_4_phase": 2.0}
    given = "".join(f", {name}={value!r}" for name, value in error.items())
    text = top(
        f"JointStiffness.Components.HarmonicDriveSpring drive(ratio=-100{given});\n"
        "  Move motor(at=0, rate=9);\n  Move load(at=0, rate=-0.09);",
        "connect(motor.flange, drive.flange_a);\n  connect(drive.flange_b, load.flange);",
        move("Rotational", "phi"),
    )
    found = simulate(rumoca, text, 1.0, 4e-3)
    turned = replace(drive, joint=replace(drive.joint, ratio=-100.0, **error))
    exact = turned.evaluate_motion(9.0 * found.time, 9.0, -0.09 * found.time, -0.09)
    for name, mine in (("phi_error", "phi_error"), ("tau", "tau"), ("tau1", "flange_a.tau")):
        sign = -1.0 if name == "tau1" else 1.0
        wrong = np.abs(sign * found[f"drive.{mine}"] - exact[name]).max()
        assert wrong <= 1e-6 * np.abs(exact[name]).max(), name  # as the table errs


def test_drive_without_damping_and_inertia_is_its_own_inverse(rumoca: Any, drive: HarmonicDriveSpring):
    """Locked motor and prescribed torque with d = 0: with a damper the speed would be a division by zero."""
    body = (
        "Modelica.Mechanics.Rotational.Components.Fixed motor;\n"
        "  Modelica.Mechanics.Rotational.Sources.Torque torque;\n"
        "  JointStiffness.Components.HarmonicDriveSpring drive(d=0, use_damping=false);"
    )
    equations = (
        "connect(motor.flange, drive.flange_a);\n  connect(drive.flange_b, torque.flange);\n"
        "  torque.tau = 5*time;"
    )
    found = simulate(rumoca, top(body, equations), 1.0, 1e-2)
    late = found.time > 0.1
    given = drive.evaluate_motion(0.0, 0.0, found["drive.phi_rel"][late], 0.0)
    # 1e-6: of the nonlinear equation that the tool solves
    assert -given["tau2"] == pytest.approx(5.0 * found.time[late], rel=1e-6)


def test_gear_component_gives_the_force_of_the_package(rumoca: Any, gear: GearContactSpring):
    text = top(
        "JointStiffness.Components.GearContact gear;\n  Move one;\n  Move other(at=4e-7, rate=-4e-6);",
        "connect(one.flange, gear.flange_a);\n  connect(gear.flange_b, other.flange);",
        move("Translational", "s"),
    )
    found = simulate(rumoca, text, 1.0, 4e-3)
    approach = 4e-6 * found.time - 4e-7
    load, stiffness = gear.curve.derivatives(approach + gear.curve.displacement[0])
    area = gear.joint.A_0
    assert np.all(found["gear.f"][approach < 0.0] == 0.0)
    assert np.all(np.abs(found["gear.f"] + area * load) <= EXACT * area * load + 1e-12)
    assert np.all(np.abs(found["gear.K_N"] - area * stiffness) <= EXACT * area * stiffness + 1e-3)


def test_bolted_component_gives_the_forces_of_the_package(rumoca: Any, bolted: BoltedJointSpring):
    """Forces without history agree far below the friction limit, which the FMU has for each of its nodes."""
    s, v = (0.0, -2e-9, -4e-6), (2e-6, -1e-6, 6e-3)
    flags = {"memory": False, "damping": True, "plastic_damping": True}
    plastic = BoltedJointSpring.from_interface_nodes(replace_values(bolted.joint, flags))
    record = make_identifier(f"{load_default('bolted_joint').name} 15 kN 4500 Nm")
    body = (
        f"JointStiffness.Components.BoltedJoint joint(data=JointStiffness.Data.{record}(), "
        "memory=false, damping=true, plastic_damping=true);"
    )
    body += "".join(
        f"\n  Move m{a}(at={at!r}, rate={rate!r});" for a, at, rate in zip("xyz", s, v, strict=True)
    )
    wires = "\n  ".join(f"connect(joint.flange_{a}, m{a}.flange);" for a in "xyz")
    found = simulate(rumoca, top(body, wires, move("Translational", "s")), 2e-3, 1e-4)
    scale = 15e3 * bolted.joint.n_bolts
    for k, t in enumerate(found.time):
        x, y, z = (at + rate * t for at, rate in zip(s, v, strict=True))
        exact = plastic.evaluate(15e3, 4500.0, (x, y, z), v)
        damping = max(abs(exact["C_zz"] * v[2]), 1.0)
        for i, axis in enumerate("xyz"):
            error = abs(found[f"joint.f[{i + 1}]"][k] - exact[f"f_{axis}"])
            allowed = EXACT * scale + (
                2.0 * bolted_modelica.DISSIPATION_FACTOR_TOLERANCE * damping if axis == "z" else 0.0
            )
            assert error <= allowed, (axis, t, found[f"joint.f[{i + 1}]"][k], exact[f"f_{axis}"])


@pytest.mark.parametrize("temperature", [293.15, 343.15])
def test_bolts_of_the_component_lift_off_as_those_of_the_package(
    rumoca: Any, tmp_path: Path, temperature: float
):
    """Rows lift off one after the other, as the moment loads them unevenly. Stiff bolts, so that the contact
    is far from its end. Warm bolts have more preload: the members expand more."""
    values = {
        "bolt_stiffness": 1e10,
        "plate_stiffness": 1e9,
        "side1.alpha": 2e-6,
        "side1.clamped_length": 0.02,
    }
    file = load_default("bolted_joint").with_values(values, "user", "test")
    params, stated = tmp_path / "stiff.toml", ["--preload", "15e3", "--moment", "4500"]
    stated += ["--temperature", str(temperature)] if temperature != 293.15 else []
    params.write_text(format_parameter_file(file), encoding="utf-8")
    assert main(["modelica", "--params", str(params), *stated, "--out", str(tmp_path)]) == 0
    body = "JointStiffness.Components.BoltedJoint joint(memory=false, damping=false);"
    body += "\n  Move mx; Move my; Move mz(at=1e-6, rate=-4e-6);"
    wires = "\n  ".join(f"connect(joint.flange_{a}, m{a}.flange);" for a in "xyz")
    found = simulate(rumoca, top(body, wires, move("Translational", "s")), 1.0, 2e-2, written=tmp_path)
    spring = BoltedJointSpring.from_interface_nodes(replace(file.values, memory=False))
    still = (0.0,) * 3
    exact = [
        spring.evaluate(15e3, 4500.0, (0.0, 0.0, z), still, temperature=temperature)["f_z"]
        for z in 1e-6 - 4e-6 * found.time
    ]
    np.testing.assert_allclose(found["joint.f[3]"], exact, rtol=EXACT, atol=EXACT * 8 * 15e3)
    least = [found[f"joint.pull[{j + 1}]"].min() for j in range(8)]
    gain = (temperature - 293.15) * 2e-6 * 0.02 / (1e-10 + 1e-9)
    forces = np.array([20e3] * 3 + [15e3] * 2 + [10e3] * 3) + gain
    np.testing.assert_allclose(least, -forces, rtol=1e-9)


def test_elastic_shear_of_the_bolted_component_is_that_of_the_package(rumoca: Any, bolted: BoltedJointSpring):
    """The elastic shear force without history agrees while the load changes, where the linear force would
    exceed twice the limit."""
    body = "JointStiffness.Components.BoltedJoint joint(memory=false, damping=false);"
    rates = (6e-6, -4e-6, -5e-7)
    body += "".join(f"\n  Move m{a}(at=0.0, rate={v!r});" for a, v in zip("xyz", rates, strict=True))
    wires = "\n  ".join(f"connect(joint.flange_{a}, m{a}.flange);" for a in "xyz")
    found = simulate(rumoca, top(body, wires, move("Translational", "s")), 1.0, 1e-2)
    total = bolted_modelica.combine_nodes_to_spring(bolted, 9e3, 0.0)
    limit = bolted.joint.mu * total.preload_contact_force
    u = (found["joint.s_rel[1]"], found["joint.s_rel[2]"])
    assert np.max(np.hypot(*u) * found["joint.K_t"]) > 2.0 * limit
    curve = [found[f"joint.{name}"] for name in ("G", "K_n", "bend")]
    x, y, *_, lifted, _ = elastic_shear(limit, total.shear_stiffness_ratio, [*curve, 0.0 * u[0]], *u)
    for name, force in (("f[1]", x), ("f[2]", y)):
        np.testing.assert_allclose(found[f"joint.{name}"], -force, rtol=0.0, atol=EXACT * limit)
    normal = found["joint.G"] - total.preload_contact_force + lifted
    np.testing.assert_allclose(found["joint.f[3]"], normal, rtol=0.0, atol=EXACT * limit)


_CIRCLE = """
model Circle
  Modelica.Mechanics.Translational.Interfaces.Flange_b x, y, z;
equation
  x.s = 8e-7*sin(6.283185307179586*time);
  y.s = 4e-7*(1 - cos(6.283185307179586*time));
  z.s = -6e-7*sin(12.566370614359172*time);
end Circle;
"""


def test_bolted_component_slips_as_the_package(rumoca: Any, bolted: BoltedJointSpring):
    """One and a half turns of an ellipse while the normal force changes by a fifth. The remaining difference
    comes from number and positions of the sliders, and from the package's steps."""
    body = "JointStiffness.Components.BoltedJoint joint;\n  Circle way;\n  Real loss(start=0, fixed=true);"
    wires = " ".join(f"connect(joint.flange_{a}, way.{a});" for a in "xyz")
    found = simulate(
        rumoca, top(body, f"{wires}\n  der(loss) = joint.lossPower;", _CIRCLE), 1.5, 1e-2, rtol=1e-6
    )
    first = np.unique(found.time, return_index=True)[1]
    memory, preload, rows = bolted.initial_history(), 9e3, []  # of the component's own record
    limit = bolted.joint.mu * preload * bolted.joint.n_bolts
    for x, y, z in zip(*(found[f"joint.s_rel[{i}]"][first] for i in (1, 2, 3)), strict=True):
        inputs = JointInputs(preload, 0.0, np.array([x, y, z, 0.0, 0.0, 0.0]))
        out, memory = bolted.advance(inputs, memory)
        rows.append([out["f_x"], out["f_y"], out["f_z"], out["E_loss"]])
    exact = np.array(rows).T
    for i in (1, 2):
        assert np.abs(exact[i - 1]).max() > 0.4 * limit
        assert np.abs(found[f"joint.f[{i}]"][first] - exact[i - 1]).max() < 0.02 * limit
    # the component sums up all nodes; the points are within 1e-6 of that sum (docs/fields_explanation.md)
    apart = np.abs(found["joint.f[3]"][first] - exact[2]).max()
    assert apart < (EXACT + 1e-6) * preload * bolted.joint.n_bolts
    assert np.all(np.diff(found["loss"]) >= 0.0)
    assert found["loss"][-1] == pytest.approx(exact[3, -1], rel=0.02)


def test_the_bolted_component_read_by_another_parser_holds_along_the_solution(rumoca: Any):
    """All equations as pymoca reads them, at the solution of rumoca; states by the trapezoidal rule over the
    corners."""
    body = "JointStiffness.Components.BoltedJoint joint;\n  Circle way;"
    wires = " ".join(f"connect(joint.flange_{a}, way.{a});" for a in "xyz")
    found = simulate(rumoca, top(body, wires, _CIRCLE), 0.7, 4e-3, rtol=1e-6)
    times, first = np.unique(found.time, return_index=True)
    record = make_identifier(f"{load_default('bolted_joint').name} 9 kN")
    seen, root = solution(found, "joint", first), read(STAND_IN, COMMITTED)
    errors = Read(root, "BoltedJoint", record, times, seen, {}).errors()
    states = {"der(s_rel)"}
    assert states == {name for name in errors if name.startswith("der(")}  # no slider is a state
    assert max(error for name, error in errors.items() if name not in states) < 1e-12  # round-off
    assert max(errors[name] for name in states) < 0.01


def test_joints_with_the_law_roughness_give_the_forces_of_the_package(rumoca: Any, tmp_path: Path):
    bolted, gear = (load_default(joint, "roughness") for joint in ("bolted_joint", "gear_contact"))
    library.write_library(tmp_path, bolted, {"bolted_joint": [(9e3, 0.0, 293.15)]})
    record = make_identifier(f"{bolted.name} 9 kN")
    body = f"JointStiffness.Components.BoltedJoint joint(data=JointStiffness.Data.{record}(), memory=false);"
    at, rate = (0.0, 0.0, -1e-6), (2e-7, -1e-7, 1e-3)
    body += "".join(f"\n  Move m{a}(at={x!r}, rate={v!r});" for a, x, v in zip("xyz", at, rate, strict=True))
    wires = "\n  ".join(f"connect(joint.flange_{a}, m{a}.flange);" for a in "xyz")
    found = simulate(rumoca, top(body, wires, move("Translational", "s")), 2e-3, 1e-4, tmp_path)
    spring = BoltedJointSpring.from_joint(replace_values(bolted.values, {"memory": False}))
    for k, t in enumerate(found.time):
        exact = spring.evaluate(9e3, 0.0, tuple(x + v * t for x, v in zip(at, rate, strict=True)), rate)
        for i, axis in enumerate("xyz"):
            assert found[f"joint.f[{i + 1}]"][k] == pytest.approx(exact[f"f_{axis}"], abs=2.0 * EXACT * 72e3)
    library.write_library(tmp_path / "gear", gear)
    text = top(
        "JointStiffness.Components.GearContact gear;\n  Move one;\n  Move other(at=4e-7, rate=-4e-6);",
        "connect(one.flange, gear.flange_a);\n  connect(gear.flange_b, other.flange);",
        move("Translational", "s"),
    )
    found = simulate(rumoca, text, 0.5, 1e-2, tmp_path / "gear")
    contact = GearContactSpring.tabulate(gear.values)
    load = contact.curve.derivatives(4e-6 * found.time - 4e-7 + contact.curve.displacement[0])[0]
    assert np.all(np.abs(found["gear.f"] + contact.joint.A_0 * load) <= EXACT * load + 1e-12)


_BLOCK = """
block StandIn "The contract of the FMU, by the table"
  extends JointStiffness.Interfaces.HarmonicDriveSpring;
  parameter JointStiffness.Data.HarmonicDrive data = JointStiffness.Data.{record}();
equation
  phi_rel = phi2 - phi1/data.ratio;
  tau = (if phi_rel < 0 then -1 else 1)*JointStiffness.Functions.load(abs(phi_rel), data.table)
    + data.d*(w2 - w1/data.ratio);
  tau1 = tau/data.ratio;
  tau2 = -tau;
  {zeros}
end StandIn;
"""
_BLOCK_OUTPUTS = ("phi_rel", "tau", "tau1", "tau2")
"""Outputs that the block computes; the other outputs are zero."""


def test_wrapper_moves_as_the_component(rumoca: Any):
    """Signs of the adaptors: the wrapper contains a block with the FMU's signs, and is compared with the
    component."""
    inertia = "Modelica.Mechanics.Rotational.Components.Inertia"
    body = "\n  ".join(
        [
            "JointStiffness.Wrappers.HarmonicDriveSpring one(redeclare StandIn fmu);",
            "JointStiffness.Components.HarmonicDriveSpring other;",
            *(
                f"{inertia} {name}(J={J}, phi(fixed=true, start={phi}), w(fixed=true, start=0));"
                for n in (1, 2)
                for name, J, phi in ((f"motor{n}", 1e-5, 0.1), (f"link{n}", 0.05, 0.0))
            ),
        ]
    )
    wires = "\n  ".join(
        f"connect(motor{n}.flange_b, {a});\n  connect({b}, link{n}.flange_a);"
        for n, a, b in ((1, "one.flange1", "one.flange2"), (2, "other.flange_a", "other.flange_b"))
    )
    record = make_identifier(load_default("harmonic_drive").name)
    outputs = [v.name for v in MODELS["HarmonicDriveSpring"].outputs]
    zeros = " ".join(f"{name} = 0;" for name in outputs if name not in _BLOCK_OUTPUTS)
    found = simulate(rumoca, top(body, wires, _BLOCK.format(record=record, zeros=zeros)), 0.2, 1e-3)
    assert np.ptp(found["link2.phi"]) > 1e-3
    assert np.abs(found["link1.phi"] - found["link2.phi"]).max() <= 1e-6 * np.ptp(found["link2.phi"])


@pytest.mark.parametrize(
    ("name", "domain", "source", "force", "motion", "flange"),
    [
        ("HarmonicDriveCompliance", "Rotational", "Torque", "tau", "phi_rel", "phi"),
        ("GearContact", "Translational", "Force", "f", "s_rel", "s"),
    ],
)
def test_wrapper_of_an_fmu_that_takes_force(
    rumoca: Any, name: str, domain: str, source: str, force: str, motion: str, flange: str
):
    others = "".join(f" {v.name} = 0;" for v in MODELS[name].outputs if v.name != motion)
    block = f"block StandIn\n  extends JointStiffness.Interfaces.{name};\nequation\n"
    block += f"  {motion} = {force}/1000;{others}\nend StandIn;"
    body = f"JointStiffness.Wrappers.{name} one(redeclare StandIn fmu);\n"
    body += f"  Modelica.Mechanics.{domain}.Sources.{source} load;"
    wires = f"load.{force} = time;\n  connect(load.flange, one.flange);"
    found = simulate(rumoca, top(body, wires, block), 1.0, 0.1)
    assert np.allclose(found[f"one.fmu.{force}"], found.time, atol=1e-12)
    assert np.allclose(found[f"one.flange.{flange}"], found.time / 1000.0, atol=1e-15)


def test_wrapper_of_the_bolted_joint_restores(rumoca: Any):
    forces = " ".join(f"f_{a} = -1e6*s_rel_{a} - 100*v_rel_{a};" for a in "xyz")
    inputs = {f"f_{a}" for a in "xyz"}
    others = "".join(f" {v.name} = 0;" for v in MODELS["BoltedJoint"].outputs if v.name not in inputs)
    block = "block StandIn\n  extends JointStiffness.Interfaces.BoltedJoint;\nequation\n  "
    block += f"{forces}{others}\nend StandIn;"
    mass = "Modelica.Mechanics.Translational.Components.Mass"
    body = "JointStiffness.Wrappers.BoltedJoint one(preload=15e3, redeclare StandIn fmu);\n  "
    body += " ".join(f"{mass} m{a}(m=1, s(fixed=true, start=1e-6), v(fixed=true, start=0));" for a in "xyz")
    wires = " ".join(f"connect(one.flange_{a}, m{a}.flange_a);" for a in "xyz")
    body += "\n  Modelica.Mechanics.Rotational.Components.Fixed held;"
    wires += " ".join(f" connect(one.flange_turn_{a}, held.flange);" for a in "xyz")
    found = simulate(rumoca, top(body, wires, block), 0.01, 1e-4)
    decay, rate = 50.0, math.sqrt(1e6 - 50.0**2)
    t = found.time
    exact = 1e-6 * np.exp(-decay * t) * (np.cos(rate * t) + decay / rate * np.sin(rate * t))
    for a in "xyz":
        assert np.abs(found[f"m{a}.s"] - exact).max() <= 1e-10
