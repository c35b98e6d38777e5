"""A picture shows the sheet where its displacement has carried it, as blurred, distorted and noisy as is stated."""

import numpy as np
import pytest

from hypernode.config.pictures import Pictures, Speckle
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import rectilinear
from hypernode.pictures.photograph import TOLERANCE, light, recorded, sheet_mask
from hypernode.pictures.speckle import Discs, Pattern, sprayed
from hypernode.pictures.view import View, view_of

#: A sheet of 1.2 x 1 that is 120 x 100 pixels large.
PIXEL = 0.01
SIZE = (120.0, 100.0)
MESH = rectilinear(np.linspace(0.0, 1.2, 7), np.linspace(0.0, 1.0, 5))
PATTERN = Pattern.of(sprayed(SIZE, Speckle(seed=1)), SIZE)
SHARP = Pictures(defocus=0.0)


def field(H, shift=(0.0, 0.0)):
    return NodalField.of(MESH, MESH.nodes @ np.array(H).T + shift)


REST = field(np.zeros((2, 2)))


def seen(*fields, margin=30, distortion=0.0):
    moved = np.stack([MESH.nodes + each.at(MESH.nodes) for each in fields])
    return view_of(moved, PIXEL, margin, distortion)


def test_a_shift_of_whole_pixels_moves_the_picture_exactly():
    view = seen(REST)
    first = light(PATTERN, REST, view, Pictures())
    moved = light(PATTERN, field(np.zeros((2, 2)), (7 * PIXEL, 4 * PIXEL)), view, Pictures())
    np.testing.assert_allclose(moved[:-4, 7:], first[4:, :-7], atol=1e-5)
    assert np.abs(moved - first).max() > 50.0


def test_a_stretched_sheet_is_traced_back_to_a_millionth_of_a_pixel():
    H = [[0.25, 0.05], [-0.03, 0.15]]
    view = seen(REST, field(H))
    places = view.places(np.stack(np.meshgrid(np.arange(view.columns), np.arange(view.rows)), axis=-1).reshape(-1, 2))
    X = field(H).sources(places, TOLERANCE * PIXEL)
    exact = np.linalg.solve(np.eye(2) + np.array(H), places.T).T
    assert np.abs(X - exact).max() / PIXEL < 1e-6
    # The picture shows, at each pixel, the light of that point of the sheet.
    picture = light(PATTERN, field(H), view, SHARP).ravel()
    within = ((exact > 0.02) & (exact < np.array([1.18, 0.98]))).all(axis=1)
    grey = SHARP.dark + (SHARP.bright - SHARP.dark) * PATTERN.at(exact[within] / PIXEL)
    assert np.corrcoef(picture[within], grey)[0, 1] > 0.99


def test_the_sheet_is_in_view_with_its_margin_and_lies_where_it_is_said_to():
    stretched = field([[0.2, 0.0], [0.0, 0.2]])
    view = seen(REST, stretched, margin=12)
    assert (view.columns, view.rows) == (144 + 24, 120 + 24)
    np.testing.assert_allclose(view.pixels(np.zeros((1, 2))), [[11.5, 131.5]])
    mask = sheet_mask(REST, view)
    assert mask.sum() == SIZE[0] * SIZE[1] and mask[131, 12] and not mask[132, 12] and not mask[131, 11]
    picture = light(PATTERN, stretched, view, SHARP)
    assert (picture[:12] == SHARP.background).all() and (picture[:, -12:] == SHARP.background).all()
    assert (picture[12:-12, 12:-12] > SHARP.background).all()


def test_noise_has_the_stated_deviation_and_each_picture_its_own():
    grey = np.full((200, 200), 120.3)
    pictures = [recorded(grey, Pictures(noise=4.0), frame).astype(float) for frame in (0, 1)]
    # Rounding adds the variance of an even distribution over one level.
    for picture in pictures:
        assert picture.std() == pytest.approx(np.sqrt(16.0 + 1.0 / 12.0), rel=0.02)
        assert picture.mean() == pytest.approx(120.3, abs=0.1)
    assert abs(np.corrcoef(pictures[0].ravel(), pictures[1].ravel())[0, 1]) < 0.02
    np.testing.assert_array_equal(recorded(grey, Pictures(noise=0.0), 0), 120)


def test_a_seed_makes_the_same_bytes_and_another_others():
    view = seen(REST)
    pictures = [recorded(light(PATTERN, REST, view, Pictures()), Pictures(seed=seed), 2) for seed in (5, 5, 6)]
    assert pictures[0].tobytes() == pictures[1].tobytes() != pictures[2].tobytes()


def test_defocus_spreads_a_spot_by_its_variance():
    spot = Pattern.of(Discs(np.array([[60.0, 50.0]]), np.array([3.0])), SIZE)
    view = seen(REST)

    def spread(defocus):
        dark = (SHARP.bright - light(spot, REST, view, Pictures(defocus=defocus)))[45:115, 45:135]
        column = np.arange(dark.shape[1])
        mean = (dark.sum(axis=0) * column).sum() / dark.sum()
        return (dark.sum(axis=0) * (column - mean) ** 2).sum() / dark.sum()

    assert spread(2.0) - spread(0.0) == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("distortion", [-0.03, 0.03])
def test_a_lens_moves_a_spot_by_the_stated_share_of_the_third_power(distortion):
    at = np.array([[105.0, 88.0]])
    spot = Pattern.of(Discs(at, np.array([3.0])), SIZE)
    views = [seen(REST, distortion=d) for d in (0.0, distortion)]

    def centroid(view):
        dark = SHARP.bright - light(spot, REST, view, SHARP)
        # Beside the sheet it is dark as well.
        column, row = np.round(view.pixels(at * PIXEL)[0]).astype(int)
        part = dark[row - 8 : row + 9, column - 8 : column + 9]
        steps = np.arange(-8, 9)
        return np.array([column, row]) + [(part.sum(axis=k) * steps).sum() / part.sum() for k in (0, 1)]

    straight, bent = (centroid(view) for view in views)
    centre = 0.5 * np.array([views[0].columns - 1, views[0].rows - 1])
    share = np.linalg.norm(straight - centre) / np.linalg.norm(centre)
    np.testing.assert_allclose(bent - straight, distortion * share**2 * (straight - centre), atol=0.02)


def test_places_and_pixels_are_inverse_and_the_corner_moves_by_the_stated_share():
    for distortion in (-0.1, 0.0, 0.1):
        view = View(
            rows=300, columns=400, mm_per_pixel=0.02, origin_column=50.0, origin_row=250.0, distortion=distortion
        )
        pixels = np.random.default_rng(0).uniform((0.0, 0.0), (399.0, 299.0), (500, 2))
        np.testing.assert_allclose(view.pixels(view.places(pixels)), pixels, atol=1e-8)
    straight, bent = (
        View(rows=300, columns=400, mm_per_pixel=0.02, origin_column=50.0, origin_row=250.0, distortion=d)
        for d in (0.0, 0.05)
    )
    corner = straight.places(np.array([[399.0, 0.0]]))
    np.testing.assert_allclose(bent.pixels(corner) - [[399.0, 0.0]], 0.05 * np.array([[199.5, -149.5]]))


def test_a_lens_that_moves_the_sheet_out_of_the_picture_is_refused():
    with pytest.raises(ValueError, match="margin of more than 4"):
        seen(REST, margin=4, distortion=0.1)
