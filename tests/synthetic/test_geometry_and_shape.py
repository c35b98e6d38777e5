"""Shapes mean the same however they are drawn, and are found again from a field."""

import numpy as np
import pytest
from PIL import Image

from hypernode.config.geometries import Disc, Glyph, Gradient, Ring, Stroke
from hypernode.config.geometries import Image as ImageShape
from hypernode.evaluation.shape import boundary_distance, dice, find_inclusion, registered_dice
from hypernode.fem.mesh import rectilinear
from hypernode.synthetic.geometry import make_shape

AXIS = np.linspace(0, 1, 61)
MESH = rectilinear(AXIS, AXIS)


def cells(geometry):
    return make_shape(geometry)(MESH.centres) > 0.5


def test_disc_and_ring_have_their_areas():
    assert abs(cells(Disc(shape="disc", radius=0.3)).mean() - np.pi * 0.09) < 0.01
    ring = cells(Ring(shape="ring", inner_radius=0.2, outer_radius=0.4))
    assert abs(ring.mean() - np.pi * 0.12) < 0.01


def test_a_straight_stroke_has_round_ends_and_a_bent_one_passes_its_points():
    straight = cells(Stroke(shape="stroke", points=[(0.2, 0.5), (0.8, 0.5)], width=0.2))
    assert abs(straight.mean() - (0.6 * 0.2 + np.pi * 0.01)) < 0.01
    points = [(0.2, 0.2), (0.5, 0.8), (0.8, 0.3)]
    bent = make_shape(Stroke(shape="stroke", points=points, width=0.1))
    assert bent(np.array(points)).all() and not bent(np.array([(0.5, 0.3), (0.5, 0.9)])).any()
    rim = bent(np.array([(0.5, 0.8 + 0.049), (0.5, 0.8 + 0.06)]))
    assert rim.tolist() == [1.0, 0.0]


def test_the_counter_of_a_P_is_matrix():
    P = make_shape(Glyph(shape="glyph", text="P", height=0.8))
    column = P(np.stack([np.full(200, 0.5), np.linspace(0.5, 0.95, 200)], axis=1)) > 0.5
    changes = np.count_nonzero(np.diff(column.astype(int)))
    assert changes >= 3, "bowl, counter, bowl"


def test_a_shape_drawn_in_an_image_file_is_the_same_shape(tmp_path):
    disc = Disc(shape="disc", radius=0.2, centre=(0.3, 0.7))
    axis = (np.arange(400) + 0.5) / 400
    X = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    pixels = make_shape(disc)(X).reshape(400, 400)[::-1]
    Image.fromarray((255 * pixels).astype(np.uint8)).save(tmp_path / "disc.png")
    drawn = ImageShape(shape="image", path=str(tmp_path / "disc.png"))
    assert dice(cells(drawn), cells(disc)) > 0.99


def test_a_mask_means_the_same_at_any_depth_and_on_any_background(tmp_path):
    bright = np.zeros((40, 40), dtype=bool)
    bright[5:20, 10:30] = True
    white = np.full((40, 40), 255, dtype=np.uint8)
    opaque = np.where(bright, white, 0)
    drawings = {
        "8 bits": (Image.fromarray(opaque), {}),
        "16 bits": (Image.fromarray(np.where(bright, 60000, 300).astype(np.uint16)), {}),
        "palette": (Image.fromarray(opaque).convert("P"), {}),
        "dark on bright": (Image.fromarray(255 - opaque), {"invert": True}),
        "white on nothing": (Image.fromarray(np.dstack([white, opaque])), {}),
        "black on nothing": (Image.fromarray(np.dstack([0 * white, opaque])), {"invert": True}),
        "labels 0 and 1": (Image.fromarray(bright.astype(np.uint8)), {"threshold": 0.002}),
    }
    for name, (picture, options) in drawings.items():
        picture.save(tmp_path / "mask.png")
        drawn = cells(ImageShape(shape="image", path=str(tmp_path / "mask.png"), **options))
        x, y = MESH.centres.T
        assert np.array_equal(drawn, (np.abs(x - 0.5) < 0.25) & (y > 0.5) & (y < 0.875)), name


@pytest.mark.parametrize("level", [0, 255])
def test_an_image_without_a_shape_is_refused(tmp_path, level):
    Image.fromarray(np.full((4, 4), level, dtype=np.uint8)).save(tmp_path / "blank.png")
    with pytest.raises(ValueError, match=r"blank\.png: (no|every) pixel belongs to the shape: luminance goes from"):
        make_shape(ImageShape(shape="image", path=str(tmp_path / "blank.png")))


def test_gradient_runs_from_zero_to_one():
    values = make_shape(Gradient(shape="gradient", direction=90.0))(np.array([[0.5, 0.0], [0.5, 0.5], [0.5, 1.0]]))
    np.testing.assert_allclose(values, [0.0, 0.5, 1.0], atol=1e-12)


def test_stiff_and_soft_inclusions_are_both_found():
    truth = cells(Glyph(shape="glyph", text="X"))
    noise = 0.05 * np.random.default_rng(0).normal(size=len(truth))
    for sign in (1.0, -1.0):
        assert dice(find_inclusion(MESH, sign * truth + noise), truth) > 0.99


def test_three_cells_beyond_all_others_do_not_hide_the_inclusion():
    truth = cells(Disc(shape="disc", radius=0.3))
    field = 1.0 + truth
    field[:3] = 40.0
    assert dice(find_inclusion(MESH, field), truth) > 0.98


def test_a_uniform_field_has_no_inclusion():
    assert not find_inclusion(MESH, np.ones(len(MESH.cells))).any()


def test_boundary_distance_of_a_shifted_square_is_its_shift():
    X = MESH.centres
    square = lambda shift: (np.abs(X[:, 0] - 0.5 - shift) < 0.2) & (np.abs(X[:, 1] - 0.5) < 0.2)  # noqa: E731
    assert boundary_distance(MESH, square(0), square(0)) == 0.0
    assert 0.01 < boundary_distance(MESH, square(0), square(1 / 30)) < 1 / 30


def test_registration_undoes_a_small_shift():
    disc = make_shape(Disc(shape="disc", radius=0.2))
    found = disc(MESH.centres - (0.05, -0.025)) > 0.5
    score, (dx, dy, _, _) = registered_dice(found, disc, MESH.centres)
    assert score > 0.99 and abs(dx - 0.05) < 1e-9 and abs(dy + 0.025) < 1e-9


def test_registration_finds_a_shift_between_the_points_of_its_first_grid():
    disc = make_shape(Disc(shape="disc", radius=0.2))
    found = disc(MESH.centres - (0.0125, 0.0375)) > 0.5
    assert registered_dice(found, disc, MESH.centres)[0] > 0.99
