"""Results that tools store between processes: equal bits, and computed anew where they cannot be stored."""

import subprocess
import sys

import numpy as np
import pytest
from clients import needs
from jointfmu_fmu_src.native.compiled.compiled_models import get_stored_result
from surroundings import environment

from jointfmu.files import results
from jointfmu.files.results import compute_or_load_array, set_result_store

PROGRAM = """
import sys
from jointfmu_tools.api.make import load
from jointfmu.joints.bolted_joint import joint
if sys.argv[1] == "kept":
    joint.reduce_points = joint.reduce_patches = None
pattern = load("BoltedJoint").file.values.pattern
for found in (joint.contact_points(pattern), joint.find_friction_patches(pattern)):
    print(type(found).__name__, [row.tobytes().hex() for row in found.rows])
"""


@pytest.fixture
def store():
    kept, before = {}, list(results._stores)
    set_result_store(
        lambda key, compute: kept.setdefault(key, None) or kept.update({key: compute()}) or kept[key]
    )
    yield kept
    set_result_store(before[0] if before else None)


def test_a_result_is_computed_once_for_each_name_and_argument(store):
    counted = []

    def compute():
        counted.append(1)
        return np.arange(6.0).reshape(2, 3) / 7.0

    ones, twos = np.ones(3), np.full(3, 2.0)
    for name, arguments in (("a", [ones]), ("a", [ones]), ("b", [ones]), ("a", [twos]), ("a", [ones, ones])):
        found = compute_or_load_array(name, arguments, compute)
        np.testing.assert_array_equal(found, np.arange(6.0).reshape(2, 3) / 7.0)
        found[0, 0] = 1.0  # it belongs to the caller
    assert len(counted) == len(store) == 4


def test_points_and_patches_of_another_process_have_the_same_bits(tmp_path, enter):
    enter(environment(JOINTFMU_CACHE=str(tmp_path / "cache")))
    texts = [
        subprocess.run(
            [sys.executable, "-W", "ignore", "-c", PROGRAM, word],
            capture_output=True, text=True, check=True, timeout=100,
        ).stdout
        for word in ("computed", "kept")
    ]  # fmt: skip
    assert texts[0] == texts[1]
    assert texts[0].startswith("PressureDistribution [")


@needs("Linux or macOS")
def test_an_unsafe_cache_is_not_read(tmp_path, enter):
    cache = tmp_path / "cache"
    enter(environment(JOINTFMU_CACHE=str(cache)))
    assert get_stored_result("one", lambda: b"first") == b"first"
    assert get_stored_result("one", lambda: b"second") == b"first"
    cache.chmod(0o777)
    assert get_stored_result("one", lambda: b"second") == b"second"
