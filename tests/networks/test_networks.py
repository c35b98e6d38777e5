"""Neural ODEs are monotone; their weights, and those of networks, survive a round trip."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flax import nnx

from hypernode.config import Frequencies
from hypernode.networks.neural_ode import flatten, flow, unflatten, weight_count
from hypernode.networks.node_material import NodeMaterial
from hypernode.networks.weights import from_arrays, make_network, to_arrays


@pytest.mark.parametrize("hidden", [(4, 4), (2,), (8, 8)])
def test_flow_is_monotone_and_passes_through_zero_where_steps_resolve_it(hidden):
    weights = 0.8 * jax.random.normal(jax.random.key(1), (weight_count(hidden), 20))
    # tanh has slope one at most, so the product of the layers' norms bounds the slope of f.
    slope = np.prod([np.sqrt(np.sum(np.asarray(m) ** 2, axis=(0, 1))) for m in unflatten(weights, hidden)], axis=0)
    h = jnp.linspace(-2.0, 2.0, 101)[:, None] * jnp.ones((1, 20))
    out = np.asarray(flow(h, weights, hidden, int(np.ceil(slope.max()))))
    assert np.diff(out, axis=0).min() > 0.0
    assert np.abs(flow(jnp.zeros((1, 20)), weights, hidden, 2)).max() == 0.0


def test_flow_converges_with_fourth_order():
    weights = jax.random.normal(jax.random.key(2), (24, 1))
    h = jnp.array([[0.7]])
    exact = flow(h, weights, (4, 4), 256)
    errors = [float(jnp.abs(flow(h, weights, (4, 4), n) - exact).max()) for n in (2, 4, 8)]
    assert np.log2(errors[1] / errors[2]) > 3.5


def test_weights_flatten_back_to_themselves():
    weights = jnp.arange(24.0 * 3).reshape(24, 3)
    np.testing.assert_array_equal(flatten(unflatten(weights, (4, 4))), weights)


def test_output_width_is_the_published_one():
    terms = ("I1", "I2", "I1_I4v", "I1_I4w", "I4v_I4w")
    assert NodeMaterial(terms, (4, 4), 4, 1.0, 1.0).size == 126
    assert NodeMaterial(("I1", "I2"), (4, 4), 4, 1.0, 1.0).size == 50
    assert NodeMaterial(("I1", "I2"), (4, 4), 4, 1.0, 1.0, scaled=True).size == 52


def test_parameters_split_and_join_back():
    material = NodeMaterial(("I1", "I2", "I1_I4v"), (3,), 2, 1.0, 1.0)
    params = jnp.arange(material.size, dtype=float)
    np.testing.assert_array_equal(material.join(*material.split(params)), params)


def test_every_term_starts_from_its_own_weights():
    material = NodeMaterial(("I1", "I2", "I4v"), (4, 4), 2, 1.0, 1.0)
    weights = material.split(material.initial_params(jax.random.key(0)))[0]
    assert np.abs(np.diff(weights, axis=1)).min(axis=0).max() > 0
    assert not np.allclose(weights[:, 0], weights[:, 1])


def test_frequencies_do_not_train():
    network = make_network(Frequencies(features=5, frequency_scale=1.0, widths=[4]), 0, 2, 0)
    assert "frequencies" not in nnx.state(network, nnx.Param)


def test_network_weights_round_trip():
    settings = Frequencies(features=5, frequency_scale=1.0, widths=[4, 3])
    network, other = make_network(settings, 1, 2, 0), make_network(settings, 1, 2, 9)
    X, t = jnp.ones((7, 2)) * 0.3, jnp.ones((7, 1))
    arrays = {name: value for name, (_, value) in to_arrays(network, "net").items()}
    assert not np.allclose(network(X, t), other(X, t))
    np.testing.assert_array_equal(from_arrays(other, arrays, "net")(X, t), network(X, t))
