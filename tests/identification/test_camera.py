"""Seeing through a correlation window."""

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.identification.camera import line_average, window_average

LINES = np.array([0.0, 0.1, 0.25, 0.4, 0.5, 0.7, 0.8, 1.0])


@pytest.mark.parametrize("width", [0.05, 0.2, 0.6])
def test_a_linear_field_looks_the_same_through_any_window(width):
    mesh = rectilinear(LINES, LINES)
    field = mesh.nodes @ np.array([[0.1, 0.3], [-0.2, 0.2]]) + 0.5
    seen = (window_average(mesh, width) @ field.ravel()).reshape(-1, 2)
    np.testing.assert_allclose(seen, field, atol=1e-12)


def test_a_kink_is_rounded_by_the_window_average_of_its_neighbourhood():
    x = np.linspace(0.0, 1.0, 11)
    seen = line_average(x, 0.1) @ np.abs(x - 0.5)
    # Mean of |s| over [-0.05, 0.05]; one cell further on the field is linear over the window.
    assert seen[5] == pytest.approx(0.025)
    np.testing.assert_allclose(np.delete(seen, 5), np.delete(np.abs(x - 0.5), 5), atol=1e-12)


def test_beyond_the_edge_the_field_goes_on_antisymmetrically():
    x = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose((line_average(x, 0.3) @ x**2)[[0, -1]], [0.0, 1.0], atol=1e-12)


def test_nodes_whose_window_meets_a_hole_are_taken_as_they_are():
    keep = np.ones((7, 7), dtype=bool)
    keep[3, 3] = keep[3, 4] = keep[4, 3] = keep[4, 4] = False
    mesh = rectilinear(LINES, LINES, keep)
    average = window_average(mesh, 0.4)
    hole_edge = np.flatnonzero((np.abs(mesh.nodes - (0.4, 0.4)) < 1e-9).all(axis=1))[0]
    row = average[2 * hole_edge].toarray().ravel()
    assert row[2 * hole_edge] == 1.0 and np.abs(row).sum() == 1.0
    assert (np.asarray(average.sum(axis=1)) == pytest.approx(1.0)) and (average[0] != 0).sum() >= 1
