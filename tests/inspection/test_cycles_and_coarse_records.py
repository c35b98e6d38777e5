"""Cycles before the test, records of few samples, and words in which people name columns."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.io

from hypernode.inspection.folder import inspect
from tests.dic.pulls import HEADER, STEP, fields, write

SIZE = {"width": 12.0, "height": 12.0, "thickness": 1.0}
GIVEN = {**SIZE, "frame_rate": 1.0}


def force_at(elongation):
    stretch = 1.0 + np.asarray(elongation)
    return 3.0 * (stretch - stretch**-3.0)


def record(folder, time, elongation, header="Time (s),Displacement (mm),Force (N)"):
    """A sample of clock, crosshead and force at each time."""
    rows = [f"{t:.3f},{12.0 * e:.5f},{force_at(e):.6f}" for t, e in zip(time, elongation, strict=True)]
    (folder / "force_disp.csv").write_text("\n".join([header, *rows]) + "\n")


def said(found):
    return "\n".join(each.sentence for each in (*found.known.odd, *found.known.missing))


def right(found, elongation):
    """Numbers of the load steps, once each has the force of its elongation."""
    assert found.sheet is not None, said(found)
    case = found.sheet.cases[0]
    np.testing.assert_allclose(case.force[1, 1], force_at(np.asarray(elongation)[case.numbers]), rtol=2e-3)
    return case.numbers.tolist()


#: Loadings that grow from one to the next, the first to less than half of the last.
GROWING = STEP * np.array([0, 1, 2, 3, 1.5, 0.2, 1, 2, 3, 4, 5, 3, 0.3, 1, 2, 3, 4, 5, 6, 7, 8])


def test_loadings_that_grow_are_told_and_none_is_fitted_with_the_one_before(tmp_path):
    folder = write(tmp_path / "pull", fields(steps=GROWING[1:]))
    time = np.arange(0.0, 20.05, 0.1)
    record(folder, time, np.interp(time, np.arange(len(GROWING)), GROWING))
    found = inspect(folder, GIVEN)
    assert min(right(found, GROWING)) > 12
    assert "pulled 2 times (1 from frame 5 to 10, 2 from frame 12 to 20), and 1 times by less" in said(found)
    # The curve of one loading tells the pairing; with the branch before it nothing would.
    assert found.sheet.cases[0].pairing.max() < 0.05


#: When the machine turns, and how far the sheet is stretched then: two cycles before the pictures, and the test.
CYCLED = ([0.0, 2.0, 4.0, 6.0, 8.0, 16.0], STEP * np.array([0.0, 8.0, 0.0, 8.0, 0.0, 8.0]))


def test_frames_of_a_later_loading_are_told_when_the_record_pulls(tmp_path):
    folder = write(tmp_path / "pull", fields())
    time = np.arange(0.0, 16.05, 0.1)
    record(folder, time, np.interp(time, *CYCLED))
    found = inspect(folder, GIVEN)
    assert found.sheet is None
    assert "the record pulls 3 times, from 0, 4, 8 s on" in said(found) and "--set first_frame_time" in said(found)
    found = inspect(folder, {**GIVEN, "first_frame_time": 8.0})
    assert right(found, STEP * np.arange(9))[-1] == 8
    assert found.offsets[-1].by == "onset of force" and found.offsets[-1].seconds == pytest.approx(0.0, abs=0.3)


def test_a_record_that_begins_long_before_the_frames_says_when_its_force_begins(tmp_path):
    folder = write(tmp_path / "pull", fields())
    time = np.arange(0.0, 25.05, 0.1)
    record(folder, time, STEP * np.clip(time - 15.0, 0.0, 8.0))
    assert "first_frame_time=SECONDS (the force begins at about 15.1 s)" in said(inspect(folder, GIVEN))


def test_the_last_frame_between_two_samples_far_apart_has_no_force_either(tmp_path):
    folder = write(tmp_path / "pull", fields(count=9))
    # The machine stops with the last picture, and its next sample is a second later.
    time = np.arange(0.0, 11.0, 2.0)
    record(folder, time, STEP * np.minimum(time, 9.0))
    found = inspect(folder, GIVEN)
    assert right(found, STEP * np.arange(10)) == [2, 4, 6, 8]
    assert "(1, 3, 5, 7, 9)" in said(found)


def test_the_crosshead_of_a_program_s_table_may_have_any_usual_name(tmp_path):
    folder = write(tmp_path / "pull", fields())
    time = np.arange(0.0, 8.05, 0.1)
    for name in ("Crosshead (mm)", "Position (mm)", "Extension (mm)"):
        record(folder, time, STEP * time, f"Time (s),{name},Load (N)")
        found = inspect(folder, GIVEN)
        assert found.cycle.record.displacement[-1, 0] == pytest.approx(1.92)
        assert right(found, STEP * np.arange(9))[-1] == 8


def test_where_a_point_was_and_is_may_be_named_by_a_zero_alone(tmp_path):
    moved = lambda k, u: (np.arange(13.0) + u[..., 0], np.arange(13.0)[:, None] + u[..., 1])  # noqa: E731
    folder = write(tmp_path / "pull", fields(), header="X0 [mm],Y0 [mm],a,b,X [mm],Y [mm]", more=moved)
    record(folder, np.arange(0.0, 8.05, 0.1), STEP * np.arange(0.0, 8.05, 0.1))
    assert right(inspect(folder, GIVEN), STEP * np.arange(9))[-1] == 8


def test_a_column_of_any_name_may_tell_points_that_a_program_failed_at(tmp_path):
    rng, frames = np.random.default_rng(3), fields()
    bad = [rng.random((13, 13)) < (0.1 if k else 0.0) for k in range(9)]
    frames = [np.where(lost[..., None], rng.normal(0.0, 3.0, u.shape), u) for u, lost in zip(frames, bad, strict=True)]
    folder = write(tmp_path / "pull", frames, header=HEADER + ",Q7", more=lambda k, u: [np.where(bad[k], 9.0, 0.1)])
    record(folder, np.arange(0.0, 8.05, 0.1), STEP * np.arange(0.0, 8.05, 0.1))
    assert "--set 'valid={Q7: [LOW, HIGH]}'" in said(inspect(folder, GIVEN))
    assert right(inspect(folder, {**GIVEN, "valid": {"Q7": [0.0, 1.0]}}), STEP * np.arange(9))[-1] == 8


def test_arrays_in_metres_are_pixels_of_a_thousand_millimetres(tmp_path):
    folder = tmp_path / "pull"
    folder.mkdir()
    x, y = np.meshgrid(np.arange(13.0), np.arange(13.0))
    u = np.stack(fields()) / 1e3
    np.savez(folder / "pull.npz", X=x / 1e3, Y=y / 1e3, U=u[..., 0], V=u[..., 1], force=force_at(STEP * np.arange(9)))
    assert "metres are pixels of 1000 mm" in said(inspect(folder, GIVEN))
    found = inspect(folder, {**GIVEN, "arrays": {"unit": "pixel"}, "pixel_size": 1000.0, "y_points": "up"})
    assert right(found, STEP * np.arange(9))[-1] == 8


def test_a_key_that_is_wrong_is_not_asked_for_again(tmp_path):
    folder = write(tmp_path / "pull", fields())
    time = np.arange(0.0, 8.05, 0.1)
    record(folder, time, STEP * time)
    assert "leave newest_first out" in said(inspect(folder, {**GIVEN, "newest_first": True}))
    assert "may be since the reference already" in said(inspect(folder, {**GIVEN, "increments": True}))
    found = inspect(folder, {**GIVEN, "increments": True, "crosshead": False})
    assert "since the reference already, and increments: true wrong" in said(found)


@pytest.mark.parametrize(
    "pace", [lambda t: t, lambda t: t**2 / 8.0, lambda t: 8.0 * np.expm1(t / 3.0) / np.expm1(8 / 3)]
)
def test_increments_of_any_pace_are_added_up_without_a_word(tmp_path, pace):
    strain = STEP * pace(np.arange(9.0))
    frames = fields(steps=strain[1:])
    folder = write(tmp_path / "pull", [frames[0], *(b - a for a, b in pairwise(frames))])
    time = np.arange(0.0, 8.05, 0.1)
    record(folder, time, STEP * pace(time))
    for crosshead in (True, False):
        assert "increments" not in said(inspect(folder, {**GIVEN, "increments": True, "crosshead": crosshead}))


@pytest.mark.parametrize(
    "order", [(0, 1, 2, 3, 4, 5, 7, 6, 8), (0, 1, 5, 6, 7, 8, 2, 3, 4), (0, 2, 1, 3, 4, 5, 6, 7, 8)]
)
def test_frames_in_another_order_than_they_were_taken_are_said(tmp_path, order):
    frames = fields()
    folder = write(tmp_path / "pull", [frames[k] for k in order])
    time = np.arange(0.0, 8.05, 0.1)
    record(folder, time, STEP * time)
    found = said(inspect(folder, GIVEN))
    assert "frames may be numbered in another order" in found or "does not follow the stretch" in found


@pytest.mark.parametrize("odd", [2, 4, 6])
def test_a_frame_that_is_of_another_picture_is_said(tmp_path, odd):
    """It shows the sheet as the one before it does, with noise of its own."""
    frames = fields()
    frames[odd] = fields(seed=9)[odd - 1]
    folder = write(tmp_path / "pull", frames)
    time = np.arange(0.0, 8.05, 0.1)
    record(folder, time, STEP * time)
    assert f"the force at frame {odd}, " in said(inspect(folder, GIVEN))


def test_displacements_in_per_cent_ask_for_the_factor_that_answers_them(tmp_path):
    frames = [u / 0.12 for u in fields()]
    folder = write(tmp_path / "pull", frames, header="x [mm],y [mm],ux [%],uy [%]")
    time = np.arange(0.0, 8.05, 0.1)
    record(folder, time, STEP * time)
    assert "--set displacement_factor=N" in said(inspect(folder, GIVEN))
    assert right(inspect(folder, {**GIVEN, "displacement_factor": 0.12}), STEP * np.arange(9))[-1] == 8


def test_arrays_of_a_byte_order_that_nothing_reads_are_refused(tmp_path):
    folder = tmp_path / "pull"
    folder.mkdir()
    scipy.io.savemat(folder / "pull.mat", {"X": np.ones((3, 3))}, format="4")
    written = (folder / "pull.mat").read_bytes()
    (folder / "pull.mat").write_bytes(np.int32(4000).tobytes() + written[4:])
    assert "may be corrupt" in said(inspect(folder, GIVEN))
