"""Discrete equilibrium: divergence, resultants, and the distance from the nearest equilibrated stress."""

import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.fem.equilibrium_gap import EquilibriumGap, relative_gap
from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.fem.nodal_forces import nodal_force_matrices, stiffness_matrix
from hypernode.mechanics.loads import make_load


def graded(n, grading=1.0):
    return np.linspace(0.0, 1.0, n + 1) ** grading


def edges(kind):
    table = np.zeros((4, 2), dtype=bool)
    for edge, i in make_load(kind, [1.1]).constrained:
        table[EDGE_NAMES.index(edge), i] = True
    return table


def test_divergence_matches_a_manufactured_non_symmetric_field():
    # P_xY and P_yX differ, so a swap of indices cannot pass.
    mesh = rectilinear(graded(40), graded(40))
    x, y = mesh.centres.T
    P = np.array([[x**2, np.sin(2 * y) * x], [x * y**2, np.cos(x) + y**2]])
    X, Y = mesh.nodes.T
    exact = np.stack([2 * X + 2 * np.cos(2 * Y) * X, Y**2 + 2 * Y])
    D = nodal_force_matrices(mesh)
    interior = np.bincount(mesh.cells.ravel()) == 4
    for i in range(2):
        force = sum(D[J] @ P[i, J] for J in range(2))
        divergence = -force[interior] / mesh.areas.mean()
        assert np.abs(divergence - exact[i, interior]).max() < 2e-3


def test_reaction_force_is_independent_of_the_mesh():
    P = np.array([[2.0, 0.3], [-0.4, 1.5]])
    for n, grading in ((3, 1.0), (10, 1.0), (17, 1.4)):
        mesh = rectilinear(3.0 * graded(n, grading), 2.0 * graded(n + 2))
        D = nodal_force_matrices(mesh)
        nodal = np.stack([sum(D[J] @ np.full(len(mesh.cells), P[i, J]) for J in range(2)) for i in range(2)], 1)
        right = nodal[mesh.on_edge("right")].sum(axis=0)
        # Corner nodes also carry the horizontal edges' traction over half a cell.
        corners = mesh.on_edge("right") & (mesh.on_edge("top") | mesh.on_edge("bottom"))
        assert corners.sum() == 2
        np.testing.assert_allclose(right, P[:, 0] * 2.0, rtol=1e-12)


def test_equilibrated_stress_has_no_gap_and_a_wrong_force_has_its_own_size():
    mesh = rectilinear(graded(8), graded(8, 1.3))
    held = edges("equibiaxial")
    gap = EquilibriumGap.build(mesh, held, held)
    P = np.zeros((2, 2, 1, len(mesh.cells)))
    P[0, 0], P[1, 1] = 2.0, 1.0
    scale = jnp.ones(1)
    right, wrong = (float(gap.squared(jnp.asarray(P), jnp.array([[f, 1.0]]), scale)[0]) for f in (2.0, 2.2))
    assert abs(right) < 1e-10
    # The nearest stress with the right resultant differs by 0.2 everywhere.
    np.testing.assert_allclose(np.sqrt(wrong), 0.2, rtol=1e-4)


def test_stress_in_doubt_is_cheaper_to_correct():
    mesh = rectilinear(graded(8), graded(8))
    held = edges("equibiaxial")
    middle = np.all(np.abs(mesh.centres - 0.5) < 0.2, axis=1)
    P = np.zeros((2, 2, 1, len(mesh.cells)))
    P[0, 0], P[1, 1] = 1.0, 1.0
    P[0, 0, 0, middle] = 1.5
    variance = np.where(middle, 10.0, 1.0)

    def squared(variance):
        gap = EquilibriumGap.build(mesh, held, held, variance)
        return float(gap.squared(jnp.asarray(P), jnp.array([[1.0, 1.0]]), jnp.ones(1))[0])

    certain = squared(1.0)
    np.testing.assert_allclose(squared(np.full(len(mesh.cells), 4.0)), certain / 4.0, rtol=1e-3)
    assert certain / 10.0 < squared(variance) < certain / 2.0


def test_gap_does_not_punish_a_rigid_translation_that_nothing_holds():
    mesh = rectilinear(graded(6), graded(6))
    held = edges("uniaxial_x")
    gap = EquilibriumGap.build(mesh, held, held)
    P = np.zeros((2, 2, 1, len(mesh.cells)))
    P[0, 0] = 1.0
    assert abs(float(gap.squared(jnp.asarray(P), jnp.array([[1.0, 0.0]]), jnp.ones(1))[0])) < 1e-10


def test_laplacian_is_exact_for_linear_fields():
    mesh = rectilinear(graded(5, 1.2), 2.0 * graded(4))
    K = stiffness_matrix(mesh)
    u = 3.0 * mesh.nodes[:, 0] - 2.0 * mesh.nodes[:, 1]
    np.testing.assert_allclose(u @ (K @ u), 2.0 * (9.0 + 4.0), rtol=1e-12)


def test_cells_without_material_leave_the_mesh():
    keep = np.ones((5, 5), dtype=bool)
    keep[1:4, 1:4] = False
    mesh = rectilinear(graded(5), graded(5), keep)
    assert len(mesh.cells) == 16 and len(mesh.nodes) == 36 - 4
    np.testing.assert_allclose(mesh.areas.sum(), 16 / 25)


@pytest.mark.parametrize("kind", ["equibiaxial", "uniaxial_x"])
def test_the_sparse_gap_is_the_gap_of_the_training(kind):
    lines = np.linspace(0.0, 1.0, 7)
    mesh = rectilinear(lines, 1.4 * lines)
    constrained = edges(kind)
    P = np.random.default_rng(3).normal(size=(3, len(mesh.cells), 2, 2))
    resultant, scale = np.array([[1.0, 0.5], [2.0, 0.0], [0.1, 0.3]]), np.array([1.0, 2.0, 0.5])
    gap = EquilibriumGap.build(mesh, constrained, constrained)
    wanted = np.sqrt(gap.squared(np.moveaxis(P, (2, 3), (0, 1)), jnp.asarray(resultant), jnp.asarray(scale)))
    np.testing.assert_allclose(relative_gap(mesh, constrained, constrained, P, resultant, scale), wanted, rtol=1e-4)
