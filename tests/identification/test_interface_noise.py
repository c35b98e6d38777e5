"""What residuals share is told: with neighbours, with other steps, or with nothing."""

import numpy as np
import pytest
import scipy.ndimage

from hypernode.fem.mesh import rectilinear
from hypernode.identification.interface_noise import left_of

MESH = rectilinear(np.arange(31.0), np.arange(31.0))
NUMBER = 2 * len(MESH.nodes)
STEPS = 3


def left(maps, determined=0.0, grid=MESH):
    return left_of(grid, [np.arange(NUMBER)] * len(maps), list(maps), determined)


@pytest.fixture
def noise():
    return np.random.default_rng(7).normal(size=(STEPS, NUMBER))


def test_independent_residuals_are_worth_as_many_as_there_are(noise):
    found = left(noise)
    assert found.level == pytest.approx(1.0, abs=0.03) and not found.alike
    assert found.independent == pytest.approx(STEPS * NUMBER, rel=0.05)


def test_what_fitted_numbers_took_away_is_put_back(noise):
    assert left(np.sqrt(0.75) * noise, 0.25 * STEPS * NUMBER).level == pytest.approx(1.0, abs=0.03)


def test_errors_that_neighbours_share_are_fewer(noise):
    each = noise.reshape(STEPS, 31, 31, 2)
    smooth = scipy.ndimage.gaussian_filter(each, (0, 1.0, 1.0, 0), mode="wrap")
    found = left(smooth.reshape(STEPS, NUMBER) / smooth.std())
    # The mean of a field that a Gaussian of width s smoothed has the variance of one in 4 pi s^2 points.
    assert found.neighbours == pytest.approx(4.0 * np.pi, rel=0.25)


def test_what_is_left_alike_in_all_steps_is_no_noise(noise):
    found = left(np.tile(noise[:1], (STEPS, 1)))
    assert found.alike and found.independent == pytest.approx(NUMBER, rel=0.05)


def test_grey_levels_have_no_neighbours(noise):
    found = left(noise, grid=None)
    assert found.inflation == 1.0 and found.independent == STEPS * NUMBER
