"""What cannot be a measurement, and points that a program says it failed at."""

from itertools import pairwise

import numpy as np
import pytest

from hypernode.config.specimens import Specimen
from hypernode.data.outliers import outliers
from hypernode.dic.declared import Declared
from hypernode.dic.errors import DicError
from hypernode.dic.frame_clock import frame_clock
from hypernode.dic.load_case import import_load_case
from hypernode.dic.noise.estimate import estimate_noise
from hypernode.dic.reading import read_series
from hypernode.dic.validity import known_columns
from hypernode.fem.mesh import rectilinear

from .pulls import HEADER, LINES, NOISE, fields, write, write_record

BLOCK = np.s_[7:11, 4:9]


def specimen_test(folder, **keys):
    return Specimen.model_validate(
        {"folder": str(folder), "width": 12, "height": 12, "thickness": 1, "frame_rate": 1, "load": "clamped_y", **keys}
    )


def lost(series, k):
    return np.isnan(series.frames[k].displacement).any(axis=2)


def block():
    where = np.zeros((len(LINES), len(LINES)), dtype=bool)
    where[BLOCK] = True
    return where


@pytest.mark.parametrize("value", ["zero", "before"])
def test_a_block_that_stands_still_while_the_sheet_moves_is_lost(tmp_path, value):
    frames = fields()
    for k in (5, 6, 7):
        frames[k][BLOCK] = 0.0 if value == "zero" else frames[4][BLOCK]
    series = read_series(write(tmp_path, frames))
    for k in range(1, 9):
        assert (lost(series, k) == (block() & (k in (5, 6, 7)))).all()
    (finding,) = series.findings
    assert "60 displacements in 3 frames" in finding and "count as lost" in finding


def test_what_hangs_together_with_points_that_stand_still_is_lost_where_it_hardly_moves(tmp_path):
    frames, place = fields(), np.s_[0:5, 4:9]
    for k in (6, 7):
        frames[k][place] = frames[5][place]
    series = read_series(write(tmp_path, frames))
    assert [lost(series, k).sum() for k in range(9)] == [0] * 6 + [25, 25, 0]


def test_a_block_that_stands_still_while_the_sheet_creeps_is_lost_once_the_others_are_ahead_of_it(tmp_path):
    frames = fields(steps=0.2 + 0.0008 * np.arange(1, 13))
    for k in range(4, 13):
        frames[k][BLOCK] = frames[3][BLOCK]
    series = read_series(write(tmp_path, frames))
    assert (lost(series, 12) == block()).all() and not lost(series, 3).any()


@pytest.mark.parametrize("number", [-999.0, 1e30])
def test_a_number_that_stands_for_none_is_no_displacement(tmp_path, number):
    frames = fields()
    frames[5][BLOCK] = number
    series = read_series(write(tmp_path, frames))
    assert [lost(series, k).sum() for k in range(9)] == [0] * 5 + [20, 0, 0, 0]


def test_a_correlation_of_zero_is_that_of_a_point_that_was_not_found(tmp_path):
    frames = fields()
    frames[5][BLOCK] += 1.0
    more = lambda k, u: [np.where(block() & (k == 5), 0.0, 0.98 * (k > 0))]  # noqa: E731
    series = read_series(write(tmp_path, frames, header=HEADER + ",corrcoef", more=more))
    assert [lost(series, k).sum() for k in range(9)] == [0] * 5 + [20, 0, 0, 0]


def test_displacements_in_another_unit_of_length_than_positions_are_taken_in_it(tmp_path):
    usual = read_series(write(tmp_path / "mm", fields()))
    thousandths = write(tmp_path / "um", [1e3 * u for u in fields()], header="x [mm],y [mm],u [um],v [um]")
    for a, b in zip(usual.frames, read_series(thousandths).frames, strict=True):
        np.testing.assert_allclose(a.displacement, b.displacement, atol=1e-6)
    with pytest.raises(DicError, match="in different units"):
        read_series(write(tmp_path / "px", fields(), header="x [mm],y [mm],u [px],v [px]"))


@pytest.mark.parametrize(
    ("column", "yes", "no"), [("outlier", "True", "False"), ("failed", "1", "0"), ("ok", "0", "1")]
)
def test_columns_that_say_yes_of_failed_points_and_no_of_found_ones(tmp_path, column, yes, no):
    frames = fields()
    frames[5][BLOCK] += 1.0
    more = lambda k, u: [np.where(block() & (k == 5), yes, no).astype(object)]  # noqa: E731
    series = read_series(write(tmp_path, frames, header=f"{HEADER},{column}", more=more))
    assert [lost(series, k).sum() for k in range(9)] == [0] * 5 + [20, 0, 0, 0]


@pytest.mark.parametrize(("sheet", "bounds"), [(1, (1.0, None)), (0, (None, 0.0))])
def test_whether_a_mask_is_the_sheet_or_what_is_cut_away_is_asked(tmp_path, sheet, bounds):
    frames = fields()
    frames[5][BLOCK] += 1.0
    more = lambda k, u: [np.where(block() & (k == 5), 1 - sheet, sheet)]  # noqa: E731
    folder = write(tmp_path, frames, header=f"{HEADER},mask", more=more)
    with pytest.raises(DicError, match=r"frame0005.csv:1: .* --set 'valid=\{mask: \[1, null\]\}'"):
        read_series(folder)
    series = read_series(folder, declared=Declared(valid={"mask": bounds}))
    assert [lost(series, k).sum() for k in range(9)] == [0] * 5 + [20, 0, 0, 0]


def test_a_table_in_mm_with_a_column_sigma_is_no_export_in_pixels_whose_y_points_down(tmp_path):
    frames = fields()
    series = read_series(write(tmp_path, frames, header=HEADER + ",sigma", more=lambda k, u: [0.01 + 0.0 * u[..., 0]]))
    np.testing.assert_allclose(series.frames[5].displacement, frames[5], atol=1e-6)


def test_a_frame_in_which_every_point_is_lost_is_no_reference(tmp_path):
    frames = fields()
    frames[5][:] = np.nan
    assert not read_series(write(tmp_path, frames)).findings


def test_points_of_a_held_edge_that_stand_still_are_measured(tmp_path):
    frames = fields()
    for u in frames:
        u[0] = 0.0
    series = read_series(write(tmp_path, frames))
    assert not any(lost(series, k).any() for k in range(9)) and not series.findings


def test_a_picture_that_was_inserted_is_not_used_and_takes_no_time(tmp_path):
    frames = fields()
    series = read_series(write(tmp_path, [*frames[:4], frames[3], *frames[4:8]]))
    assert [frame.number for frame in series.frames] == [0, 1, 2, 3, 5, 6, 7, 8]
    clock = frame_clock(specimen_test(tmp_path), series)
    np.testing.assert_allclose(clock.at([3, 5, 6]), [3.0, 4.0, 5.0])
    assert "4 (as 3)" in series.findings[0]


def test_a_picture_that_the_camera_missed_keeps_the_times_of_the_others(tmp_path):
    frames = fields()
    series = read_series(write(tmp_path, [*frames[:4], frames[3], *frames[5:]]))
    np.testing.assert_allclose(frame_clock(specimen_test(tmp_path), series).at([3, 5, 6]), [3.0, 5.0, 6.0])


def test_whether_a_camera_stood_still_is_asked_where_the_motion_does_not_tell(tmp_path):
    frames = fields()
    folder = write(tmp_path, [*frames[:4], *3 * [frames[3]], *frames[5:]])
    with pytest.raises(DicError, match="--set repeated_frames="):
        read_series(folder)
    series = read_series(folder, declared=Declared(repeated_frames="missed"))
    assert series.inserted == () and [f.number for f in series.frames] == [0, 1, 2, 3, 7, 8, 9, 10]


def test_a_frame_that_is_a_copy_cannot_be_chosen(tmp_path):
    frames = fields()
    folder = write(tmp_path, [*frames[:4], frames[3], *frames[4:8]])
    with pytest.raises(DicError, match="frame 4 is equal to the last bit"):
        read_series(folder, [2, 4])


def test_numbers_that_run_backwards_are_said_and_turned_on_request(tmp_path):
    folder = write(tmp_path, fields()[::-1])
    with pytest.raises(DicError, match="run backwards: say newest_first: true"):
        read_series(folder)
    series = read_series(folder, declared=Declared(newest_first=True))
    tops = [np.nanmean(frame.displacement[-1, :, 1]) for frame in series.frames]
    np.testing.assert_allclose(tops, 0.24 * np.arange(9), atol=0.01)


def test_increments_are_refused_by_their_force_and_added_up_on_request(tmp_path):
    frames = fields()
    steps = [frames[0], *(b - a for a, b in pairwise(frames))]
    folder = write_record(write(tmp_path, steps))
    with pytest.raises(DicError, match="say increments: true"):
        import_load_case(specimen_test(folder), specimen_test(folder))
    case = import_load_case(specimen_test(folder, increments=True), specimen_test(folder, increments=True))
    assert case.stretch[-1] == pytest.approx(1.16, abs=0.002)
    assert case.force[1, 1][-1] == pytest.approx(4.0)


@pytest.mark.parametrize("law", [lambda s: s, lambda s: s**2, lambda s: np.exp(15 * s) - 1])
def test_displacements_are_no_increments_whatever_the_law(tmp_path, law):
    folder = write(tmp_path, fields())
    time = np.arange(0.0, 8.05, 0.1)
    rows = [f"{t:.1f},{law(0.02 * t):.6f}" for t in time]
    (folder / "force_disp.csv").write_text("\n".join(["Time,Force", "(s),(N)", *rows]) + "\n")
    assert len(import_load_case(specimen_test(folder), specimen_test(folder)).numbers) > 1


@pytest.mark.parametrize(
    ("column", "good", "bad"),
    [
        ("zncc", 0.99, -4.0),
        ("Sigma", 0.01, -1.0),
        ("status", 4.0, -2.0),
        ("converged", 1.0, 0.0),
        ("valid", "yes", "no"),
    ],
)
def test_a_known_column_marks_failed_points(tmp_path, column, good, bad):
    def mark(k, u):
        kind = object if isinstance(good, str) else float
        cells = np.full(u.shape[:2], good, dtype=kind)
        cells[block() & (k in (2, 3))] = bad
        return [cells]

    frames = fields()
    for k in (2, 3):
        frames[k][BLOCK] += 0.3
    series = read_series(write(tmp_path, frames, header=f"{HEADER},{column}", more=mark))
    for k in range(9):
        assert (lost(series, k) == (block() & (k in (2, 3)))).all()


def test_a_key_names_the_column_of_another_program_and_its_valid_values(tmp_path):
    def mark(k, u):
        return [np.where(block() & (k == 2), 0.2, 0.9)]

    folder = write(tmp_path, fields(), header=f"{HEADER},trust", more=mark)
    assert not lost(read_series(folder), 2).any()
    series = read_series(folder, declared=Declared(valid={"trust": (0.5, None)}))
    assert (lost(series, 2) == block()).all() and not lost(series, 3).any()
    with pytest.raises(DicError, match="no column 'belief'"):
        read_series(folder, declared=Declared(valid={"belief": (0.5, None)}))


def test_points_lost_at_random_leave_the_noise_as_it_is():
    frames, rng = np.stack(fields()), np.random.default_rng(2)
    frames[1:][rng.random(frames[1:].shape[:3]) < 0.03] = np.nan
    level = estimate_noise(frames).level[1:]
    np.testing.assert_allclose(np.median(level, axis=0), NOISE, rtol=0.2)


def test_a_block_that_stands_still_hides_no_noise(tmp_path):
    frames = fields(12)
    for k in range(5, 13):
        frames[k][BLOCK] = frames[4][BLOCK]
    series = read_series(write(tmp_path, frames))
    level = estimate_noise(np.stack([frame.displacement for frame in series.frames])).level[1:]
    assert level.min() > 0.2 * NOISE


def test_a_kink_of_a_coarse_grid_is_no_mistake_and_a_point_off_it_in_one_step_is():
    rng, mesh = np.random.default_rng(4), rectilinear(LINES, LINES)
    x, y = mesh.nodes.T
    kink = np.maximum(0.0, 2.5 - np.hypot(x - 6.3, y - 6.1))
    steps = np.array([0.05, 0.1, 0.15, 0.2])
    u = np.stack([np.zeros((4, len(x))), steps[:, None] * (y + 0.4 * kink)], axis=-1)
    u += rng.normal(0.0, NOISE, u.shape)
    noise = np.full((4, 2), NOISE)
    assert not outliers(mesh, u, noise).any()
    u[2, 40] += 20 * NOISE
    found = outliers(mesh, u, noise)
    assert found.sum() == 1 and found[2, 40]


def test_a_reference_that_is_there_twice_is_said(tmp_path):
    frames = fields()
    series = read_series(write(tmp_path, [frames[0], *frames]))
    assert "frame 1 has no displacement at all" in series.findings[0]
    assert not read_series(write(tmp_path / "once", frames)).findings


def test_a_column_of_strain_that_is_negative_marks_no_point_as_failed():
    assert set(known_columns(["x", "u", "gamma", "beta", "exy", "sigma"])) == {"sigma"}


def test_single_points_at_zero_beside_a_held_end_are_lost(tmp_path):
    frames = fields()
    for k in range(1, 9):
        for row, column in ((1, 3), (1, 9), (6, 6), (12, 2)):
            frames[k][row, column] = 0.0
    lost = [np.isnan(frame.displacement).any(axis=2) for frame in read_series(write(tmp_path, frames)).frames[1:]]
    # In the first frame, a point beside the held end moves by no more than noise allows.
    assert all(each.sum() == 4 and each[1, 3] and each[1, 9] for each in lost[1:])
