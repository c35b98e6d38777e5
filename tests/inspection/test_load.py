"""Every load that has a name is told from the frames, with its reason; what cannot be told is not."""

import numpy as np
import pytest

from hypernode.dic.frames import trimmed
from hypernode.dic.reading import read_series
from hypernode.dic.series import Frame, Series
from hypernode.inspection.load import recognised
from tests.inspection.folders import FIELDS, NOISE, one_end, write_frames


def load_of(field, folder, **settings):
    return recognised(trimmed(read_series(write_frames(folder, field, **settings)), 1))


@pytest.mark.parametrize("kind", FIELDS)
def test_every_load_is_recognised_through_noise(kind, tmp_path):
    found = load_of(FIELDS[kind], tmp_path, noise=10 * NOISE)
    assert found.kind == kind and found.frame == 4


@pytest.mark.parametrize("kind", ["clamped_y", "uniaxial_x", "shear"])
def test_a_camera_that_turns_by_half_a_degree_changes_nothing(kind, tmp_path):
    c, s = np.cos(0.01), np.sin(0.01)

    def turned(x, y, t):
        u, v = FIELDS[kind](x, y, t)
        moved = np.array([x + u, y + v])
        return np.array([c * moved[0] - s * moved[1] - x, s * moved[0] + c * moved[1] - y]) * (t > 0.0)

    assert load_of(turned, tmp_path).kind == kind


def test_a_sheet_that_is_held_at_one_end_only_has_no_simple_load(tmp_path):
    found = load_of(lambda x, y, t: one_end(y, x, t)[::-1], tmp_path)
    assert found.kind == "general" and "one end is held across and the other is not" in found.reason


def test_ends_that_bend_are_held_by_nothing_straight(tmp_path):
    found = load_of(lambda x, y, t: (-0.4 * t * (x - 0.5), t * y * (1 + 2 * np.sin(np.pi * x))), tmp_path)
    assert found.kind == "general" and "bend by" in found.reason


def test_where_nothing_contracts_held_ends_are_the_safe_choice(tmp_path):
    found = load_of(lambda x, y, t: (0.0 * x, t * y), tmp_path)
    assert found.kind == "clamped_y" and "look alike" in found.reason


def test_shear_along_y_has_no_name_of_its_own(tmp_path):
    found = load_of(lambda x, y, t: (0.0 * x, t * x), tmp_path)
    assert found.kind == "general" and "turn the pictures" in found.reason


@pytest.mark.parametrize(
    ("field", "why"),
    [
        (lambda x, y, t: (0.0 * x + t, 0.0 * y), "hardly deforms"),
        (lambda x, y, t: (-0.2 * t * x, -t * y), "the sheet gets shorter, by 2.4% along x and 12.0% along y"),
    ],
)
def test_a_sheet_that_moves_rigidly_or_is_let_go_shows_no_load(field, why, tmp_path):
    found = load_of(field, tmp_path)
    assert found.kind is None and why in found.reason


def test_lost_points_at_the_outline_move_the_end_lines_inward(tmp_path):
    def without_rim(number, rows):
        return [row for k, row in enumerate(rows) if k >= 26 or number == 1]

    found = load_of(FIELDS["clamped_y"], tmp_path, change=without_rim)
    assert found.kind == "clamped_y"


def test_a_series_that_lost_everything_tells_nothing():
    field = np.full((8, 8, 2), np.nan)
    series = Series(np.arange(8.0), np.arange(8.0), [Frame(1, 0.0 * np.ones((8, 8, 2))), Frame(2, field)])
    found = recognised(series)
    assert found.kind is None and found.frame == 1
