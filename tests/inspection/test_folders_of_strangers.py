"""Folders of people who did not know the importer: their words, empty cells and clocks, and what they add below."""

import re

import numpy as np
import pytest

from hypernode.dic.forces.ticks import read_anew, spread_ticks
from hypernode.inspection.folder import inspect
from tests.dic.pulls import LINES, STEP, fields, write, write_record
from tests.inspection.test_other_laboratories import COLUMNS, GIVEN, frames_in_words, is_right, table
from tests.inspection.test_situations import TIME, force_at, said_of

FORCE = force_at(STEP * TIME)
RECORD = "Time (s),Displacement (mm),Force (N)"


def quiet_and_right(folder, given=GIVEN):
    found = inspect(folder, given)
    is_right(found)
    assert not said_of(found)


@pytest.mark.parametrize(
    "header",
    [
        "Coordenada X (mm);Coordenada Y (mm);Desplazamiento en X (mm);Desplazamiento en Y (mm)",
        "x [mm];y [mm];Verschiebung in x-Richtung [mm];Verschiebung in y-Richtung [mm]",
        "x [mm];y [mm];Déplacement suivant x [mm];Déplacement suivant y [mm]",
        "x-koordinat [mm];y-koordinat [mm];x-förskjutning [mm];y-förskjutning [mm]",
        "POS_X_MM;POS_Y_MM;DISP_X_MM;DISP_Y_MM",
    ],
)
def test_axes_behind_other_words_and_units_in_capitals_are_read(tmp_path, header):
    frames_in_words(tmp_path, header, ";", ",")
    table(tmp_path / "force_disp.csv", RECORD)
    quiet_and_right(tmp_path)


@pytest.mark.parametrize("name", ["u [mm]", "U [mm]", "v [mm/s]"])
def test_how_far_a_point_has_moved_is_no_component(tmp_path, name):
    size = lambda k, u: (u[..., 0], u[..., 1], np.linalg.norm(u, axis=-1))  # noqa: E731
    write(tmp_path, fields(), header=f"x [mm],y [mm],a,b,ux [mm],uy [mm],{name}", more=size)
    table(tmp_path / "force_disp.csv", RECORD)
    quiet_and_right(tmp_path)


@pytest.mark.parametrize("word", ["1.#QNAN", "-1.#IND", "nan(ind)", "#NUM!"])
def test_words_of_other_programs_for_no_number_are_lost_points(tmp_path, word):
    lost = lambda k, u: (np.where(np.arange(u[..., 0].size).reshape(u[..., 0].shape) == 80, 1, 0),)  # noqa: E731
    write(tmp_path, fields(), header="x [mm],y [mm],u [mm],v [mm],here", more=lost)
    for path in tmp_path.glob("frame*.csv"):
        text = re.sub(r"(?m)^([^,]*,[^,]*),[^,]*,[^,]*,1\.0+$", rf"\1,{word},{word},1", path.read_text())
        path.write_text(text)
    table(tmp_path / "force_disp.csv", RECORD)
    found = inspect(tmp_path, GIVEN)
    is_right(found)
    assert np.isnan(found.field.series.frames[-1].displacement).any(axis=-1).sum() == 1


@pytest.mark.parametrize("tail", ["# end of file\n", "Mean,,0.1,0.2\nMaximum,,0.3,0.4\n", "\nSumme\n\n"])
def test_what_stands_below_the_points_is_none_of_them(tmp_path, tail):
    for path in write(tmp_path, fields()).glob("*.csv"):
        path.write_text(path.read_text() + tail)
    table(tmp_path / "force_disp.csv", RECORD)
    quiet_and_right(tmp_path)


@pytest.mark.parametrize("tail", ["End of test\n", "\nMaximum,4.0,2.6\nStd.Dev.,1,0.5\n", "# 81 samples\n"])
def test_what_stands_below_the_samples_is_none_of_them(tmp_path, tail):
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", RECORD, tail=tail)
    quiet_and_right(tmp_path)


@pytest.mark.parametrize("empty", ["", "NaN", "-"])
def test_rows_without_a_force_are_no_samples(tmp_path, empty):
    write(tmp_path, fields())
    force = [f"{f:.6f}" if k % 5 == 0 else empty for k, f in enumerate(FORCE)]
    table(tmp_path / "force_disp.csv", RECORD, [*COLUMNS[:2], force])
    quiet_and_right(tmp_path)


def test_rows_that_begin_with_an_empty_cell_are_samples(tmp_path):
    write(tmp_path, fields())
    place = [f"{t:g}" if t in (0.0, 1.0) else "" for t in TIME]
    table(tmp_path / "force_disp.csv", "Remark,Time (s),Force (N)", [place, TIME, FORCE])
    quiet_and_right(tmp_path)


def test_units_may_stand_behind_a_blank(tmp_path):
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", '"Prüfzeit s";"Standardweg mm";"Kraft N"', COLUMNS, ";", ",")
    quiet_and_right(tmp_path)


def test_a_record_of_labview_is_read_and_a_row_that_is_none_is_named_in_any_file(tmp_path):
    write(tmp_path, fields())
    head = "\n".join(["LabVIEW Measurement\t", *(f"Key{k}\t{k}" for k in range(10)), "***End_of_Header***\t", "\t"])
    head = "\n".join([head, *(f"Key{k}\t{k}" for k in range(7)), "***End_of_Header***\t\t"])
    table(tmp_path / "log.lvm", f"{head}\nX_Value\tForce (N)\tComment", [TIME, FORCE], "\t", ",")
    quiet_and_right(tmp_path)
    table(tmp_path / "log.lvm", "Time (s);Force (N)", [TIME, ["overload", *map(str, FORCE[1:])]], ";")
    assert "log.lvm:2: not a sample" in said_of(inspect(tmp_path, GIVEN))


def test_a_clock_of_whole_seconds_is_spread_over_its_samples_in_any_column_of_time(tmp_path):
    """The mean of a second is the force in its middle, by which each force would be too large."""
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", "Time (s),Force (N)", [np.floor(TIME + 1e-9), FORCE])
    quiet_and_right(tmp_path)


def test_ticks_are_told_from_readings_of_one_instant():
    time = np.arange(0.0, 10.0, 0.1)
    force = (0.3 * time)[:, None]
    np.testing.assert_allclose(spread_ticks(np.floor(time + 1e-9), force), time, atol=1e-9)
    np.testing.assert_allclose(spread_ticks(np.round(time + 1e-9), force), time, atol=0.1)
    again, noise = np.repeat(time, 2), np.random.default_rng(3).normal(0.0, 0.03, 200)
    twice = np.repeat(force[:, 0], 2)[:, None]
    np.testing.assert_array_equal(spread_ticks(again, twice), again)
    np.testing.assert_array_equal(spread_ticks(again, twice + noise[:, None]), again)


@pytest.mark.parametrize("held", [4, 20])
def test_a_reading_that_is_written_again_is_no_force_of_a_later_time(tmp_path, held):
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", "Time (s),Force (N)", [TIME, FORCE[np.arange(len(TIME)) // held * held]])
    found = inspect(tmp_path, GIVEN)
    is_right(found)
    assert bool(said_of(found)) == (held > 10)


def test_few_digits_and_rests_are_no_readings_that_are_written_again():
    time = np.arange(0.0, 10.0, 0.01)
    for digit in (0.05, 0.0137):
        assert read_anew(np.round(np.round(0.3 * time / digit)[:, None] * digit, 4)).all()
    held = np.interp(time, [0, 2, 4, 6, 8, 10], [0, 0, 1, 1, 2, 2])[:, None]
    assert read_anew(held).all()
    assert read_anew(held + np.random.default_rng(1).normal(0.0, 0.01, held.shape)).all()


def test_files_named_by_their_load_are_in_its_order(tmp_path):
    loads = [f"pull_{force_at(STEP * k):.3f}N.csv" for k in range(9)]
    write(tmp_path, fields(), loads)
    table(tmp_path / "force_disp.csv", RECORD)
    quiet_and_right(tmp_path)


def test_numbers_with_a_point_and_no_unit_may_be_two_tests(tmp_path):
    write(tmp_path, fields(), [f"pull{1 + k // 5}.{k % 5:03d}.csv" for k in range(9)])
    table(tmp_path / "force_disp.csv", RECORD)
    assert "several series" in said_of(inspect(tmp_path, GIVEN))


def test_seconds_of_a_computer_are_shown_in_full_in_the_option_that_answers_them(tmp_path):
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", "timestamp,force_N", [1683194000.25 + TIME, FORCE])
    assert "--set first_frame_time=1683194000.25 where both begin at once" in said_of(inspect(tmp_path, GIVEN))
    quiet_and_right(tmp_path, {**GIVEN, "first_frame_time": 1683194000.25})


def test_few_points_of_the_reference_that_are_moved_are_told_from_a_sheet_that_is_stretched(tmp_path):
    frames = fields()
    frames[0][3, 4:7] = 2.0
    write(tmp_path, frames)
    write_record(tmp_path)
    said = said_of(inspect(tmp_path, GIVEN))
    assert "3 of 169 points are, and the others are at rest" in said and "valid={COLUMN: [LOW, HIGH]}" in said


def test_files_that_hold_nothing_are_refused_with_what_to_do(tmp_path):
    write(tmp_path, fields())
    write_record(tmp_path)
    for text in ("", "x [mm],y [mm],u [mm],v [mm]\n"):
        (tmp_path / "frame0004.csv").write_text(text)
        said = said_of(inspect(tmp_path, GIVEN))
        assert re.search(r"frame0004\.csv:\d+: .*: export it again, or delete it", said), said
    (tmp_path / "objects").mkdir()
    np.savez(tmp_path / "objects" / "t.npz", DIC_X=np.array([fields()[0], None], dtype=object), DIC_disp=fields())
    assert "holds objects of Python: store arrays of numbers" in said_of(inspect(tmp_path / "objects", GIVEN))


def test_what_a_folder_holds_in_the_place_of_frames_is_said_with_what_to_do(tmp_path):
    write(tmp_path / "one" / "DIC export", fields())
    table(tmp_path / "one" / "force_disp.csv", RECORD)
    assert "'DIC export' has 9 tables: name that folder, with the record of the machine in it" in said_of(
        inspect(tmp_path / "one", GIVEN)
    )
    (tmp_path / "two").mkdir()
    (tmp_path / "two" / "all.zip").write_bytes(b"PK")
    assert "'all.zip': unpack it" in said_of(inspect(tmp_path / "two", GIVEN))
    (tmp_path / "three").mkdir()
    table(tmp_path / "three" / "force_disp.csv", RECORD)
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    np.savez(tmp_path / "three" / "all.npz", xcoords=x, ycoords=y, first=np.stack(fields())[..., 0])
    assert "all.npz holds the arrays 'first', 'xcoords', 'ycoords'" in said_of(inspect(tmp_path / "three", GIVEN))
