"""Factors line by line of nodes solve what dense algebra solves, whatever the lines, and say where they cannot."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.sparse

from hypernode.fem.block_cholesky import BlockCholesky
from hypernode.fem.block_factors import BlockFactors
from hypernode.fem.mesh import rectilinear
from hypernode.fem.nodal_forces import stiffness_matrix


def sheet(keep=None):
    """(held Laplacian of an oblong sheet, the line of every node)."""
    mesh = rectilinear(np.linspace(0.0, 2.0, 8) ** 1.2, np.linspace(0.0, 1.0, 13), keep)
    energy = stiffness_matrix(mesh) + 0.1 * scipy.sparse.identity(len(mesh.nodes))
    return energy, mesh


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("pierced", [False, True])
def test_solves_as_dense_algebra_does(axis, pierced):
    keep = np.ones((12, 7), bool)
    # A corner left out shortens lines, a hole interrupts them.
    keep[:3, :2] = keep[6:9, 3:5] = not pierced
    energy, mesh = sheet(keep)
    line = np.searchsorted(mesh.lines[axis], mesh.nodes[:, axis])
    order = np.random.default_rng(0).permutation(len(mesh.nodes))
    energy, line = energy.tocsc()[order][:, order], line[order]
    right = np.random.default_rng(1).normal(size=(len(order), 3))
    found = jax.jit(lambda factor, right: factor.solve(right))(BlockCholesky.of(energy, line), jnp.asarray(right))
    np.testing.assert_allclose(found, np.linalg.solve(energy.toarray(), right), rtol=2e-5, atol=2e-5)


def test_memory_grows_with_the_lines_and_not_with_all_pairs_of_nodes():
    energy, mesh = sheet()
    factor = BlockCholesky.of(energy, np.searchsorted(mesh.lines[1], mesh.nodes[:, 1]))
    assert factor.pivots.size + factor.below.size == 2 * 13 * 8**2


def test_unknowns_that_meet_beyond_the_next_line_are_refused():
    energy, mesh = sheet()
    line = np.searchsorted(mesh.lines[1], mesh.nodes[:, 1])
    line[line == 5] = 20
    with pytest.raises(ValueError, match="not neighbours"):
        BlockCholesky.of(energy, line)


@pytest.mark.parametrize("pierced", [False, True])
def test_blocks_of_neighbouring_unknowns_solve_many_columns_in_double_precision(pierced):
    keep = np.ones((12, 7), bool)
    keep[6:9, 3:5] = not pierced
    energy, mesh = sheet(keep)
    right = np.random.default_rng(1).normal(size=(len(mesh.nodes), 70))
    found = BlockFactors.of_band(energy, 2**20).solve(right)
    np.testing.assert_allclose(found, np.linalg.solve(energy.toarray(), right), rtol=1e-10, atol=1e-12)


def test_blocks_beyond_the_memory_that_they_may_take_are_not_made():
    energy, _ = sheet()
    # A line of 8 nodes: neighbours are at most 9 apart, so two sets of blocks take 16 * 104 * 9 bytes.
    assert BlockFactors.of_band(energy, 16 * 104 * 9) is not None
    assert BlockFactors.of_band(energy, 16 * 104 * 9 - 1) is None
