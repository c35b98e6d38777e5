"""Coats of materials and the lines between them."""

import numpy as np

from hypernode.fem.mesh import rectilinear
from hypernode.fem.refinement import refine
from hypernode.identification.interfaces import Interfaces, Lines

GRID = rectilinear(np.arange(11.0), np.arange(11.0))
X, Y = GRID.nodes.T


def coats(*distances, subcells=1):
    refinement = refine(GRID, subcells)
    materials = np.arange(len(distances) + 1.0)[:, None]
    return Interfaces(Lines.of(GRID, refinement), materials, np.array(distances).reshape(len(distances), len(X)))


def test_a_later_coat_hides_an_earlier_one():
    found = coats(X - 3.0, X - 6.0).labels().reshape(10, 10)
    assert (found[:, :3] == 0).all() and (found[:, 3:6] == 1).all() and (found[:, 6:] == 2).all()


def test_a_line_cuts_cells_by_their_shares_on_any_mesh():
    for subcells in (1, 2):
        field = coats(X - 4.3, subcells=subcells)
        of, line = field.cells()
        area = np.bincount(of.one, minlength=2).astype(float)
        area[1] += (of.share - 1.0).sum()
        assert np.isclose(area[1] / len(of.one), 0.57) and (line == 0).all()


def test_two_coats_as_one_cover_what_both_did():
    field = coats(X - 3.0, X - 6.0, Y - 7.0)
    before = field.labels()
    for one, other in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)):
        after = field.merged(one, other)
        expected = field.materials[np.where(before == other, one, before), 0]
        np.testing.assert_array_equal(after.materials[after.labels(), 0], expected)


def test_numbers_of_a_field_give_it_back():
    field = coats(X - 3.2, Y - 6.1)
    near = field.near(1.3)
    again = field.at(field.numbers(near), near)
    np.testing.assert_array_equal(again.distances, field.distances)
    np.testing.assert_array_equal(again.materials, field.materials)
