"""Joints between two flanges in MuJoCo: plugin from the sources of an FMU, against the FMU in fmpy."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from conftest import Fmu
from jointfmu_tools.exchange.mujoco import plugin

NAME = "HarmonicDriveSpring"
STEP = 5e-4
INERTIA = 0.05
LOCKED = 1e9
"""Rotor inertia (armature) of a locked motor [kg m2]."""
DAMPING = 0.5
"""`d` of the default drive [N.m.s/rad]."""
LOOP = {"hysteresis_loss": 3e-4}

JOINT = """
<body>
  <joint name="motor{0}" type="hinge" axis="0 0 1" armature="{1}"/>
  <inertial pos="0 0 0" mass="1" diaginertia="1e-9 1e-9 1e-9"/>
</body>
<body>
  <joint name="link{0}" type="hinge" axis="0 0 1"/>
  <inertial pos="0 0 0" mass="1" diaginertia="{2} {2} {2}"/>
</body>"""
INSTANCE = """
<instance name="drive{0}">
  <config key="phi1" value="motor{0}"/>
  <config key="phi2" value="link{0}"/>
  {1}
</instance>"""

Robot = Callable[..., tuple[Any, Any]]


@pytest.fixture(scope="module")
def loaded(native: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    mujoco.mj_loadPluginLibrary(
        str(plugin(native / "fmi3" / f"{NAME}.fmu", tmp_path_factory.mktemp("plugin")))
    )


@pytest.fixture
def robot(loaded: None) -> Robot:
    """Function that makes model and data of drives side by side with locked motors, from parameters of each
    drive."""

    def make(
        *drives: dict[str, Any], integrator: str = "Euler", name: str = NAME, instance: str = INSTANCE
    ) -> tuple[Any, Any]:
        configs = ["".join(f'<config key="{k}" value="{v}"/>' for k, v in one.items()) for one in drives]
        numbers = range(len(drives))
        sensors = "".join(f'<plugin plugin="jointfmu.{name}" instance="drive{i}"/>' for i in numbers)
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{STEP}" gravity="0 0 0" integrator="{integrator}"/>'
            f'<extension><plugin plugin="jointfmu.{name}">'
            f"{''.join(map(instance.format, numbers, configs))}</plugin></extension>"
            f"<worldbody>{''.join(JOINT.format(i, LOCKED, INERTIA) for i in numbers)}</worldbody>"
            f"<sensor>{sensors}</sensor></mujoco>"
        )
        return model, mujoco.MjData(model)

    return make


def push(time: float) -> float:
    """Torque at the link [N.m]: up to the rated torque, one period per second."""
    return 5.0 * np.sin(2.0 * np.pi * time)


def run(model: Any, data: Any, steps: int, link: int = 1) -> np.ndarray:
    """Angle and speed of a link and its drive's outputs before each step, (steps, 2 + outputs)."""
    outputs = data.sensordata.size * 2 // model.nv
    first = (link // 2) * outputs
    rows = []
    for _ in range(steps):
        data.qfrc_applied[link] = push(data.time)
        angles = data.qpos[link], data.qvel[link]
        mujoco.mj_step(model, data)
        rows.append([*angles, *data.sensordata[first : first + outputs]])
    return np.array(rows)


def beside(fmu: Fmu, steps: int) -> np.ndarray:
    """Results as `run`, by the FMU in co-simulation, with MuJoCo's scheme for the inertia (speed, then
    angle)."""
    angle = speed = 0.0
    rows = []
    for i in range(steps):
        outputs = fmu.at({"phi2": angle, "w2": speed})
        rows.append([angle, speed, *outputs.values()])
        speed += STEP * (push(i * STEP) + outputs["tau2"]) / INERTIA
        angle += STEP * speed
        fmu.set_values({"phi2": angle, "w2": speed})
        fmu.step(STEP)
    return np.array(rows)


def apart(rows: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference of a column over its largest value [1]."""
    size = np.abs(expected).max(axis=0)
    found = np.abs(rows - expected).max(axis=0)
    return float(np.max(found[size > 0.0] / size[size > 0.0]))


def area(x: np.ndarray, y: np.ndarray) -> float:
    """Area of a closed polygon."""
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


@pytest.fixture
def drive(host: Callable[..., Fmu]) -> Iterator[Callable[..., Fmu]]:
    """FMU in co-simulation, with all its outputs at rest."""

    def make(**parameters: Any) -> Fmu:
        fmu = host(NAME)
        return fmu.start(parameters | {"phi1": 0.0})

    return make


def test_resonance_of_the_link_is_that_of_the_fmus_stiffness(robot: Robot, drive: Callable[..., Fmu]) -> None:
    """Free vibration with so small an amplitude that the curve is straight; RK4 has the error (omega h)^4/120
    = 1e-6."""
    stiffness = drive().get()["K_WTS"]
    model, data = robot({}, integrator="RK4")
    data.qpos[1] = 1e-7
    crossings = []
    for _ in range(2500):
        before, time = data.qpos[1], data.time
        mujoco.mj_step(model, data)
        if before < 0.0 <= data.qpos[1]:
            crossings.append(time + STEP * before / (before - data.qpos[1]))
    found = 2.0 * np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    assert len(crossings) > 10
    decay = DAMPING / (2.0 * INERTIA)
    assert found == pytest.approx(np.sqrt(stiffness / INERTIA - decay**2), rel=1e-3)


def test_loops_are_those_of_the_fmu(robot: Robot, drive: Callable[..., Fmu]) -> None:
    """Half a second to the first reversal, then one loop; the same scheme, so equal to round-off."""
    steps, loop = 2500, slice(500, 2500)
    rows = run(*robot(LOOP), steps)
    fmu = drive(**LOOP)
    expected = beside(fmu, steps)
    assert area(rows[loop, 0], rows[loop, 3]) == pytest.approx(
        area(expected[loop, 0], expected[loop, 3]), rel=0.01
    )
    assert apart(rows, expected) < 1e-6
    names = ["phi", "w", *fmu.outputs]
    wind_up, tau = (rows[loop, names.index(n)] for n in ("phi_rel", "tau"))
    free = np.interp(0.0, -tau[:1000], wind_up[:1000]) - np.interp(0.0, tau[1000:], wind_up[1000:])
    assert abs(free) == pytest.approx(LOOP["hysteresis_loss"], rel=0.03)  # defined so; d adds to it
    lost = np.diff(rows[[500, -1], names.index("E_loss")])[0]
    viscous = DAMPING * STEP * np.sum(rows[loop, names.index("w")] ** 2)  # E_loss is without it
    assert area(wind_up, tau) == pytest.approx(lost + viscous, rel=2e-3)


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
def test_trials_leave_the_path_alone(robot: Robot, integrator: str) -> None:
    model, data = robot(LOOP, integrator=integrator)
    _, plain = robot(LOOP, integrator=integrator)
    for _ in range(300):
        data.qfrc_applied[1] = plain.qfrc_applied[1] = push(data.time)
        kept = data.qpos.copy()
        data.qpos[1] += 1e-3
        if data.time > 0.0:  # the first evaluation begins the path
            mujoco.mj_forward(model, data)
        data.qpos[:] = kept
        mujoco.mj_step(model, data)
        mujoco.mj_step(model, plain)
        assert np.array_equal(data.qpos, plain.qpos)


def test_sensors_follow_speeds_alone(robot: Robot) -> None:
    """As MuJoCo's finite differences require: positions are not evaluated again."""
    model, data = robot({})
    run(model, data, 100)
    data.qvel[1] += 0.1
    again = mujoco.MjData(model)
    mujoco.mj_copyData(again, model, data)
    mujoco.mj_forwardSkip(model, data, mujoco.mjtStage.mjSTAGE_POS, 0)
    mujoco.mj_forward(model, again)
    assert np.array_equal(data.sensordata, again.sensordata)
    assert data.sensordata[1] == data.qfrc_passive[1]


@pytest.mark.parametrize("drive", [LOOP, {"friction_coulomb": 0.02}])
def test_the_path_is_part_of_mujocos_state(robot: Robot, drive: dict[str, Any]) -> None:
    """Hysteresis that is off has no variables: 44 sliders before and after."""
    model, data = robot(drive)
    assert model.plugin_statenum.tolist() == [122 if drive is LOOP else 122 - 2 * 44]
    first = run(model, data, 400)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    saved = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, saved, kind)
    copied = mujoco.MjData(model)
    mujoco.mj_copyData(copied, model, data)
    rest = run(model, data, 400)
    assert np.array_equal(run(model, copied, 400), rest)
    mujoco.mj_setState(model, data, saved, kind)
    assert np.array_equal(run(model, data, 400), rest)
    mujoco.mj_resetData(model, data)
    assert np.array_equal(run(model, data, 400), first)


def test_joints_do_not_see_each_other(robot: Robot) -> None:
    both = {"hysteresis_loss": 1e-4}, LOOP
    alone = [run(*robot(one), 700) for one in both]
    model, data = robot(*both)
    together: list[list[Any]] = [[], []]
    for _ in range(700):
        angles = [(data.qpos[i], data.qvel[i]) for i in (1, 3)]
        data.qfrc_applied[[1, 3]] = push(data.time)
        mujoco.mj_step(model, data)
        for rows, start, outputs in zip(together, angles, data.sensordata.reshape(2, -1), strict=True):
            rows.append([*start, *outputs])
    assert not np.allclose(alone[0][-1], alone[1][-1], rtol=1e-3)
    for rows, expected in zip(together, alone, strict=True):
        assert apart(np.array(rows), expected) < 1e-9


@pytest.mark.parametrize(
    ("config", "line"),
    [
        ({"surface.D": 3.5}, r"drive0: surface\.D = 3\.5 is outside \(2, 3\): fractal dimension"),
        ({"ratio": "fast"}, r"drive0: ratio = 'fast' is not a number; expected one"),
        ({"nothing": 1.0}, r"unrecognized attribute 'plugin:nothing'"),
    ],
)
def test_bad_configurations_are_refused(robot: Robot, config: dict[str, Any], line: str) -> None:
    with pytest.raises(ValueError, match=line):
        robot(config)


def test_an_unknown_joint_is_refused(robot: Robot) -> None:
    with pytest.raises(
        ValueError, match=r"drive0: phi2 = 'lnik0' is not a hinge joint; expected the name of one"
    ):
        robot({}, instance=INSTANCE.replace('"link{0}"', '"lnik{0}"'))


def test_an_angle_that_is_no_number_is_refused_and_the_data_go_on(robot: Robot) -> None:
    model, data = robot(LOOP)
    first = run(model, data, 10)
    data.qpos[1] = np.nan
    with pytest.raises(mujoco.FatalError, match=r"^drive0: phi2 = nan rad is outside \(-inf, inf\): "):
        mujoco.mj_forward(model, data)
    mujoco.mj_resetData(model, data)
    assert np.array_equal(run(model, data, 10), first)


def test_another_joint_is_loaded_beside_it(
    robot: Robot, native: Path, tmp_path: Path, host: Callable[..., Fmu]
) -> None:
    mujoco.mj_loadPluginLibrary(str(plugin(native / "fmi2" / "GearMesh.fmu", tmp_path)))
    with pytest.raises(
        ValueError, match="drive0: rigid_flat = 'maybe' is not a Boolean; expected true or false"
    ):
        robot({"rigid_flat": "maybe"}, name="GearMesh")
    model, data = robot({"rigid_flat": "false"}, name="GearMesh")
    data.qpos[:] = 1e-3, 2e-3
    data.qvel[:] = 0.1, -0.2
    mujoco.mj_forward(model, data)
    state = dict(zip(("phi1", "phi2", "w1", "w2"), (*data.qpos, *data.qvel), strict=True))
    outputs = host("GearMesh").start({"rigid_flat": False}).at(state)
    assert outputs["tau1"] != 0.0
    assert data.qfrc_passive.tolist() == pytest.approx([outputs["tau1"], outputs["tau2"]], rel=1e-9)
    assert data.sensordata.tolist() == pytest.approx([*outputs.values()], rel=1e-9)


def test_an_fmu_of_another_form_is_refused(native: Path, tmp_path: Path) -> None:
    other = native / "fmi3" / "GearContact.fmu"
    line = f"{other}: has the inputs f; expected a joint with phi1, w1, phi2, w2 and the outputs tau1, tau2"
    with pytest.raises(ValueError, match=f"^{re.escape(line)}$"):
        plugin(other, tmp_path)
    (tmp_path / "no.fmu").write_text("no archive")
    with pytest.raises(ValueError, match=r"no\.fmu: is not an FMU .File is not a zip file"):
        plugin(tmp_path / "no.fmu", tmp_path)
