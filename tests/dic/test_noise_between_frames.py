"""Noise from differences of frames in time, whatever the deformation is in space."""

from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.dic.noise.between import between_frames
from hypernode.dic.noise.local import local_fit
from hypernode.dic.noise.steps import noise_of
from tests.dic.test_noise import POINTS, SMALL, deformed, noise

FRAMES = 20
TIME = np.arange(1, FRAMES + 1) / FRAMES


def pulled(pace=TIME, rough=0.0):
    """Frames of a sheet whose displacement bends with the load, and is rough in space by an amount."""
    sign = np.random.default_rng(9).choice([-1.0, 1.0], (POINTS, POINTS, 1))
    whole, bent = deformed("disc"), deformed("smooth", 0.1)
    return np.stack([t * (whole + rough * sign) + t**2 * bent for t in pace])


@pytest.mark.parametrize("length", [0.0, 0.7])
def test_noise_is_found_to_a_twentieth_on_a_sheet_that_is_rough_in_space(length):
    frames = pulled(rough=5.0 * SMALL) + SMALL * noise(1, FRAMES, length)
    level, found = between_frames(frames)
    np.testing.assert_allclose(level, SMALL, rtol=0.05)
    np.testing.assert_allclose(found, length, atol=0.1)
    assert (local_fit(frames)[0][-1] > 3.0 * SMALL).all()


def test_a_camera_that_moves_and_a_pace_that_changes_are_no_noise():
    rng = np.random.default_rng(3)
    pace = TIME + 0.2 / FRAMES * rng.normal(size=FRAMES)
    moved = 30.0 * SMALL * rng.normal(size=(FRAMES, 1, 1, 2))
    level, _ = between_frames(pulled(pace) + moved + SMALL * noise(2, FRAMES))
    np.testing.assert_allclose(level, SMALL, rtol=0.05)


def test_lost_points_and_the_reference_are_left_out():
    frames = pulled() + SMALL * noise(4, FRAMES)
    frames[:, 10:14, 20:30] = np.nan
    frames[np.random.default_rng(5).random(frames.shape[:3]) < 0.02] = np.nan
    level, _ = between_frames([np.zeros_like(frames[0]), *frames])
    np.testing.assert_allclose(level, SMALL, rtol=0.05)


def test_few_frames_and_a_motion_that_is_not_smooth_tell_nothing():
    frames = pulled() + SMALL * noise(6, FRAMES)
    assert between_frames(frames[:8]) is None
    # Many patterns, each at a pace of its own.
    waves = np.sin(2.0 * np.pi * np.arange(FRAMES)[:, None] / np.linspace(6.0, 12.0, 12))
    assert between_frames(frames + 0.01 * np.tensordot(waves, noise(7, 12), 1)) is None


def frames_of(displacement):
    frames = [SimpleNamespace(number=k, displacement=u) for k, u in enumerate(displacement)]
    return SimpleNamespace(frames=frames)


STEPS = np.array([3, 7, 11, 15, 19])
UNSTATED = SimpleNamespace(folder="pull", stated_noise=lambda mm: None)


def test_noise_of_load_steps_is_that_of_all_frames():
    found = noise_of(UNSTATED, frames_of(pulled() + SMALL * noise(8, FRAMES, 0.7)), STEPS, 1.0)
    np.testing.assert_allclose(found.scatter, SMALL, rtol=0.15)


def test_errors_that_change_slowly_are_told_by_steps_and_not_by_consecutive_frames():
    """A speckle that moves over its pixels is misread alike in consecutive frames, and otherwise in later ones."""
    bias = [np.cos(1.5 * np.pi * t) * a + np.sin(1.5 * np.pi * t) * b for t in TIME for a, b in [noise(10, 2)]]
    frames = pulled() + 5.0 * SMALL * np.stack(bias) + 0.1 * SMALL * noise(11, FRAMES)
    found = noise_of(UNSTATED, frames_of(frames), STEPS, 1.0)
    assert (found.scatter > 2.5 * SMALL).all()
