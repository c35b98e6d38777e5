"""Lines through cells by signed distances at nodes."""

import numpy as np
import pytest

from hypernode.fem.contour import ContourLines, cut
from hypernode.fem.mesh import rectilinear

CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
X, Y = np.linspace(0.0, 2.0, 13), np.linspace(0.0, 1.0, 9)
MESH = rectilinear(X, Y)
LINES = ContourLines(MESH)


def disc(radius):
    """Signed distance from a circle around the middle, in the unit of length."""
    return radius - np.linalg.norm(MESH.nodes - [1.0, 0.5], axis=1)


@pytest.mark.parametrize("seed", range(6))
def test_the_share_of_a_square_beside_a_straight_line_is_its_area(seed):
    random = np.random.default_rng(seed)
    normal = random.normal(size=2)
    normal /= np.linalg.norm(normal)
    offset = random.uniform(-0.6, 0.6)
    share, *found = np.asarray(cut(1.7 * (CORNERS @ normal + offset)))
    fine = (np.arange(1000) + 0.5) / 1000 - 0.5
    inside = normal[0] * fine[:, None] + normal[1] * fine + offset > 0.0
    assert share == pytest.approx(inside.mean(), abs=1e-4)
    np.testing.assert_allclose(found, normal, atol=1e-9)


def test_slopes_are_those_of_differences():
    distance = LINES.distance(disc(0.31)) + 0.01 * np.random.default_rng(1).normal(size=len(MESH.nodes))
    h = 1e-6

    def changed(sign, node):
        moved = distance.copy()
        moved[node] += sign * h
        return LINES.cells(moved)

    cells = np.flatnonzero((LINES.cells(distance)[0] > 0.1) & (LINES.cells(distance)[0] < 0.9))
    assert len(cells) > 8
    for cell, slopes, turns in zip(cells, *LINES.slopes(distance, cells), strict=True):
        for corner, node in enumerate(MESH.cells[cell]):
            (more, one), (less, other) = changed(1.0, node), changed(-1.0, node)
            np.testing.assert_allclose(slopes[corner], (more - less)[cell] / (2 * h), atol=1e-6)
            np.testing.assert_allclose(turns[:, corner], (one - other)[cell] / (2 * h), atol=1e-6)


def test_areas_normals_and_length_of_a_circle():
    lines = ContourLines(rectilinear(np.linspace(0, 2, 61), np.linspace(0, 1, 41)))
    mesh = lines.mesh
    distance = lines.distance(0.3 - np.linalg.norm(mesh.nodes - [1.0, 0.5], axis=1))
    share, normal = lines.cells(distance)
    assert share @ mesh.areas == pytest.approx(np.pi * 0.3**2, rel=5e-3)
    assert lines.length(distance) == pytest.approx(2 * np.pi * 0.3, rel=5e-3)
    is_cut = (share > 0.0) & (share < 1.0)
    towards = np.array([1.0, 0.5]) - mesh.centres[is_cut]
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    assert (normal[is_cut] * towards).sum(axis=1).min() > 0.99


def test_shares_say_where_a_line_is_and_distances_are_true_in_sides_of_cells():
    chosen = np.abs(MESH.centres[:, 0] - 1.0) < 0.5
    distance = LINES.through(chosen.astype(float))
    share, _ = LINES.cells(distance)
    np.testing.assert_array_equal(share[chosen] >= 0.5, True)
    np.testing.assert_array_equal(share[~chosen] <= 0.5, True)
    # Sides of 1/6 along x. Where a line meets an edge of the sheet it is off by up to a tenth of a side.
    expected = (0.5 - np.abs(MESH.nodes[:, 0] - 1.0)) * 6
    np.testing.assert_allclose(distance, expected, atol=0.1)


def test_regions_of_fewer_nodes_than_a_cell_has_join_what_is_around_them():
    values = disc(0.31)
    values[0] = 0.2
    assert LINES.distance(values)[0] > 0.0
    without = LINES.distance(values, fewest=4)
    np.testing.assert_allclose(without, LINES.distance(disc(0.31)), atol=0.05)


def test_without_a_line_every_node_is_farther_from_one_than_the_grid_is_wide():
    far = LINES.distance(np.ones(len(MESH.nodes)))
    assert np.isfinite(far).all() and (far > max(len(line) - 1 for line in MESH.lines)).all()


def test_a_straight_line_does_not_bend():
    straight = MESH.nodes @ np.array([0.3, 0.7])
    assert np.abs(LINES.bends @ straight).max() < 1e-12
    hole = rectilinear(X, Y, np.arange(96).reshape(8, 12) != 40)
    assert np.abs(ContourLines(hole).bends @ (hole.nodes @ np.array([1.0, -2.0]))).max() < 1e-12


def test_a_line_that_moves_as_one_takes_its_distances_with_it():
    """To first order, near the line."""
    side, moved = 1.0 / 12.0, np.array([0.4, -0.3])
    mesh = rectilinear(np.linspace(0.0, 2.0, 25), np.linspace(0.0, 1.0, 13))

    def circle(shift):
        return (0.31 - np.linalg.norm(mesh.nodes - [1.0, 0.5] - side * shift, axis=1)) / side

    before, after = circle(np.zeros(2)), circle(moved)
    near = np.abs(before) < 1.0
    found = before + ContourLines(mesh).as_one(before) @ moved
    assert np.abs(found - after)[near].max() < 0.1 * np.abs(after - before)[near].max()


def test_slopes_are_as_many_as_cells_are_asked_for_more_often_than_there_are_cells():
    """Two lines may cut a cell, so that on a small grid more slopes are asked for than it has cells."""
    distance = np.linalg.norm(LINES.mesh.nodes - LINES.mesh.nodes.mean(axis=0), axis=1) - 0.31
    every = np.arange(len(LINES.mesh.cells))
    once, twice = LINES.slopes(distance, every), LINES.slopes(distance, np.concatenate([every, every[:3]]))
    for one, both in zip(once, twice, strict=True):
        np.testing.assert_array_equal(both, np.concatenate([one, one[:3]]))
