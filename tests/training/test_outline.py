"""Tractions at the outline: nodal forces over the length of a node, or the mean stress of a test."""

from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.config.methods import Method
from hypernode.config.presets import presets
from hypernode.data.loading import Loading
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.solver import EquilibriumSolver
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from hypernode.training.outline import nodal_targets
from hypernode.training.problem import InverseProblem
from tests.sheets import SCALE, sheet, square

LEVEL = ConvexBasis(("I1_squared",), SCALE)


def problem(data, mesh, force):
    return SimpleNamespace(mesh=mesh, loading=Loading.of(data), nodal_force=force)


@pytest.mark.parametrize("load", ["equibiaxial", "uniaxial_x"])
def test_the_traction_at_a_node_is_that_of_the_stress_beside_it(load):
    """Of a homogeneous sheet exactly, at every node, on held edges and on free ones."""
    load = make_load(load, [1.05, 1.15])
    data, mesh, params = sheet(6, lambda X: np.zeros(len(X)), load)
    solver = EquilibriumSolver(mesh, lambda F, p: LEVEL.stress(F, p["params"]), {"params": params})
    u = data["u_measured"].values[0]
    force = np.stack([np.asarray(solver.internal_force(each)) for each in u])
    nodes, axes, signs, traction, weight = nodal_targets(problem(data, mesh, force))
    F = np.moveaxis(deformation_gradient(mesh, u), (2, 3), (0, 1))[..., 0]
    P = np.asarray(LEVEL.stress(jnp.asarray(F), params[0][:, None]))
    wanted = signs * P[:, axes].transpose(0, 2, 1)
    assert len(nodes) == 4 * 5 and (weight == 1).all()
    np.testing.assert_allclose(traction, wanted, atol=1e-8 * np.abs(P).max())


def test_of_resultants_alone_the_mean_stress_is_spread_over_the_nodes():
    data, mesh, _ = sheet(6, square, make_load("uniaxial_x", [1.1]))
    _, axes, signs, traction, weight = nodal_targets(problem(data, mesh, None))
    right = (axes == 0) & (signs == 1)
    P = Loading.of(data).P_average[0, 0, 0]
    np.testing.assert_allclose(traction[0, 0, right], P)
    np.testing.assert_allclose(traction[0, 0, (axes == 0) & (signs == -1)], -P)
    assert (traction[:, :, axes == 1] == 0).all() and (weight[0] == 1).all()


def test_what_is_held_by_an_unknown_force_is_not_asked():
    """The clamps hold x, and no load cell measures that."""
    data, mesh, _ = sheet(6, square, make_load("clamped_y", [1.1]))
    data["edge_force"][:, :, 0] = np.nan
    _, axes, _, _, weight = nodal_targets(problem(data, mesh, None))
    assert (weight[0][:, axes == 1] == 0).all() and (weight[1] == 1).all() and (weight[0][:, axes == 0] == 1).all()


def published(**changes):
    return Method.model_validate(presets()["paper_as_published"] | changes)


def test_a_method_that_does_not_normalise_leaves_the_stress_of_a_test_in_its_unit():
    data, _, _ = sheet(4, square, make_load("equibiaxial", [1.05, 1.1]))
    scales = [InverseProblem("sheet", published(normalised=n), {"measurement": data}).scale for n in (False, True)]
    np.testing.assert_array_equal(scales[0], 1.0)
    np.testing.assert_allclose(scales[1], Loading.of(data).scale, rtol=1e-6)


@pytest.mark.parametrize("from_bias", [False, True])
def test_the_network_begins_with_the_homogenised_material_only_from_its_bias(from_bias):
    data, _, _ = sheet(4, square, make_load("equibiaxial", [1.1]))
    method = published(initialisation={"iterations": 1, "from_bias": from_bias})
    inverse = InverseProblem("sheet", method, {"measurement": data})
    centre = jax.random.normal(jax.random.key(0), (126,))
    inverse.__dict__.update(centre=centre, node=SimpleNamespace(size=126))
    params, apply = inverse.trainable()
    missed = jnp.sqrt(jnp.mean((apply(params)(inverse.X) - centre) ** 2))
    assert (missed < 0.05) == from_bias
