"""Neural ODEs are monotone; their weights, and those of networks, survive a round trip."""

from functools import partial
from itertools import product

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flax import nnx

from hypernode.config.methods import Frequencies
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.networks.neural_ode import LARGEST_SLOPE, flow, unflatten, weight_count
from hypernode.networks.potentials import POTENTIALS
from hypernode.networks.terms import POWERS
from hypernode.networks.weights import from_arrays, make_network, to_arrays

#: Compiled as a whole.
flow_at = jax.jit(flow, static_argnums=(2, 3))


def initial(material):
    return jax.jit(material.initial_params)(jax.random.key(0))


@pytest.mark.parametrize("hidden", [(4, 4), (2,), (8, 8)])
@pytest.mark.parametrize("steps", [1, 2, 5])
def test_the_discrete_flow_is_monotone_for_any_weights_and_passes_through_zero(hidden, steps):
    sizes = jnp.linspace(0.1, 5.0, 200)
    weights = sizes * jax.random.normal(jax.random.key(1), (weight_count(hidden), 200))
    h = jnp.linspace(-3.0, 3.0, 301)[:, None] * jnp.ones((1, 200))
    assert np.diff(np.asarray(flow_at(h, weights, hidden, steps)), axis=0).min() > 0.0
    assert np.abs(flow_at(0.0 * h, weights, hidden, steps)).max() == 0.0


def test_one_step_of_the_largest_slope_is_increasing_whatever_the_slopes_at_its_stages():
    def derivative(f1, f2, f3, f4):
        a1 = f1
        a2 = f2 * (1.0 + 0.5 * a1)
        a3 = f3 * (1.0 + 0.5 * a2)
        return 1.0 + (a1 + 2.0 * a2 + 2.0 * a3 + f4 * (1.0 + a3)) / 6.0

    def smallest(s):
        return min(derivative(*corner) for corner in product((-s, s), repeat=4))

    assert smallest(LARGEST_SLOPE) > 0.0 > smallest(1.6)


@pytest.mark.parametrize("terms", [("I1", "I2", "I1_I4v", "I1_I4w", "I4v_I4w"), ("I1", "I2", *POWERS, "I4v")])
def test_a_material_of_large_random_weights_is_convex_along_rank_one_lines(terms):
    rng = np.random.default_rng(4)
    material = NodeMaterial(terms=terms, hidden=(4, 4), steps=1, invariant_scale=0.4, stress_scale=1.0)
    stress = jax.jit(lambda F, params: node_stress(material, F[..., None], params[:, None])[..., 0])
    params = rng.normal(0.0, 2.0, (200, material.size))
    # The logarithms of the constant parts: stiffness of a common size.
    count = len(material.constants)
    params[:, -1 - count : -1] = rng.normal(-1.0, 0.5, (200, count))
    work = []
    for p in params:
        F = np.eye(2) + rng.normal(0.0, 0.1, (2, 2))
        line = 0.01 * np.outer(*rng.normal(size=(2, 2)))
        work.append(np.sum((stress(F + line, p) - stress(F - line, p)) * line) / np.sum(line**2))
    assert min(work) > -1e-4


def test_a_compressed_sheet_that_may_change_its_volume_is_convex_along_shears():
    """There tr C < 2, and the whole slope is of the network."""
    rng = np.random.default_rng(4)
    material = NodeMaterial(terms=("I1", "J"), hidden=(4, 4), steps=1, invariant_scale=0.4, stress_scale=1.0, share=1.0)
    params = rng.normal(0.0, 1.0, (material.size, 50))
    params[-1] = -3.0
    F, line = 0.8 * np.eye(2)[..., None] * np.ones(50), np.array([[0.0, 0.01], [0.0, 0.0]])[..., None]
    stress = jax.jit(partial(node_stress, material))
    change = np.asarray(stress(F + line, params)) - np.asarray(stress(F - line, params))
    assert np.sum(change * line, axis=(0, 1)).min() > 0.0


@pytest.mark.parametrize("name", POTENTIALS)
def test_every_potential_has_an_increasing_slope_that_vanishes_at_zero(name):
    potential = POTENTIALS[name]
    weights = jax.random.normal(jax.random.key(3), (potential.weight_count((4, 4)), 30))
    h = jnp.linspace(0.0, 4.0, 80)[:, None] * jnp.ones((1, 30))
    out = np.asarray(potential.slope(h, weights, (4, 4), 16))
    assert np.diff(out, axis=0).min() > 0.0
    assert np.isfinite(out).all() and np.abs(out[0]).max() == 0.0


def test_networks_with_powers_of_the_stretches_contain_the_laws_of_ogden_that_the_basis_has():
    basis = ConvexBasis(("I2", "ogden"), 0.4)
    found = dict(zip(basis.names, (0.3, 0.2, 0.4, 0.25, 0.15), strict=True))
    material = NodeMaterial(
        terms=("I1", "I2", *POWERS), hidden=(4, 4), steps=2, invariant_scale=0.4, stress_scale=1.0, scaled=True
    )

    @jax.jit
    def both(F, values):
        letters = basis.coefficients(values)
        constants = jnp.log(letters["c"] * jnp.array([1.0, letters["c2"], letters["c5"], letters["c6"], letters["c7"]]))
        # Without any share of a neural ODE, what is left are the constant parts.
        params = material.join(jnp.zeros((24, 5)), jnp.zeros(0), jnp.concatenate([constants, jnp.full(5, -40.0)]), None)
        return node_stress(material, F, params[:, None]), basis.stress(F, values[:, None])

    F = np.eye(2)[..., None] + 0.2 * np.asarray(jax.random.normal(jax.random.key(0), (2, 2, 50)))
    np.testing.assert_allclose(*both(F, np.array(list(found.values()))), rtol=2e-5, atol=2e-5)
    without = NodeMaterial(terms=("I1", "I2"), hidden=(4, 4), steps=2, invariant_scale=0.4, stress_scale=1.0)
    assert not material.has_fibres and without.size < material.size


@pytest.mark.parametrize("name", POTENTIALS)
def test_every_potential_makes_a_material_that_is_stress_free_undeformed(name):
    material = NodeMaterial(
        terms=("I1", "I2", "I1_I4v"), hidden=(3,), steps=4, invariant_scale=0.4, stress_scale=1.0, potential=name
    )
    params = initial(material)
    assert params.shape == (material.size,)
    stress = node_stress(material, jnp.eye(2)[:, :, None], params[:, None])
    assert np.abs(stress).max() < 1e-6


def test_flow_converges_with_fourth_order():
    weights = jax.random.normal(jax.random.key(2), (24, 1))
    h = jnp.array([[0.7]])
    exact = flow_at(h, weights, (4, 4), 256)
    errors = [float(jnp.abs(flow_at(h, weights, (4, 4), n) - exact).max()) for n in (2, 4, 8)]
    assert np.log2(errors[1] / errors[2]) > 3.5


def test_weights_are_taken_row_by_row_and_each_once():
    weights = jnp.arange(24.0 * 3).reshape(24, 3)
    layers = unflatten(weights, (4, 4))
    assert [np.shape(layer) for layer in layers] == [(4, 1, 3), (4, 4, 3), (1, 4, 3)]
    np.testing.assert_array_equal([weight for layer in layers for row in layer for weight in row], weights)


def test_output_width_is_the_published_one():
    terms = ("I1", "I2", "I1_I4v", "I1_I4w", "I4v_I4w")
    assert NodeMaterial(terms=terms, hidden=(4, 4), steps=4, invariant_scale=1.0, stress_scale=1.0).size == 126
    assert NodeMaterial(terms=("I1", "I2"), hidden=(4, 4), steps=4, invariant_scale=1.0, stress_scale=1.0).size == 50
    assert (
        NodeMaterial(
            terms=("I1", "I2"), hidden=(4, 4), steps=4, invariant_scale=1.0, stress_scale=1.0, scaled=True
        ).size
        == 52
    )


def test_parameters_split_and_join_back():
    material = NodeMaterial(terms=("I1", "I2", "I1_I4v"), hidden=(3,), steps=2, invariant_scale=1.0, stress_scale=1.0)
    params = jnp.arange(material.size, dtype=float)
    np.testing.assert_array_equal(material.join(*material.split(params)), params)


def test_every_term_starts_from_its_own_weights():
    material = NodeMaterial(terms=("I1", "I2", "I4v"), hidden=(4, 4), steps=2, invariant_scale=1.0, stress_scale=1.0)
    weights = np.asarray(jax.jit(material.split)(initial(material))[0])
    assert np.abs(np.diff(weights, axis=1)).min(axis=0).max() > 0
    assert not np.allclose(weights[:, 0], weights[:, 1])


def test_frequencies_do_not_train():
    network = make_network(Frequencies(features=5, frequency_scale=1.0, widths=[4]), 0, 2, 0)
    assert "frequencies" not in nnx.state(network, nnx.Param)


def test_network_weights_round_trip():
    settings = Frequencies(features=5, frequency_scale=1.0, widths=[4, 3])
    network = make_network(settings, 1, 2, 7)
    X, t = jnp.ones((7, 2)) * 0.3, jnp.ones((7, 1))
    arrays = {name: value for name, (_, value) in to_arrays(network, "net").items()}
    loaded = from_arrays(settings, 1, 2, arrays, "net")
    np.testing.assert_array_equal(loaded(X, t), network(X, t))
    assert jax.tree.structure(nnx.state(loaded)) == jax.tree.structure(nnx.state(network))
    with pytest.raises(ValueError, match=r"net\.frequencies has the shape"):
        from_arrays(settings.model_copy(update={"features": 6}), 1, 2, arrays, "net")


def test_fibres_begin_with_little_dispersion_and_families_apart():
    material = NodeMaterial(
        terms=("I1", "I1_I4v", "I4v_I4w"), hidden=(4,), steps=2, invariant_scale=0.4, stress_scale=1.0
    )
    dispersed, coupled = np.asarray(
        jax.jit(lambda params: jax.nn.sigmoid(material.split(params)[1]))(initial(material))
    )
    assert 0.05 < dispersed < 0.2 and coupled > 0.95
