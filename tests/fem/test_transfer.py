"""Fields that go from one mesh to another of the same sheet."""

import numpy as np

from hypernode.fem.mesh import rectilinear
from hypernode.fem.refinement import refine
from hypernode.fem.transfer import transfer

X, Y = np.array([0.0, 0.1, 0.3, 0.4, 0.7, 1.0]), np.array([0.0, 0.2, 0.25, 0.6])


def test_bilinear_fields_arrive_as_they_left():
    source, target = rectilinear(X, Y), rectilinear(np.linspace(0.0, 1.0, 8), np.linspace(0.0, 0.6, 5))
    values = [1.0 + 2.0 * x - y + 3.0 * x * y for x, y in (source.nodes.T, target.nodes.T)]
    np.testing.assert_allclose(transfer(source, target).nodes @ values[0], values[1], atol=1e-14)


def test_subcells_are_of_the_cell_that_they_divide():
    mesh = rectilinear(X, Y, np.arange(15).reshape(3, 5) != 7)
    divided = refine(mesh, 3)
    onto = transfer(mesh, divided.mesh)
    np.testing.assert_array_equal(onto.cells[divided.subcells], np.tile(np.arange(14)[:, None], (1, 9)))
    between = onto.nodes @ np.stack([mesh.nodes[:, 0], mesh.nodes[:, 1], mesh.nodes.prod(axis=1)], axis=1)
    own = divided.mesh.nodes
    np.testing.assert_allclose(between, np.stack([own[:, 0], own[:, 1], own.prod(axis=1)], axis=1), atol=1e-14)


def test_where_the_source_has_a_hole_its_nearest_cell_and_node_stand_in():
    keep = np.ones((5, 5), bool)
    keep[1:4, 1:4] = False
    lines = np.linspace(0.0, 1.0, 6)
    source, target = rectilinear(lines, lines, keep), rectilinear(lines, lines)
    onto = transfer(source, target)
    left = np.flatnonzero((np.abs(target.centres - [0.3, 0.5]) < 1e-9).all(axis=1))
    np.testing.assert_allclose(source.centres[onto.cells[left]], [[0.1, 0.5]])
    assert np.abs(onto.nodes @ np.ones(len(source.nodes)) - 1.0).max() < 1e-14
