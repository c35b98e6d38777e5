"""Noise of displacements, measured from themselves: on fields of which noise and deformation are known."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from hypernode.dic.errors import DicError
from hypernode.dic.noise.correlation import independent_factor
from hypernode.dic.noise.estimate import estimate_noise
from hypernode.dic.noise.local import _told
from hypernode.dic.noise.static import frames_at_rest
from hypernode.dic.noise.steps import noise_of

POINTS = 50
#: Of a sheet of size 1.
SMALL = 7e-4


def deformed(kind: str, strain: float = 0.3, points: int = POINTS):
    """Displacement of a sheet of size 1: smooth, or with a disc that strains half as much, around which it kinks."""
    X, Y = np.meshgrid(np.linspace(0.0, 1.0, points), np.linspace(0.0, 1.0, points))
    if kind == "smooth":
        u = np.sin(2.0 * X + Y) / 6.0 + X**2 / 3.0
        v = Y + np.cos(2.0 * Y + 3.0 * X) / 6.0
        return strain * np.stack([u, v], axis=-1)
    x, y = X - 0.45, Y - 0.55
    inside = 0.5 / np.maximum(1.0, (x**2 + y**2) / 0.25**2)
    return strain * np.stack(
        [-0.3 * x * (1.0 - inside) + X**2 * Y / 15.0, y * (1.0 - inside) + Y**2 * X / 10.0], axis=-1
    )


def noise(seed: int, frames: int, length: float = 0.0, points: int = POINTS):
    """Noise of variance 1, white or smoothed by a Gaussian of a standard deviation in steps."""
    margin = int(np.ceil(8 * length))
    white = np.random.default_rng(seed).standard_normal((frames, points + 2 * margin, points + 2 * margin, 2))
    if length == 0.0:
        return white
    impulse = np.zeros(2 * margin + 1)
    impulse[margin] = 1.0
    gain = (gaussian_filter(impulse, length, truncate=8.0) ** 2).sum()
    smoothed = gaussian_filter(white, (0.0, length, length, 0.0), truncate=8.0) / gain
    return smoothed[:, margin:-margin, margin:-margin]


def loaded(kind: str, frames: int = 4):
    return np.stack([deformed(kind, 0.3 * (k + 1) / frames) for k in range(frames)])


@pytest.mark.parametrize("kind", ["smooth", "disc"])
@pytest.mark.parametrize("level", [SMALL, 3e-3, 1e-2])
def test_white_noise_is_measured_within_a_tenth_whatever_the_deformation(kind, level):
    found = estimate_noise(loaded(kind) + level * noise(1, 4))
    np.testing.assert_allclose(found.level, level, rtol=0.10)
    assert found.source == "local fit" and (found.correlation_length == 0.0).all()
    np.testing.assert_array_equal(found.equivalent, found.level)


def test_rounding_in_the_reference_is_not_the_noise_of_a_sheet_at_rest():
    """Software compares the reference with itself: what is left is white and tiny, and that of others is not."""
    frames = loaded("smooth") + SMALL * noise(2, 4, 2.0)
    alone = estimate_noise(np.concatenate([np.zeros((1, *frames.shape[1:])), frames]))
    found = estimate_noise(np.concatenate([1e-9 * noise(3, 1), frames]))
    assert found.source == "local fit" and np.isnan(found.level[0]).all()
    np.testing.assert_array_equal(found.equivalent[1:], alone.equivalent[1:])
    np.testing.assert_array_equal(found.correlation_length, alone.correlation_length)


@pytest.mark.parametrize("kind", ["smooth", "disc"])
@pytest.mark.parametrize(("level", "length"), [(SMALL, 1.0), (1e-2, 1.0), (3e-3, 2.0), (1e-2, 2.0)])
def test_correlated_noise_is_measured_with_its_length(kind, level, length):
    found = estimate_noise(loaded(kind) + level * noise(2, 4, length))
    np.testing.assert_allclose(found.level, level, rtol=0.20)
    np.testing.assert_allclose(found.correlation_length, length, rtol=0.25)


def test_noise_of_two_steps_below_kinks_is_taken_for_less_than_twice_as_large():
    found = estimate_noise(loaded("disc") + SMALL * noise(3, 4, 2.0))
    assert (found.level > 0.8 * SMALL).all() and (found.level < 2.0 * SMALL).all()
    np.testing.assert_allclose(found.correlation_length, 2.0, rtol=0.25)


@pytest.mark.parametrize("kind", ["smooth", "disc"])
def test_deformation_without_noise_is_no_noise(kind):
    assert (estimate_noise(loaded(kind)).level < SMALL / 10.0).all()


@pytest.mark.parametrize("share", [0.05, 0.30])
def test_lost_points_leave_the_level_as_it_is(share):
    u = loaded("disc") + SMALL * noise(4, 4)
    u[np.random.default_rng(5).random(u.shape[:3]) < share] = np.nan
    np.testing.assert_allclose(estimate_noise(u).level, SMALL, rtol=0.15)


def test_components_are_told_apart():
    found = estimate_noise(loaded("disc") + SMALL * np.array([1.0, 3.0]) * noise(6, 4))
    np.testing.assert_allclose(found.level / SMALL, np.tile([1.0, 3.0], (4, 1)), rtol=0.10)


def test_a_frame_of_three_times_the_noise_is_told_from_the_others():
    times = np.array([1.0, 1.0, 3.0, 1.0])
    found = estimate_noise(loaded("disc") + SMALL * times[:, None, None, None] * noise(7, 4))
    np.testing.assert_allclose(found.level / SMALL, np.stack([times, times], axis=1), rtol=0.10)


def test_a_sheet_turned_by_a_right_angle_has_the_same_noise_with_components_swapped():
    u = loaded("disc") + SMALL * np.array([1.0, 2.0]) * noise(8, 4, 1.0)
    turned = np.rot90(u, axes=(1, 2))[..., ::-1] * np.array([-1.0, 1.0])
    found, again = estimate_noise(u), estimate_noise(turned)
    np.testing.assert_allclose(again.level, found.level[:, ::-1], rtol=1e-6)
    np.testing.assert_array_equal(again.correlation_length, found.correlation_length[::-1])


def test_units_of_the_displacement_are_those_of_its_noise():
    u = loaded("disc") + SMALL * noise(9, 4, 1.0)
    found, in_pixels = estimate_noise(u), estimate_noise(1000.0 * u)
    np.testing.assert_allclose(in_pixels.level, 1000.0 * found.level, rtol=1e-6)
    np.testing.assert_allclose(in_pixels.equivalent, 1000.0 * found.equivalent, rtol=1e-6)


def test_equivalent_noise_has_the_power_of_correlated_noise_at_long_wavelengths():
    # Noise smoothed by a kernel has at zero wavenumber the power of the kernel's sum.
    for length in (1.0, 2.0):
        kernel = np.exp(-(np.arange(-40, 41) ** 2) / (2.0 * length**2))
        np.testing.assert_allclose(independent_factor(length), kernel.sum() ** 2 / (kernel**2).sum(), rtol=1e-3)
    found = estimate_noise(loaded("smooth") + 3e-3 * noise(10, 4, 1.0))
    np.testing.assert_allclose(found.equivalent, 3e-3 * independent_factor(1.0), rtol=0.20)


def at_rest_and_loaded(length=0.0, level=SMALL):
    """A reference of zeros, three frames of a sheet at rest before a camera that moves, and three loaded ones."""
    X, Y = np.meshgrid(np.linspace(0.0, 1.0, POINTS), np.linspace(0.0, 1.0, POINTS))
    shaken = np.stack([0.01 - 1e-4 * Y, -0.02 + 1e-4 * X], axis=-1)
    moves = np.concatenate([np.stack([0.0 * shaken, 0.5 * shaken, shaken]), loaded("disc", 3)])
    u = moves + level * noise(11, 6, length)
    return np.concatenate([np.zeros_like(u[:1]), u])


@pytest.mark.parametrize("length", [0.0, 1.0])
def test_static_frames_are_found_and_show_the_noise(length):
    found = estimate_noise(at_rest_and_loaded(length))
    assert found.source == "static frames" and np.isnan(found.level[0]).all()
    np.testing.assert_allclose(found.level[1:], SMALL, rtol=0.10)
    np.testing.assert_allclose(found.correlation_length, length, rtol=0.15)


def test_static_frames_show_noise_that_is_smoother_than_differences_see():
    u = at_rest_and_loaded(4.0)
    found = estimate_noise(u, static=[1, 2, 3])
    np.testing.assert_allclose(found.level[1:4], SMALL, rtol=0.25)
    np.testing.assert_allclose(found.correlation_length, 4.0, rtol=0.25)
    assert (estimate_noise(u, static=[]).level[1:4] < SMALL / 3.0).all()


def test_noise_that_grows_after_static_frames_is_seen_to_grow():
    u = at_rest_and_loaded()
    u[5] += np.sqrt(8.0) * SMALL * noise(12, 1)[0]
    times = np.array([1.0, 1.0, 1.0, 1.0, 3.0, 1.0])
    found = estimate_noise(u)
    assert found.source == "static frames"
    np.testing.assert_allclose(found.level[1:] / SMALL, np.stack([times, times], axis=1), rtol=0.10)


def test_a_sheet_that_strains_by_ten_of_its_uncertainties_is_not_at_rest():
    u = at_rest_and_loaded()
    level, length = np.full((7, 2), SMALL), np.zeros(2)
    level[0] = np.nan
    assert frames_at_rest(u, level, length) == [1, 2, 3]
    position = np.linspace(-0.5, 0.5, POINTS)
    uncertainty = SMALL / np.sqrt(POINTS * (position**2).sum())
    u[2, ..., 1] += 10.0 * uncertainty * position[:, None]
    assert frames_at_rest(u, level, length) == [1]


def test_a_sheet_that_bends_without_mean_strain_is_not_at_rest():
    u = at_rest_and_loaded()
    u[1, ..., 0] += 8.0 * SMALL * np.linspace(-1.0, 1.0, POINTS)[:, None] ** 2
    assert frames_at_rest(u[1:], np.full((6, 2), SMALL), np.zeros(2)) == []


@pytest.mark.parametrize("shape", [(5, 5), (3, 7)])
def test_a_grid_too_small_for_its_noise_says_what_to_give_instead(shape):
    with pytest.raises(DicError, match="noise_mm or noise_pixels"):
        estimate_noise(np.random.default_rng(13).standard_normal((2, *shape, 2)))


def test_the_smallest_grid_has_a_level_of_the_right_size():
    found = estimate_noise(SMALL * noise(14, 60, points=6), static=[])
    assert 0.8 * SMALL < np.median(found.level) < 1.2 * SMALL


def test_a_reference_of_zeros_alone_says_nothing():
    with pytest.raises(DicError, match="noise_mm or noise_pixels"):
        estimate_noise(np.zeros((1, POINTS, POINTS, 2)))
    with pytest.raises(DicError, match="frame 0, given as static"):
        estimate_noise(at_rest_and_loaded(), static=[0])


def test_the_log_has_the_noise_in_a_sentence():
    said = str(estimate_noise(loaded("disc") + 0.01 * noise(15, 4)))
    assert said.startswith("noise of displacements by local fit: 0.00") and "correlated over 0 and 0 grid steps" in said
    assert "\n" not in said


def test_a_frame_whose_deformation_hides_its_noise_is_as_noisy_as_the_others():
    level = np.array([[np.nan, np.nan], [0.0, 2.0], [1.0, 0.0], [3.0, 4.0]])
    np.testing.assert_array_equal(_told(level)[1:], [[2.0, 2.0], [1.0, 3.0], [3.0, 4.0]])
    np.testing.assert_array_equal(_told(np.array([[0.0, 0.0], [0.0, 2.0]])), [[2.0, 2.0], [2.0, 2.0]])
    np.testing.assert_array_equal(_told(np.zeros((2, 2))), np.zeros((2, 2)))


def imported(displacement):
    """The noise of frames that are all load steps, of a test in mm that states none."""
    frames = [SimpleNamespace(displacement=each, number=k) for k, each in enumerate(displacement)]
    test = SimpleNamespace(stated_noise=lambda mm: None, folder="sheet")
    return noise_of(test, SimpleNamespace(frames=frames), np.arange(len(frames)), 1.0)


def kinked(steps: int = 5):
    """A sheet of stiff grains: every line of points strains otherwise, and by another power of the load."""
    X, Y = np.meshgrid(np.linspace(0.0, 1.0, POINTS), np.linspace(0.0, 1.0, POINTS))
    random, load = np.random.default_rng(3), np.linspace(0.2, 1.0, steps)
    first, second = np.cumsum(random.choice([0.02, 1.0], (2, POINTS, POINTS, 2)), axis=1) * 0.3 / POINTS
    smooth = np.stack([X * Y, Y], axis=-1)
    return np.stack([0.3 * s * smooth + s * first + 0.2 * s**2 * second for s in load])


@pytest.mark.parametrize(("level", "length"), [(1e-5, 0.0), (1e-5, 1.0), (3e-5, 0.0)])
def test_what_all_steps_share_of_a_sheet_that_is_rough_itself_is_no_noise(level, length):
    found = imported(kinked() + level * noise(16, 5, length))
    np.testing.assert_allclose(found.scatter, level, rtol=0.25)
    np.testing.assert_allclose(found.level, level * independent_factor(length), rtol=0.3)
    assert "belongs to the sheet" in found.source


def test_errors_of_the_reference_which_do_not_grow_with_the_load_are_noise():
    found = imported(loaded("smooth", 5) + SMALL * noise(19, 1))
    np.testing.assert_allclose(found.scatter, SMALL, rtol=0.1)
    np.testing.assert_allclose(found.level, SMALL * np.sqrt(5.0), rtol=0.1)


def test_a_texture_that_misleads_every_picture_counts_as_noise():
    """Nine tenths of the variance in common: the mean of all steps has as much of it as one."""
    texture, own = noise(17, 1), noise(18, 5)
    found = imported(loaded("smooth", 5) + SMALL * (np.sqrt(0.9) * texture + np.sqrt(0.1) * own))
    np.testing.assert_allclose(found.scatter, SMALL, rtol=0.1)
    np.testing.assert_allclose(found.level, SMALL * np.sqrt(1.0 + 4.0 * 0.9), rtol=0.1)


def parted(steps: int = 5):
    """A sheet whose parts of a few points stretch otherwise: most differences along lines cross a kink."""
    X, Y = np.meshgrid(np.arange(POINTS, dtype=float), np.arange(POINTS, dtype=float))
    first, second = X + 0.7 * Y, X - 0.8 * Y
    ramps = [np.abs((each / size) % 2.0 - 1.0) for each, size in ((first, 5.1), (second, 6.3))]
    load = np.linspace(0.2, 1.0, steps)
    return np.stack([0.2 * np.stack([s * ramps[0], s * ramps[1] + 0.2 * s**2 * ramps[0]], axis=-1) for s in load])


@pytest.mark.parametrize("length", [0.0, 0.7])
def test_many_kinks_are_no_noise_that_neighbours_share(length):
    found = imported(parted() + SMALL * noise(20, 5, length))
    np.testing.assert_allclose(found.scatter, SMALL, rtol=0.3)
    assert found.level.max() < 3.0 * SMALL * independent_factor(length)


@pytest.mark.parametrize("lost", [0.1, 0.2])
def test_points_that_are_lost_in_some_steps_leave_the_level_known(lost):
    u = loaded("smooth", 6)[:, ::4, ::4] + SMALL * noise(21, 6, points=POINTS)[:, ::4, ::4]
    u[np.random.default_rng(22).random(u.shape[:3]) < lost] = np.nan
    found = imported(u)
    np.testing.assert_allclose(found.level.mean(axis=0), SMALL, rtol=0.3)
