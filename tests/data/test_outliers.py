"""Points that stand alone are told from noise and from what the sheet itself does."""

import numpy as np

from hypernode.data.outliers import outliers
from hypernode.fem.mesh import rectilinear

MESH = rectilinear(np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 41))
NOISE = 1e-3
LEVEL = np.full((1, 2), NOISE)


def kinked(X):
    """A sheet whose left half stretches five times as much as the other, and across a corner."""
    u = np.where(X[:, 0] < 0.5, 0.5 * X[:, 0], 0.25 + 0.1 * (X[:, 0] - 0.5))
    return np.stack([u, 0.2 * np.maximum(X[:, 0] - 0.3, X[:, 1] - 0.6)], axis=1)[None]


def noisy(seed):
    return kinked(MESH.nodes) + np.random.default_rng(seed).normal(0.0, NOISE, (1, len(MESH.nodes), 2))


def test_noise_and_kinks_are_no_outliers():
    assert np.mean([outliers(MESH, noisy(seed), LEVEL) for seed in range(20)]) < 1e-4
    assert not outliers(MESH, kinked(MESH.nodes), np.full((1, 2), 1e-5)).any()


def test_points_off_by_ten_deviations_are_found_even_beside_lost_ones_and_others_are_kept():
    u, wrong = noisy(1), np.zeros((1, len(MESH.nodes)), bool)
    random = np.random.default_rng(2)
    inside = np.flatnonzero((np.abs(MESH.nodes - 0.5) < 0.45).all(axis=1))
    wrong[0, random.choice(inside, 30, replace=False)] = True
    u[wrong] += 10.0 * NOISE * np.array([0.6, -0.8]) + 4.0 * NOISE
    u[0, random.choice(inside, 30, replace=False)] = np.nan
    found = outliers(MESH, u, LEVEL)
    there = wrong & np.isfinite(u).all(axis=2)
    assert (found & there).sum() >= 0.85 * there.sum()
    assert (found & ~wrong).sum() <= 2


def test_nothing_is_told_where_noise_is_not_known():
    u = kinked(MESH.nodes)
    u[0, 800] += 1.0
    assert not outliers(MESH, u, np.zeros((1, 2))).any()


def test_a_graded_grid_that_is_strained_evenly_has_none():
    lines = np.cumsum(np.r_[0.0, np.geomspace(1.0, 3.0, 20)])
    mesh = rectilinear(lines, lines)
    u = (mesh.nodes @ np.array([[0.3, 0.1], [0.0, 0.2]]))[None]
    assert not outliers(mesh, u, np.full((1, 2), 1e-9)).any()


def test_points_at_the_tip_of_a_notch_are_kept_and_one_that_is_off_in_a_single_step_is_found():
    """A slit in from the left opens with the square root of the distance from its tip, in proportion to the load."""
    mesh, steps = rectilinear(np.arange(21.0), np.arange(21.0)), np.array([0.05, 0.1, 0.15, 0.2])
    x, y = (mesh.nodes - [4.0, 10.0]).T
    missing = (x <= 0.0) & (y == 0.0)
    opening = np.sqrt(np.hypot(x, y)) * np.sin(0.5 * np.arctan2(y, x))
    u = np.stack([0.0 * steps[:, None] * x, steps[:, None] * (mesh.nodes[:, 1] + 3.0 * opening)], axis=-1)
    u += np.random.default_rng(5).normal(0.0, 4 * NOISE, u.shape)
    u[:, missing] = np.nan
    level = np.full((4, 2), 4 * NOISE)
    assert not outliers(mesh, u, level).any()
    beside = int(np.flatnonzero((x == -1.0) & (y == 1.0))[0])
    u[1, beside] += 100.0 * NOISE
    found = outliers(mesh, u, level)
    # A neighbour at the rim may go with it.
    assert found[1, beside] and found.sum() <= 2
