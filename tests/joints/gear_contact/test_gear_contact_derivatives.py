"""Derivatives of the gear contact's FMU keep the closed relations of the contact."""

from natives import Host, close, jacobian


def test_derivatives_keep_the_closed_relations_of_the_gear_contact(host: Host, version: str) -> None:
    instance = host("GearContact", version).start()
    for f in (1e-3, 1.0, 300.0, 2e4, 6e4, 1e6):
        values, J = instance.at({"f": f}), jacobian(instance)
        assert J["s_rel", "f"] == close(1.0 / values["K_N"], 1e-12)
        assert J["A_r", "f"] > 0.0
    for f in (0.0, -5.0):
        instance.at({"f": f})
        assert set(jacobian(instance).values()) == {0.0}
