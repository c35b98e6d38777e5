"""Errors of synthetic measurements are as large and as alike as their configuration says."""

import numpy as np
import pytest

from hypernode.config.synthetic import Noise
from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.synthetic.errors import with_force_errors, with_noise

MESH = rectilinear(np.linspace(0.0, 1.0, 61), np.linspace(0.0, 2.0, 81))
U = np.zeros((3, len(MESH.nodes), 2))


def test_neighbours_share_errors_of_the_stated_size_and_length():
    errors = with_noise(MESH, U, Noise(sigma=2e-3, seed=1, correlation_length=1.5))[0]
    assert errors.std() == pytest.approx(2e-3, rel=0.03)
    grid = errors.reshape(3, 81, 61, 2)
    for lag in (1, 2, 4):
        alike = (grid[:, :, lag:] * grid[:, :, :-lag]).mean() / errors.var()
        assert alike == pytest.approx(np.exp(-(lag**2) / (4.0 * 1.5**2)), abs=0.04)


def test_white_errors_are_alike_nowhere_and_each_repeat_has_its_own():
    errors = with_noise(MESH, U, Noise(sigma=1.0, repeats=2, seed=3))
    assert abs(np.corrcoef(errors[0].ravel(), errors[1].ravel())[0, 1]) < 0.01
    grid = errors[0].reshape(3, 81, 61, 2)
    assert abs((grid[:, :, 1:] * grid[:, :, :-1]).mean()) < 0.02
    more = with_noise(MESH, U, Noise(sigma=1.0, repeats=3, seed=3, outliers=0.01, outlier_size=5.0))
    moved = np.abs(more[:2] - errors).max(axis=-1) > 0.0
    assert moved.mean() == pytest.approx(0.01, rel=0.2)
    np.testing.assert_allclose(np.linalg.norm((more[:2] - errors)[moved], axis=-1), 5.0)


def test_a_load_cell_is_off_alike_in_all_steps_of_a_load_case_and_at_both_ends():
    force = np.full((4, 4, 2), np.nan)
    right, left = EDGE_NAMES.index("right"), EDGE_NAMES.index("left")
    force[:, right, 0] = [1.0, 2.0, 1.0, 2.0]
    force[:, left, 0] = -force[:, right, 0]
    cases = np.array([0, 0, 1, 1])
    gain = with_force_errors(force, cases, Noise(force_gain=0.1, seed=2)) / force
    offset = with_force_errors(force, cases, Noise(force_offset=0.1, seed=2)) - force
    own = with_force_errors(force, cases, Noise(force=0.1, seed=2)) / force
    for read in (gain, offset):
        off = read[:, right, 0]
        assert off[0] == pytest.approx(off[1]) and off[2] == pytest.approx(off[3]) and off[0] != pytest.approx(off[2])
    np.testing.assert_allclose(offset[:, left, 0], -offset[:, right, 0])
    np.testing.assert_allclose(own[:, left, 0], own[:, right, 0])
    assert len(set(np.round(own[:, right, 0], 9))) == 4
    assert np.isnan(gain[:, right, 1]).all()
    np.testing.assert_array_equal(with_force_errors(force, cases, Noise(sigma=1.0)), force)
