"""The pointwise divergence against differences of the same stress field, and the cost of a contour."""

from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config.methods import Frequencies
from hypernode.fem.mesh import rectilinear
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.networks.weights import make_network
from hypernode.training.losses import PENALTIES, SMALLEST_RESIDUAL, divergence, variation

NODE = NodeMaterial(terms=("I1", "I2", "I1_I4v"), hidden=(3,), steps=4, invariant_scale=0.4, stress_scale=1.0)
LENGTH = 2.0


def gradient(X):
    """Two load steps of a deformation gradient with F12 unlike F21, so that P is far from symmetric."""
    x, y = X.T
    F = [[1.1 + 0.05 * jnp.sin(x), 0.1 * y], [-0.05 * x * y, 1.05 + 0.04 * jnp.cos(y)]]
    F = jnp.stack([jnp.stack(row) for row in F])[:, :, None]
    return jnp.concatenate([0.5 * (F + jnp.eye(2)[:, :, None, None]), F], axis=2)


def test_divergence_contracts_the_second_index_of_a_non_symmetric_stress():
    network = make_network(Frequencies(features=4, frequency_scale=0.3, widths=[5]), 0, NODE.size, 0)
    X = jnp.asarray(np.random.default_rng(0).uniform(0.2, 1.8, (6, 2)))
    unit = jnp.eye(2)
    dF = jnp.stack([jax.jvp(gradient, (X,), (jnp.broadcast_to(unit[k], X.shape),))[1] for k in range(2)])
    problem = SimpleNamespace(node=NODE, length=LENGTH)
    found = jax.jit(lambda: divergence(problem, network, X / LENGTH, gradient(X), dF))()

    @jax.jit
    def stress(X):
        return node_stress(NODE, gradient(X), network(X / LENGTH).T)

    h = 1e-5
    slopes = [(stress(X + h * unit[J]) - stress(X - h * unit[J])) / (2 * h) for J in range(2)]
    wanted = slopes[0][:, 0] + slopes[1][:, 1]
    swapped = slopes[0][0, :] + slopes[1][1, :]
    np.testing.assert_allclose(found, wanted, rtol=1e-4, atol=1e-5)
    P = stress(X)
    assert np.abs(P[0, 1] - P[1, 0]).max() > 1e-2
    assert np.abs(swapped - wanted).max() > 1e-2
    slip = jax.jit(lambda: divergence(problem, network, X / LENGTH, gradient(X), dF, True))()
    np.testing.assert_allclose(slip, swapped, rtol=1e-4, atol=1e-5)


def test_variation_is_the_length_of_a_contour_times_the_contrast_across_it():
    """On a grid of unequal spacing, and over the mean deformation of the largest step, not the local one."""
    mesh = rectilinear(np.linspace(0.0, LENGTH, 9) ** 2 / LENGTH, np.linspace(0.0, 1.0, 6))
    rng = np.random.default_rng(1)
    stretch = 1.0 + 0.2 * rng.uniform(size=(2, len(mesh.cells)))
    F = jnp.asarray(np.einsum("sc,iJ->iJsc", stretch, np.eye(2)))
    loading = SimpleNamespace(t=np.array([0.4, 1.0]))
    problem = SimpleNamespace(mesh=mesh, F=F, loading=loading, node=NODE, length=LENGTH, scale=jnp.array([9.0, 0.5]))
    at, cost = variation(problem)
    params = NODE.initial_params(jax.random.key(0))
    stiff = mesh.centres[:, 0] > 0.5
    first = NODE.size - 1 - len(NODE.constants)
    field = jnp.tile(params[:, None], (1, len(mesh.cells))).at[first].add(jnp.log(3.0) * stiff)
    mean = np.sum(stretch[1] * mesh.areas) / mesh.areas.sum() * np.eye(2)[:, :, None, None]
    stress = jax.jit(lambda F, params: node_stress(NODE, F, params))
    P = [stress(jnp.asarray(mean), field[:, np.array(cell)]) for cell in ([0], [-1])]
    contrast = float(jnp.linalg.norm(P[1] - P[0]) / 0.5)
    assert stiff[-1] and not stiff[0]
    flat = cost(stress(at, jnp.tile(params[:, None], (1, len(mesh.cells)))))
    np.testing.assert_allclose(cost(stress(at, field)) - flat, (contrast - 0.02) / LENGTH, rtol=2e-3)


def test_a_large_divergence_costs_its_length_where_the_penalty_is_absolute():
    length = jnp.array([1e-3, 1.0, 100.0]) * SMALLEST_RESIDUAL
    np.testing.assert_allclose(PENALTIES["square"](length**2), length**2)
    absolute = PENALTIES["absolute"](length**2)
    np.testing.assert_allclose(absolute[2], length[2] - SMALLEST_RESIDUAL, rtol=1e-3)
    slope = jax.vmap(jax.grad(PENALTIES["absolute"]))(length**2)
    np.testing.assert_allclose(slope, 0.5 / jnp.hypot(length, SMALLEST_RESIDUAL), rtol=1e-5)
