"""Selection of few nodes that keep the sums over many nodes."""

import numpy as np
from jointfmu_tools.inputs.fields.reduction import recombine_weights


def test_few_nodes_keep_the_sums():
    """Polynomials on random nodes: as many nodes as sums, positive weights, sums accurate to round-off."""
    rng = np.random.default_rng(1)
    x, weights = rng.uniform(-1.0, 1.0, 4000), rng.uniform(0.5, 1.5, 4000)
    values = np.polynomial.chebyshev.chebvander(x, 19)
    nodes, few = recombine_weights(values, weights, np.eye(20))
    assert nodes.size <= 20
    assert np.all(few > 0.0)
    np.testing.assert_allclose(few @ values[nodes], weights @ values, atol=1e-9 * weights.sum())
