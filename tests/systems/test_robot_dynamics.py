"""Rigid-body dynamics of robots, compared with MuJoCo and Pinocchio, at random states."""

import mujoco
import numpy as np
import pytest
from clients import needs
from jointfmu_tools.exchange.robots.elastic import read_robot
from jointfmu_tools.exchange.robots.rigid_tree import (
    check_joint_tree,
    find_body_frame,
    list_omitted_effects,
    read_links,
)
from jointfmu_tools.systems.multibody import (
    GROUND_INDEX,
    RigidBody,
    RotorMotion,
    compute_frame_motion,
    forward_dynamics,
)
from robots import OTHERS, ROBOT, add_rotors, robot_file

STATES = 1000
"""Number of random states."""
PRECISION = 1e-9
"""Of inverse dynamics, over the largest force."""
TREE = """<mujoco><compiler angle="radian"/><worldbody>
<body name="base" pos="0.1 0 0.3" euler="0.3 0.2 0.1"><geom size="0.1" mass="5"/>
<body name="lift" pos="0 0.2 0" euler="0 0.4 0">
<joint name="lift" type="slide" axis="1 0 1" damping="7" ref="0.1"/>
<geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0.05" mass="3"/>
<body name="wrist" pos="0.1 0.2 0.3">
<joint name="roll" axis="1 2 3" pos="0.02 0 0.01" armature="0.2" stiffness="5" springref="0.4"/>
<joint name="pitch" axis="0 -1 0" pos="0 0.03 0" ref="0.3" armature="0.1"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0.1" size="0.04" mass="4"/>
<body name="left" pos="0.4 0 0" euler="1 0 0"><joint name="left" axis="0 0 1"/>
<geom size="0.1" pos="0.1 0.1 0" mass="1"/>
<body name="tool" pos="0.1 0.2 0" euler="0 0 1">
<geom type="box" size="0.01 0.02 0.1" mass="0.5"/></body></body>
<body name="right" pos="0.3 0.1 0"><joint name="right" type="slide" axis="0 1 0"/>
<geom size="0.1" mass="2"/></body>
</body></body></body></worldbody></mujoco>"""
"""Branches, slides, two joints of one body, joints beside the origin of their body, springs and dampers."""


def random_states(model, count=STATES):
    rng = np.random.default_rng(5)
    q, v, a = (rng.uniform(-size, size, (count, model.nv)) for size in (3.0, 3.0, 10.0))
    return q, v, a


@pytest.fixture(scope="module", params=["six_axis", "tree", *OTHERS])
def robot(request, tmp_path_factory):
    tree = tmp_path_factory.mktemp("robot") / "tree.xml"
    tree.write_text(TREE)
    file = {"six_axis": ROBOT, "tree": tree}.get(request.param) or robot_file(request.param)
    model = read_robot(file).compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return model


def solve_forces(links, gravity, q, v, a, payload=None):
    prescribed = [None] * len(links)
    motion = forward_dynamics(links, gravity, list(q.T), list(v.T), prescribed, list(a.T), payload=payload)
    return np.stack(np.broadcast_arrays(*motion.joint_forces), axis=1)


def test_inverse_and_forward_dynamics_are_mujocos(robot):
    """Both directions: forces for accelerations, and accelerations for forces."""
    q, v, a = random_states(robot)
    data, expected = mujoco.MjData(robot), np.empty_like(q)
    for k in range(STATES):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(robot, data)
        expected[k] = data.qfrc_inverse
    links, gravity = read_links(robot, ()), robot.opt.gravity.tolist()
    found = solve_forces(links, gravity, q, v, a)
    assert np.abs(found - expected).max() < PRECISION * np.abs(expected).max()
    motion = forward_dynamics(links, gravity, list(q.T), list(v.T), list(expected.T))
    assert np.abs(np.transpose(motion.joint_accelerations) - a).max() < 10.0 * PRECISION * np.abs(a).max()


def test_a_payload_and_the_motion_of_the_tip_are_mujocos(robot):
    """The payload as a body of the robot: mass, centre and inertia in the frame of the tip."""
    tip, mass, centre, inertia = robot.nbody - 1, 2.0, [0.1, -0.05, 0.2], [0.03, 0.02, 0.04]
    q, v, a = random_states(robot, 50)
    frame, data = find_body_frame(robot, tip), mujoco.MjData(robot)
    links, gravity = read_links(robot, ()), robot.opt.gravity.tolist()
    added = solve_forces(links, gravity, q, v, a, RigidBody(frame, mass, centre, inertia))
    added -= solve_forces(links, gravity, q, v, a)
    motion = compute_frame_motion(links, frame, list(q.T), list(v.T))
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(robot, data)
        axes, place = data.xmat[tip].reshape(3, 3), data.xpos[tip] + data.xmat[tip].reshape(3, 3) @ centre
        J, Jr, dJ, dJr = (np.zeros((3, robot.nv)) for _ in range(4))
        mujoco.mj_jac(robot, data, J, Jr, place, tip)
        mujoco.mj_jacDot(robot, data, dJ, dJr, place, tip)
        tensor, w = axes @ np.diag(inertia) @ axes.T, Jr @ v[k]
        force = mass * (J @ a[k] + dJ @ v[k] - robot.opt.gravity)
        moment = tensor @ (Jr @ a[k] + dJr @ v[k]) + np.cross(w, tensor @ w)
        expected = J.T @ force + Jr.T @ moment
        assert added[k] == pytest.approx(expected, abs=1e-9 * (1.0 + np.abs(expected).max()))
        velocity = np.zeros(6)
        mujoco.mj_objectVelocity(robot, data, mujoco.mjtObj.mjOBJ_XBODY, tip, velocity, 0)
        for found, due in (
            (motion.position, data.xpos[tip]),
            ([x for row in motion.rotation for x in row], data.xmat[tip]),
            (motion.angular_velocity, velocity[:3]),
            (motion.velocity, velocity[3:]),
        ):
            assert [float(np.broadcast_to(x, len(q))[k]) for x in found] == pytest.approx(due, abs=1e-12)


def test_rotors_are_bodies_of_mujoco():
    """Each rotor as a body on the link before its joint; the file's inertia of that link includes it."""
    spec = mujoco.MjSpec.from_file(str(ROBOT))
    rigid, J, names = spec.compile(), 5e-4, [joint.name for joint in spec.joints]
    model, dofs = add_rotors(spec, [J] * 6)
    links, rng, data = read_links(rigid, names), np.random.default_rng(3), mujoco.MjData(model)
    for _ in range(20):
        state = q, v, tau = rng.uniform([[-2.0], [-3.0], [-9.0]], [[2.0], [3.0], [9.0]], (3, 12))
        v[6:] *= 100.0
        data.qpos[dofs], data.qvel[dofs], data.qfrc_applied[dofs] = state
        mujoco.mj_forward(model, data)
        rotors = {name: RotorMotion(J, v[6 + k], tau[6 + k]) for k, name in enumerate(names)}
        motion = forward_dynamics(links, rigid.opt.gravity, q[:6], v[:6], tau[:6], rotor_motions=rotors)
        found = [*motion.joint_accelerations, *motion.rotor_accelerations.values()]
        assert found == pytest.approx(data.qacc[dofs], rel=1e-8, abs=1e-6)
        given = {
            name: RotorMotion(J, v[6 + k], None, motion.rotor_accelerations[name])
            for k, name in enumerate(names)
        }
        again = forward_dynamics(links, rigid.opt.gravity, q[:6], v[:6], tau[:6], rotor_motions=given)
        assert again.joint_accelerations == pytest.approx(motion.joint_accelerations, rel=1e-9)


@needs("Pinocchio")
@pytest.mark.parametrize("name", ["six_axis", *OTHERS])
def test_inverse_dynamics_is_pinocchios(name):
    """Pinocchio reads the first body of the world only: of the two arms of OpenArm, the left one."""
    import pinocchio

    file = ROBOT if name == "six_axis" else robot_file(name)
    read = pinocchio.buildModelFromMJCF if file.suffix == ".xml" else pinocchio.buildModelFromUrdf
    model, own = read(str(file)), read_robot(file).compile()
    q, v, a = random_states(own)
    data, links = model.createData(), read_links(own, ())
    joints = [own.joint(joint).id for joint in [*model.names][1:]]
    assert model.nv == len(joints) == {"six_axis": 6, "ur5e": 6, "openarm": 9}[name]
    expected = np.empty((STATES, model.nv))
    for k in range(STATES):
        state = np.empty((3, model.nv))
        state[:, model.idx_vs[1:]] = q[k, joints], v[k, joints], a[k, joints]
        expected[k] = (pinocchio.rnea(model, data, *state) + model.damping * state[1])[model.idx_vs[1:]]
    found = solve_forces(links, model.gravity.linear.tolist(), q, v, a)[:, joints]
    assert np.abs(found - expected).max() < PRECISION * np.abs(expected).max()


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("</worldbody>", '</worldbody><equality><connect name="bar" body1="tool" anchor="0 0 0"/></equality>',
         "the constraint bar closes a loop"),
        ('<joint name="left" axis="0 0 1"/>', '<joint name="left" type="ball"/>',
         "joint 'left' of body 'left' is of type ball; allowed are hinge and slide"),
    ],
)  # fmt: skip
def test_what_is_no_tree_is_refused(old, new, line):
    model = mujoco.MjModel.from_xml_string(TREE.replace(old, new))
    with pytest.raises(ValueError, match=line) as refused:
        check_joint_tree(model)
    assert "\n" not in str(refused.value)


def test_effects_that_are_left_out_are_listed():
    pair = '</worldbody><equality><joint name="pair" joint1="left" joint2="right"/></equality>'
    text = TREE.replace('<joint name="left"', '<joint name="left" frictionloss="2"').replace(
        "</worldbody>", pair
    )
    text = text.replace('<body name="tool"', '<body name="tool" gravcomp="1"')
    assert list_omitted_effects(mujoco.MjModel.from_xml_string(text)) == [
        "dry friction (frictionloss) of left",
        "couplings of joints (equality pair): the joints move independently",
        "compensation of gravity (gravcomp)",
    ]
    assert find_body_frame(mujoco.MjModel.from_xml_string(TREE), 1).link_index == GROUND_INDEX
