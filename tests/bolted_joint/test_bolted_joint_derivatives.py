"""Derivatives of the bolted joint's FMU keep the closed relations of the joint."""

from joint_cases import RANGES, parameters, random_inputs
from natives import Host, close, jacobian


def test_derivatives_keep_the_closed_relations_of_the_bolted_joint(host: Host, version: str) -> None:
    instance, joint = host("BoltedJoint", version).start(), parameters("BoltedJoint")
    for state in random_inputs("BoltedJoint", 20, seed=34):
        values = instance.at(state | {"v_rel_x": 0.0, "v_rel_y": 0.0, "v_rel_z": 0.0})
        J = jacobian(instance)
        for axis in "xyz":
            K, C = values[f"K_{2 * axis}"], values[f"C_{2 * axis}"]
            assert J[f"f_{axis}", f"s_rel_{axis}"] == close(-K, 1e-10)
            assert J[f"f_{axis}", f"v_rel_{axis}"] == close(-C, 1e-12)
        for a, b in ("xy", "xz", "yz"):  # a potential
            mixed = J[f"f_{a}", f"s_rel_{b}"]
            assert abs(mixed - J[f"f_{b}", f"s_rel_{a}"]) <= 1e-12 * values["K_zz"]
        about = J["K_rx", "s_rel_z"] + J["K_ry", "s_rel_z"]
        share = values["K_rz"] / (values["K_rx"] + values["K_ry"])
        assert J["K_rz", "s_rel_z"] == close(share * about, 1e-12)
    tight = dict.fromkeys(RANGES["BoltedJoint"], 0.0) | {"preload": 9e3}
    instance.at(tight)
    assert jacobian(instance)["p_mean", "preload"] == close(joint.n_bolts / joint.A_0, 1e-9)
    apart = instance.at(tight | {"s_rel_z": 1e-3})
    J = jacobian(instance)
    assert apart["p_max"] == 0.0
    assert J["f_z", "preload"] == close(-joint.n_bolts, 1e-9)  # all of it is lost
    assert {value for key, value in J.items() if key[1] not in ("preload", "moment")} == {0.0}
    instance.at(dict.fromkeys(tight, 0.0))  # nor is there anything without preload
    assert set(jacobian(instance).values()) == {0.0}
