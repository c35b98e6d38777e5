"""Two materials in layers: what the laminate of rank one must obey."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import minimize

from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.layers import Layers

BASIS = ConvexBasis(("I1_squared", "I2", "fibre"), 0.9)
LAYERS = Layers(BASIS)
STRESS = jax.jit(LAYERS.stress)
SOFT = BASIS.start
#: Ten times as stiff, with fibres of another direction.
STIFF = SOFT + np.array([2.3, 0.0, 0.1, -0.2, 0.1, 0.3])
NORMAL = np.array([0.6, 0.8])
F = np.array([[1.2, 0.05], [0.1, 1.1]])


def params(share, A=STIFF, B=SOFT):
    return jnp.asarray(LAYERS.field(np.stack([A, B]), np.array([share]), NORMAL[None])[0])


@jax.jit
def energy(a, share, F):
    """Of given sides, apart from :class:`Layers`."""
    across = a[:, None] * NORMAL
    sides = ((share, F + (1.0 - share) * across, STIFF), (1.0 - share, F - share * across, SOFT))
    return sum(weight * BASIS.energy(F, jnp.asarray(p)) for weight, F, p in sides)


def relaxed(share, F):
    """Least energy over the jump, by a general optimiser."""
    return minimize(energy, np.zeros(2), (share, F), "BFGS", jac=jax.grad(energy), options={"gtol": 1e-9}).fun


@pytest.mark.parametrize("share", [0.2, 0.7])
def test_stress_is_the_derivative_of_the_least_energy_over_the_jump(share):
    P, h = np.asarray(STRESS(jnp.asarray(F), params(share))), 1e-3
    for i in range(2):
        for J in range(2):
            step = np.zeros((2, 2))
            step[i, J] = h
            slope = (relaxed(share, F + step) - relaxed(share, F - step)) / (2 * h)
            assert P[i, J] == pytest.approx(slope, abs=2e-5 * np.abs(P).max())


@pytest.mark.parametrize(("share", "alone"), [(0.0, SOFT), (1.0, STIFF)])
def test_a_cell_of_one_layer_is_that_material(share, alone):
    np.testing.assert_allclose(STRESS(jnp.asarray(F), params(share)), BASIS.stress(F, alone), rtol=1e-12)


def test_layers_of_one_material_are_that_material_whatever_their_share():
    for share in (0.0, 0.4, 1.0):
        layered = STRESS(jnp.asarray(F), params(share, SOFT, SOFT))
        np.testing.assert_allclose(layered, BASIS.stress(F, SOFT), rtol=1e-10)


def test_layers_are_softer_than_a_mixture_across_and_as_stiff_along():
    small = 1e-4

    def stiffness(direction):
        strain = np.eye(2) + small * np.multiply.outer(direction, direction)
        P = np.asarray(STRESS(jnp.asarray(strain), params(0.5)))
        mixed = 0.5 * (np.asarray(BASIS.stress(strain, STIFF)) + np.asarray(BASIS.stress(strain, SOFT)))
        return direction @ P @ direction, direction @ mixed @ direction

    across, mixed = stiffness(NORMAL)
    assert across < 0.5 * mixed
    along, mixed = stiffness(np.array([-0.8, 0.6]))
    assert 0.6 * mixed < along <= mixed


def test_first_derivatives_are_exact_in_either_mode_and_the_tangent_is_symmetric():
    p, h = params(0.3), 1e-6
    by_F = np.asarray(jax.jit(jax.jacfwd(LAYERS.stress))(jnp.asarray(F), p))
    np.testing.assert_allclose(by_F, by_F.transpose(2, 3, 0, 1), atol=1e-10)
    forward, backward = (np.asarray(jax.jit(d(LAYERS.stress, 1))(F, p)) for d in (jax.jacfwd, jax.jacrev))
    np.testing.assert_allclose(forward, backward, atol=1e-10)
    for k in range(len(p)):
        step = jnp.zeros_like(p).at[k].set(h)
        slope = (np.asarray(STRESS(F, p + step)) - np.asarray(STRESS(F, p - step))) / (2 * h)
        np.testing.assert_allclose(forward[..., k], slope, atol=1e-6)


def test_points_at_once_are_points_one_by_one():
    shares = np.array([0.0, 0.3, 1.0])
    together = LAYERS.field(np.stack([STIFF, SOFT]), shares, np.tile(NORMAL, (3, 1)))
    at_once = STRESS(jnp.broadcast_to(jnp.asarray(F)[:, :, None], (2, 2, 3)), jnp.asarray(together.T))
    for k, share in enumerate(shares):
        np.testing.assert_allclose(at_once[..., k], STRESS(jnp.asarray(F), params(share)), rtol=1e-12)
