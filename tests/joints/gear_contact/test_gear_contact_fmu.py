"""The FMU of the gear contact: equal to its law."""

from collections.abc import Callable
from typing import Any

import pytest
from conftest import Fmu
from joint_cases import SAME, STATE, TABLE, parameters

from jointfmu.contact.interface import at_pressure

Host = Callable[..., Fmu]


def test_rigid_flat_takes_the_second_body_out(fmu: Host) -> None:
    def at(**changes: Any) -> dict[str, float]:
        return fmu("GearContact").start(changes | STATE["GearContact"]).get()

    rigid, both = at(rigid_flat=True), at(rigid_flat=False)
    assert at() == rigid  # the default
    assert at(**{"rigid_flat": True, "side2.E": 1e11}) == rigid
    assert at(**{"rigid_flat": False, "side2.E": 1e11}) != both
    # two equal bodies are as soft as one of half the modulus against a rigid flat
    assert at(**{"rigid_flat": True, "side1.E": 1.03e11}) == pytest.approx(both, rel=1e-9)


def test_gear_contact_follows_the_law_without_a_table(fmu: Host) -> None:
    contact, instance = parameters("GearContact"), fmu("GearContact").start()
    for f in (300.0, 2e3, 2e4, 6e4):
        found, expected = instance.at({"f": f}), at_pressure(contact, f / contact.A_0)
        assert found["K_N"] == pytest.approx(float(expected["K_N"]), rel=TABLE)
        for output in ("A_r", "elastic_fraction"):
            assert found[output] == pytest.approx(float(expected[output]), rel=SAME)
    assert found["elastic_fraction"] > 0.0
    assert list(instance.at({"f": 0.0}).values()) == [0.0] * 4
