"""How well one shape covers another, and where it is read from a field."""

import numpy as np
import pytest

from hypernode.evaluation.shape import (
    PrintedShape,
    dice,
    find_inclusion,
    intersection_over_union,
    most_interior,
    score_printed,
    score_shape,
)
from tests.evaluation.files import square_mesh

MESH = square_mesh(20)
x, y = MESH.centres.T


def block(left, right, bottom=0.3, top=0.7):
    return (x > left) & (x < right) & (y > bottom) & (y < top)


def test_dice_and_iou_of_squares_that_overlap_by_three_quarters():
    a, b = block(0.2, 0.6), block(0.3, 0.7)
    assert dice(a, b) == pytest.approx(0.75) and intersection_over_union(a, b) == pytest.approx(0.6)
    assert dice(a, a) == 1.0 and dice(a, ~a) == 0.0
    nothing = np.zeros_like(a)
    assert dice(nothing, nothing) == 1.0 and intersection_over_union(nothing, nothing) == 1.0


def test_otsu_splits_two_levels_that_scatter_and_calls_the_inner_one_the_inclusion():
    truth = block(0.3, 0.7)
    scatter = np.random.default_rng(2).uniform(-0.3, 0.3, len(truth))
    for levels in ((1.0, 2.0), (2.0, 1.0)):
        field = np.where(truth, levels[1], levels[0]) + scatter
        np.testing.assert_array_equal(find_inclusion(MESH, field), truth)


def test_a_field_with_cells_that_have_no_stress_is_refused():
    field = np.where(block(0.3, 0.7), 2.0, 1.0)
    field[[3, 8]] = np.nan
    with pytest.raises(ValueError, match="2 of 400 cells have no stress"):
        find_inclusion(MESH, field)


def test_the_inclusion_over_matrix_is_the_ratio_of_their_means():
    shape = block(0.3, 0.7)
    judged = score_shape(MESH, np.where(shape, 3.0, 1.5), shape, None)
    assert judged.summary == {"inclusion_over_matrix": pytest.approx(2.0)} and not judged.variables
    known = score_shape(MESH, np.where(shape, 3.0, 1.5), shape, shape)
    assert known.summary["dice"] == known.summary["iou"] == 1.0 and known.summary["boundary_distance"] == 0.0


def test_a_printed_shape_seen_from_behind_is_upside_down():
    low = block(0.3, 0.7, 0.1, 0.4)
    corners = np.stack([MESH.lower, MESH.upper])
    high = PrintedShape(lambda X: 1.0 * ((abs(X[:, 0] - 0.5) < 0.2) & (abs(X[:, 1] - 0.75) < 0.15)), corners, True)
    judged, there = score_printed(MESH, low, high)
    np.testing.assert_array_equal(there, low)
    assert judged.summary["dice_registered"] == 1.0 and judged.summary["registration"] == (0.0, 0.0, 1.0, 1.0)


def test_curves_are_taken_where_each_phase_is_farthest_from_the_other():
    matrix, inclusion = most_interior(MESH, block(0.5, 0.9, 0.3, 0.7))
    assert abs(x[inclusion] - 0.7) < 0.06 and abs(y[inclusion] - 0.5) < 0.06
    assert x[matrix] < 0.4
