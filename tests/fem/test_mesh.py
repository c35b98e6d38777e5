"""Meshes and their division into subcells."""

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.fem.refinement import refine

X_LINES, Y_LINES = np.array([0.0, 0.1, 0.25, 0.5, 1.0]), np.array([0.0, 0.3, 0.5, 0.8])


def with_hole():
    keep = np.ones((3, 4), dtype=bool)
    keep[1, 1] = keep[2, 3] = False
    return rectilinear(X_LINES, Y_LINES, keep)


@pytest.mark.parametrize("subcells", [1, 2, 3])
def test_subcells_fill_their_cells_and_no_hole(subcells):
    mesh = with_hole()
    refined = refine(mesh, subcells)
    np.testing.assert_allclose(refined.mesh.areas[refined.subcells].sum(axis=1), mesh.areas)
    np.testing.assert_allclose(refined.mesh.centres[refined.subcells].mean(axis=1), mesh.centres, atol=1e-12)
    assert refined.subcells.shape == (10, subcells**2)
    assert np.array_equal(np.sort(refined.subcells.ravel()), np.arange(len(refined.mesh.cells)))
    first, last = refined.mesh.centres[refined.subcells[0, [0, -1]]]
    assert subcells == 1 or (first < last).all(), "row by row from the lower left"


@pytest.mark.parametrize("subcells", [1, 2, 3])
def test_interpolation_keeps_the_values_of_old_nodes_and_is_bilinear_between(subcells):
    mesh = with_hole()
    refined = refine(mesh, subcells)
    np.testing.assert_array_equal(refined.mesh.nodes[refined.nodes], mesh.nodes)

    def field(X):
        return 0.2 + X[:, 0] - 2.0 * X[:, 1] + 0.7 * X[:, 0] * X[:, 1]

    np.testing.assert_allclose(refined.interpolation @ field(mesh.nodes), field(refined.mesh.nodes), atol=1e-12)


def test_a_mesh_divided_into_itself_is_itself():
    mesh = with_hole()
    same = refine(mesh, 1)
    assert np.array_equal(same.mesh.nodes, mesh.nodes) and np.array_equal(same.mesh.cells, mesh.cells)
    assert np.array_equal(same.interpolation.toarray(), np.eye(len(mesh.nodes)))


def test_nodes_around_a_cell_are_its_own_and_those_of_the_cells_that_touch_it():
    mesh = rectilinear(np.arange(6.0), np.arange(5.0))
    around = mesh.around().toarray()
    for cell, centre in enumerate(mesh.centres):
        near = (np.abs(mesh.nodes - centre) < 1.6).all(axis=1)
        np.testing.assert_array_equal(around[cell], near.astype(float))
