"""Kinds of fault that a second look at folders of one sheet found: each is right, said, or refused with its key."""

from itertools import pairwise

import numpy as np
import pytest

from hypernode.dic.dialects import BY_NAME
from hypernode.dic.forces.clock_times import spread
from hypernode.dic.points import read_points
from hypernode.inspection.folder import inspect
from hypernode.inspection.report import report
from tests.dic.pulls import HEADER, LINES, STEP, fields, write
from tests.inspection.test_situations import SIZE, force_at, record, said_of

GIVEN = {**SIZE, "frame_rate": 1.0}


def right(found, elongation=lambda number: STEP * number):
    case = found.sheet.cases[0]
    np.testing.assert_allclose(case.stretch, 1.0 + elongation(case.numbers), atol=1e-3)
    np.testing.assert_allclose(case.force[1, 1], force_at(elongation(case.numbers)), rtol=3e-3)
    return not said_of(found)


def test_tension_that_is_counted_as_negative_is_turned_by_a_factor(tmp_path):
    folder = write(tmp_path / "pull", fields())
    record(folder, force=lambda e: -force_at(e))
    assert "--set force_factor=-1" in said_of(inspect(folder, GIVEN))
    assert right(inspect(folder, {**GIVEN, "force_factor": -1.0}))


def test_a_tenth_of_the_sheet_is_said_to_be_another_unit(tmp_path):
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    tenth = lambda k, u: [0.1 * x, 0.1 * y, 0.1 * u[..., 0], 0.1 * u[..., 1]]  # noqa: E731
    header = "no,no2,no3,no4,x [mm],y [mm],u [mm],v [mm]"
    folder = write(tmp_path / "pull", fields(), header=header, more=tenth)
    record(folder)
    assert "check the size, pixel_size and the unit of the files" in said_of(inspect(folder, GIVEN))


def test_increments_without_a_force_are_asked_about(tmp_path):
    frames = fields()
    folder = write(tmp_path / "pull", [frames[0], *(b - a for a, b in pairwise(frames))])
    found = inspect(folder, {**GIVEN, "force_file": None})
    assert "--set increments=true adds them up" in said_of(found)
    assert not said_of(inspect(folder, {**GIVEN, "force_file": None, "increments": True}))
    whole = write(tmp_path / "whole", frames)
    assert not said_of(inspect(whole, {**GIVEN, "force_file": None}))


def test_rows_of_nothing_but_zeros_are_lost_points(tmp_path):
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    gone = np.random.default_rng(1).random(x.shape) < 0.05
    blank = lambda k, u: [np.where(gone & (k > 0), 0.0, each) for each in (x, y, u[..., 0], u[..., 1])]  # noqa: E731
    folder = write(tmp_path / "pull", fields(), header="a,b,c,d,x [mm],y [mm],u [mm],v [mm]", more=blank)
    record(folder)
    found = inspect(folder, GIVEN)
    assert right(found)
    lost = np.isnan(found.field.series.frames[-1].displacement).any(axis=2)
    np.testing.assert_array_equal(lost, gone)


def test_ticks_of_whole_seconds_are_spread_over_their_samples(tmp_path):
    folder = write(tmp_path / "pull", fields())
    record(folder, "Time,Force (N)", lambda t, way, f: f"10:00:{int(t + 1e-9):02d},{f:.6f}")
    assert right(inspect(folder, GIVEN))
    # The first tick had begun before the record.
    assert spread([0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3]) == pytest.approx(np.arange(11) * 0.25 + 0.5)


def test_a_record_whose_columns_stand_between_blanks_is_read(tmp_path):
    folder = write(tmp_path / "pull", fields())
    record(folder, "time(s) force(N)", lambda t, way, f: f"{t:.2f}  {f:.6f}")
    assert right(inspect(folder, GIVEN))


def test_a_record_without_a_header_is_told_to_have_one(tmp_path):
    folder = write(tmp_path / "pull", fields())
    record(folder, "0,0", lambda t, way, f: f"{t:.2f},{f:.6f}")
    assert "write one above them, as Time (s),Force (N)" in said_of(inspect(folder, GIVEN))


def test_points_without_confidence_are_lost(tmp_path):
    gone = np.random.default_rng(1).random((13, 13)) < 0.05
    frames = [np.where(gone[..., None] & (k > 0), 0.7, u) for k, u in enumerate(fields())]
    more = lambda k, u: [np.where(gone & (k > 0), 0.0, 0.93)]  # noqa: E731
    folder = write(tmp_path / "pull", frames, header=HEADER + ",confidence", more=more)
    record(folder)
    assert right(inspect(folder, GIVEN))


def test_the_report_says_where_a_frame_rate_is_all_that_pairs_forces(tmp_path):
    folder = write(tmp_path / "pull", fields())
    record(folder)
    told = "only frame_rate = 1 pairs its forces"
    assert told not in " ".join(report(inspect(folder, GIVEN)))
    record(folder, "Time (s),Force (N)", lambda t, way, f: f"{t:.2f},{f:.6f}")
    assert told in " ".join(" ".join(report(inspect(folder, GIVEN))).split())


def test_forces_of_arrays_without_the_sheet_at_rest_belong_to_their_frames(tmp_path):
    folder, u = tmp_path / "pull", np.stack(fields())[1:]
    folder.mkdir()
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    np.savez(folder / "pull.npz", x=x, y=y, u=u[..., 0], v=u[..., 1], force=force_at(STEP * np.arange(1, 9)))
    given = {**GIVEN, "arrays": {"unit": "mm"}, "implied_reference": True}
    assert right(inspect(folder, given), lambda number: STEP * (number + 1))


def test_rubbish_that_a_column_tells_is_refused_with_the_key_of_that_column(tmp_path):
    rng = np.random.default_rng(4)
    gone = rng.random((13, 13)) < 0.06
    # Beside the ends, by which a load is told.
    gone[1:3, 2:5] = gone[-3:-1, 6:9] = True
    frames = [np.where(gone[..., None] & (k > 0), rng.normal(0.0, 1.0, u.shape), u) for k, u in enumerate(fields())]
    more = lambda k, u: [0.0 * u[..., 0], np.where(gone & (k > 0), 0.3, 0.98)]  # noqa: E731
    folder = write(tmp_path / "pull", frames, header=HEADER + ",exx,zncc", more=more)
    record(folder, "Time (s),Force (N)", lambda t, way, f: f"{t:.2f},{f:.6f}")
    assert "valid={zncc: [LOW, HIGH]}" in said_of(inspect(folder, GIVEN))
    found = inspect(folder, {**GIVEN, "valid": {"zncc": [0.8, None]}})
    # What is said is about the points beside the ends alone: are they lost, or a hole?
    assert not right(found) and said_of(found).startswith("6 neighbouring points inside are measured in no")


def test_rows_of_zeros_leave_other_lost_points_of_a_program_lost(tmp_path):
    header = "X,Y,U,V,sigma"
    rows = ["0,0,0,0,-1", "0,0,0,0,-1", "7.5,0.3,0,0,-1", "1,1,0.1,0.2,0.01", "2,1,0.1,0.3,0.01"]
    path = tmp_path / "f.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    # A lost point of this program has a dummy for its position.
    np.testing.assert_array_equal(read_points(path, BY_NAME["vic3d"]).position, [[1.0, 1.0], [2.0, 1.0]])
