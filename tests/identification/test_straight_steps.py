"""A step of parameters is straight in the coefficients of the law, in which the stress is linear."""

import jax
import numpy as np
import pytest

from hypernode.identification.straight_steps import straight
from hypernode.mechanics.convex_basis import ConvexBasis

LAWS = [(), ("I1_squared", "I2"), ("I1_squared", "ogden"), ("I1_squared", "I2", "ogden"), ("J", "I1_squared")]
F = np.stack([np.diag([1.2, 1.1]), np.array([[1.1, 0.2], [0.0, 0.95]]), np.diag([1.3, 1.0])], axis=-1)


def stress(basis, materials):
    with jax.enable_x64(True):
        return np.stack([np.asarray(basis.stress(F, each[:, None] * np.ones(F.shape[-1]))) for each in materials])


@pytest.mark.parametrize("terms", LAWS)
def test_the_stress_changes_by_what_its_derivative_says_however_long_the_step(terms):
    basis, rng = ConvexBasis(terms, 0.3), np.random.default_rng(1)
    before = np.tile(basis.start, (2, 1)) + rng.uniform(0.1, 0.4, (2, len(basis.names)))
    change = rng.uniform(-0.1, 0.25, before.shape)
    small = 1e-6
    slope = (stress(basis, before + small * change) - stress(basis, before - small * change)) / (2.0 * small)
    found = stress(basis, straight(basis, before, change))
    np.testing.assert_allclose(found, stress(basis, before) + slope, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("terms", LAWS)
def test_a_level_that_would_vanish_is_changed_in_its_logarithm(terms):
    basis = ConvexBasis(terms, 0.3)
    before, change = basis.start[None], np.zeros((1, len(basis.names)))
    change[:, 0] = -0.9
    np.testing.assert_allclose(straight(basis, before, change), before + change)


def test_no_coefficient_falls_below_none():
    basis = ConvexBasis(("I1_squared",), 0.3)
    found = straight(basis, basis.start[None], np.array([[0.0, -0.5]]))
    assert found[0, 1] == pytest.approx(basis.lowest[1])


def test_fibres_keep_their_share_of_the_change_whatever_the_level_does():
    basis = ConvexBasis(("fibre",), 0.3)
    change = np.array([[0.25, 0.1, 0.05, 0.3]])
    found = straight(basis, basis.start[None], change) - basis.start
    np.testing.assert_allclose(found[0, 1:], [0.08, 0.04, 0.3])


def test_a_material_of_other_shares_does_not_bend_the_step_of_another():
    basis = ConvexBasis(("ogden",), 0.3)
    before = np.array([[0.0, 0.01, 0.01, 0.01], [0.0, 1.2, 1.2, 1.2]])
    change = np.full(before.shape, 0.05)
    both = straight(basis, before, change)
    for k in range(2):
        np.testing.assert_allclose(both[k], straight(basis, before[k : k + 1], change[k : k + 1])[0], rtol=1e-12)
