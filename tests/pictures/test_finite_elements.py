"""Pictures compared on finite elements: what is found is the displacement, as well known as is said."""

import numpy as np
import pytest

from hypernode.config.correlation import Correlation
from hypernode.data.information import Information, assembled
from hypernode.fem.mesh import rectilinear
from hypernode.pictures.correlation import correlate
from hypernode.pictures.elements import Elements, lattice
from hypernode.pictures.errors import PictureError
from hypernode.pictures.finite_elements import OUTLINE, on_sheet, seen_by_elements
from hypernode.pictures.spline import Spline
from tests.pictures.warped import pattern, stretched, warped

SIDE, STEP = 180, 10
STRETCHES = (0.05, 0.10, 0.16)
MASK = np.zeros((SIDE, SIDE), bool)
MASK[20:-20, 25:-25] = True
NOISE = 2.0


def noisy(pictures, noise=NOISE):
    random = np.random.default_rng(3)
    return np.clip(np.round(pictures + noise * random.normal(size=pictures.shape)), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def clean():
    grey = pattern(SIDE)
    return np.stack([warped(grey, stretched(SIDE, most)) for most in (0.0, *STRETCHES)]).astype(float)


@pytest.fixture(scope="module")
def seen(clean):
    return seen_by_elements(noisy(clean), MASK, STEP, float(np.hypot(NOISE, 12.0**-0.5)))


def truth(nodes, frame):
    return np.stack(stretched(SIDE, STRETCHES[frame])(*nodes.T), axis=-1)


def waves(x):
    """Grey levels that change over some pixels."""
    return 100.0 + 30.0 * np.sin(0.5 * x[..., 0] + 0.2 * x[..., 1]) + 25.0 * np.cos(0.45 * x[..., 1] - 0.3 * x[..., 0])


def test_differences_of_grey_levels_change_as_their_derivative_says():
    H = np.array([[0.08, 0.03], [-0.02, 0.05]])
    row, column = np.mgrid[:100.0, :100.0]
    x = np.stack([column, row], axis=-1)
    picture = Spline.of(waves(x @ np.linalg.inv(np.eye(2) + H).T))
    mesh = lattice(MASK[:80, :80], 10)
    elements = Elements.of(mesh, waves(x))
    u, away = mesh.nodes @ H.T, np.random.default_rng(0).normal(size=mesh.nodes.shape)
    step = 1e-3
    before, at, after = (elements.linearise(picture, u + k * step * away) for k in (-1, 0, 1))
    change = (after.residual - before.residual) / (2.0 * step)
    # Half of the squared differences is quadratic with the information as its second derivative, and the derivative of
    # the gradient along any direction is what the information makes of it.
    K = assembled(elements.mesh.dofs, *elements.told(at, 0.0), u.size)[0]
    assert (change**2).sum() == pytest.approx(away.ravel() @ (K @ away.ravel()), rel=0.02)
    ends = [np.bincount(elements.mesh.dofs.ravel(), each.gradient.ravel(), u.size) for each in (before, after)]
    slope = (ends[1] - ends[0]) / (2.0 * step)
    assert np.linalg.norm(slope + K @ away.ravel()) < 0.02 * np.linalg.norm(slope)


def test_a_known_displacement_is_found_to_the_error_that_is_said(seen):
    for frame, (u, said) in enumerate(zip(seen.u, seen.noise, strict=True)):
        assert np.isfinite(u).all()
        error = u - truth(seen.mesh.nodes, frame)
        np.testing.assert_allclose(np.sqrt((error**2).mean(axis=0)), said, rtol=0.25)
        assert np.abs(error.mean(axis=0)).max() < 0.2 * said.max()
    assert seen.noise.max() < 0.1 and (seen.level < seen.noise).all()


def test_what_the_information_says_of_the_true_displacement_is_noise_of_unit_variance(seen):
    every = np.ones(len(seen.information.mesh.cells), bool)
    for frame in range(len(STRETCHES)):
        root, most_likely, observed = seen.information.root(frame, every)
        left = root @ truth(seen.information.mesh.nodes, frame).ravel() - most_likely
        assert len(left) == len(observed) == 2 * len(seen.information.mesh.nodes)
        # Within four standard deviations of a mean square by chance, and that of the level of noise itself.
        assert np.mean(left**2) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / len(left)) + 0.1)


def test_twice_the_noise_of_the_camera_is_twice_the_error_whether_it_is_known_or_not(clean, seen):
    pictures = noisy(clean, 2.0 * NOISE)
    unknown, known = (seen_by_elements(pictures[:2], MASK, STEP, noise) for noise in (None, 2.0 * NOISE))
    np.testing.assert_allclose(unknown.noise, 2.0 * seen.noise[:1], rtol=0.15)
    np.testing.assert_allclose(unknown.noise, known.noise, rtol=0.1)
    assert unknown.grey_noise == pytest.approx(2.0 * NOISE, rel=0.05)


def test_light_that_changes_moves_nothing(clean, seen):
    pictures = noisy(np.concatenate([clean[:1], 12.0 + 0.85 * clean[1:2]]))
    changed = seen_by_elements(pictures, MASK, STEP)
    assert np.sqrt(np.mean((changed.u[0] - truth(changed.mesh.nodes, 0)) ** 2)) < 1.5 * seen.noise[0].max()


def test_a_place_without_texture_is_lost_and_tells_nothing(clean):
    plain = clean[:2].copy()
    plain[:, 70:110, 70:110] = 128.0
    pictures = noisy(plain)
    found = seen_by_elements(pictures, MASK, STEP)
    inner = (np.abs(found.mesh.nodes - 90.0) < 10.0).all(axis=1)
    assert inner.any() and np.isnan(found.u[0, inner]).all() and np.isnan(found.correlation[0, inner]).all()
    centre = found.information.mesh.centres
    assert (found.information.matrix[0, (np.abs(centre - 90.0) < 10.0).all(axis=1)] == 0.0).all()
    away = (np.abs(found.mesh.nodes - 90.0) > 40.0).any(axis=1)
    assert np.isfinite(found.u[0, away]).all()


def test_pictures_of_something_else_are_refused(clean):
    other = noisy(np.stack([clean[0], warped(pattern(SIDE, seed=9), stretched(SIDE, 0.0))]))
    with pytest.raises(PictureError, match="picture 1 after the first: no displacement of elements of 10 pixels"):
        seen_by_elements(other, MASK, STEP)


def test_points_lie_on_the_grid_within_the_mask_and_are_those_of_an_engine(clean):
    found = correlate(noisy(clean[:2]), MASK, Correlation(engine="finite_elements", step=STEP))
    assert set(np.diff(np.unique(found.column))) == set(np.diff(np.unique(found.row))) == {STEP}
    near = np.ix_(np.arange(-OUTLINE, OUTLINE), np.arange(-OUTLINE, OUTLINE))
    for column, row in zip(found.column, found.row, strict=True):
        assert MASK[row + near[0], column + near[1]].all()
    assert found.displacement.shape == (2, len(found.column), 2) and (found.displacement[0] == 0.0).all()
    assert np.median(found.correlation[1]) > 0.98


def test_elements_that_fit_nowhere_are_refused(clean):
    with pytest.raises(PictureError, match="less than three elements of 60 pixels"):
        seen_by_elements(clean.astype(np.uint8), MASK, 60)


def test_information_is_the_same_in_pixels_and_on_the_sheet():
    random = np.random.default_rng(0)
    mesh = rectilinear(np.array([10.0, 14.0, 18.0]), np.array([20.0, 24.0, 28.0]))
    root = random.normal(size=(1, 4, 8, 8))
    pixels = Information(
        mesh, random.normal(size=(1, 9, 2)), root @ np.swapaxes(root, 2, 3), random.normal(size=(1, 4, 8))
    )
    length, origin = 0.02, np.array([8.0, 30.0])
    sheet = on_sheet(pixels, length, origin)
    upward = np.array([1.0, -1.0]) * length
    assert (sheet.mesh.areas > 0.0).all()
    np.testing.assert_allclose(sheet.mesh.nodes[sheet.mesh.cells[:, 0]], sheet.mesh.nodes[sheet.mesh.cells].min(axis=1))
    every = np.ones(4, bool)
    (R, most, _), (S, likely, _) = (each.root(0, every) for each in (pixels, sheet))
    for _ in range(3):
        u = random.normal(size=(9, 2))
        cost = [np.sum((A @ v.ravel() - b) ** 2) for A, v, b in ((R, u, most), (S, u * upward, likely))]
        assert cost[1] == pytest.approx(cost[0], rel=1e-6)
