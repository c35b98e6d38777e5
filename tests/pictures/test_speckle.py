"""A speckle pattern covers the share that it should, and is the same each time."""

import numpy as np
import pytest

from hypernode.config.pictures import Speckle
from hypernode.pictures.speckle import SCATTER, Discs, Pattern, sprayed

SIZE = (300.0, 200.0)


def sampled(pattern, size=SIZE):
    places = np.meshgrid(np.arange(0.0, size[0], 0.5), np.arange(0.0, size[1], 0.5))
    return pattern.at(np.stack(places, axis=-1).reshape(-1, 2))


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_the_stated_share_is_dark_to_the_edges(share):
    light = sampled(Pattern.of(sprayed(SIZE, Speckle(share=share)), SIZE))
    assert 1.0 - light.mean() == pytest.approx(share, abs=0.02)
    assert (light < 0.5).mean() == pytest.approx(share, abs=0.02)
    edge = light.reshape(400, 600)[:, :20]
    assert 1.0 - edge.mean() == pytest.approx(share, abs=0.06)


def test_diameters_have_the_stated_mean_and_scatter():
    radius = sprayed(SIZE, Speckle(diameter=6.0, share=0.6)).radius
    assert radius.mean() == pytest.approx(3.0, rel=0.02)
    assert radius.min() >= 3.0 * (1.0 - SCATTER) and radius.max() <= 3.0 * (1.0 + SCATTER)


def test_a_lone_disc_is_dark_within_half_dark_at_its_rim_and_bright_beyond():
    pattern = Pattern.of(Discs(np.array([[20.3, 11.7]]), np.array([4.0])), (40.0, 30.0))
    away = np.array([[1.0, 0.0], [0.0, -1.0], [-0.6, 0.8]])
    middle = np.array([20.3, 11.7])
    np.testing.assert_allclose(pattern.at(middle + 1.5 * away), 0.0, atol=1e-3)
    np.testing.assert_allclose(pattern.at(middle + 4.0 * away), 0.5, atol=1e-2)
    np.testing.assert_allclose(pattern.at(middle + 6.5 * away), 1.0, atol=1e-3)


def test_a_seed_makes_the_same_discs_and_another_others():
    one, again, other = (sprayed(SIZE, Speckle(seed=seed)) for seed in (3, 3, 4))
    assert one.centre.tobytes() == again.centre.tobytes() and one.radius.tobytes() == again.radius.tobytes()
    assert not np.allclose(one.centre, other.centre)
