"""What goes wrong when a folder is looked at for the first time is answered by what mends it."""

import numpy as np
import pytest

from hypernode.dic.errors import DicError
from hypernode.dic.specimen import import_specimen
from hypernode.inspection.folder import inspect
from tests.dic.exports import specimen, write
from tests.inspection.folders import COLUMNS, FIELDS, GIVEN, PIXEL, SIZE, write_frames, write_record


@pytest.fixture
def folder(tmp_path):
    write_frames(tmp_path / "pull", FIELDS["clamped_y"])
    write_record(tmp_path / "pull")
    return tmp_path / "pull"


def refused(folder, **given):
    return " ".join(remark.sentence for remark in inspect(folder, {**GIVEN, **given}).known.missing)


def odd(folder, **given):
    return [remark.sentence for remark in inspect(folder, {**GIVEN, **given}).known.odd]


def test_a_record_that_starts_long_before_the_pictures_asks_for_the_time_of_the_first(folder):
    path = folder / "force_disp.csv"
    names, units, *rows = path.read_text().splitlines()
    samples = [row.split(",") for row in rows]
    later = [f"{float(time) + 30.0},{force}" for time, force in samples]
    path.write_text("\n".join([names, units, "0,0", "29.9,0", *later, ""]))
    said = refused(folder)
    assert "from 0 to 3 s, when the frames are taken, the force stays between 0 and 0 N" in said
    assert "at 33 s it is" in said and "set first_frame_time" in said
    mended = inspect(folder, {**GIVEN, "first_frame_time": 30.0})
    assert not mended.known.missing and mended.sheet.cases[0].time.tolist() == [31.0, 32.0, 33.0]


def test_a_folder_of_folders_and_a_table_of_nobody_say_what_they_hold(folder):
    assert "found the folders 'pull': 'pull' has 5 tables: name that folder" in refused(folder.parent)
    for path in folder.glob("Pull*.csv"):
        path.write_text(path.read_text().replace("x [pixel];y [pixel];x-displacement", "a;b;c"))
    said = refused(folder)
    assert "Pull0001.csv begins 'a;b;c [pixel]" in said and "set format to table, and table to its columns" in said


def test_points_beyond_a_sheet_do_not_carry_its_force(folder):
    said = refused(folder, pixel_size=10.0 * PIXEL)
    assert f"points span {10.0 * 10.0 / 12.0 * SIZE[0]:.4g} mm along x, beyond the width of the sheet, 12 mm" in said
    spot = odd(folder, pixel_size=PIXEL / 1000.0)
    assert len(spot) == 1 and "hardly a spot of the sheet of 12 x 11 mm" in spot[0]


def test_a_strip_of_few_lines_says_how_many_rings_it_can_spare(tmp_path):
    strip = write_frames(
        tmp_path / "strip", FIELDS["clamped_x"], change=lambda number, rows: rows[: 5 * len(rows) // 12]
    )
    write_record(strip)
    assert "edge_ring = 1 leaves 11 x 3 of 13 x 5 points" in refused(strip, pixel_size=PIXEL)
    assert "set edge_ring to 0 at most" in refused(strip, pixel_size=PIXEL)
    assert not refused(strip, pixel_size=PIXEL, edge_ring=0, height=4.0 * 20 * PIXEL, noise_pixels=0.02)


def test_one_force_in_the_frames_of_two_pulls_asks_for_the_record(tmp_path):
    write(tmp_path, "matchid_2024")
    with pytest.raises(DicError, match="one along y: put the machine's record with both into the folder, force_file"):
        import_specimen(specimen(tmp_path, load="biaxial", edge_ring=0, width=3, height=3))


def test_a_frame_rate_that_the_files_contradict_is_warned_of(tmp_path):
    for k, path in enumerate([write(tmp_path, "gom", frames=(k,)) for k in range(4)]):
        path.rename(path.with_name(f"pull_{0.7 * k:.3f} s.csv"))
    write_record(tmp_path, sizes=np.linspace(0.0, 0.06, 4))
    given = {"width": 3, "height": 3, "thickness": 1, "noise_mm": 0.01, "load": "clamped_x", "edge_ring": 0}
    seen = inspect(tmp_path, {**given, "frame_rate": 1.0})
    said = [remark.sentence for remark in seen.known.odd if remark.key == "frame_rate"]
    assert len(said) == 1 and "frame 4 for 3 s after frame 1, and the files say 2.1 s" in said[0]
    assert not any("the files say" in remark.sentence for remark in inspect(tmp_path, given).known.odd)


def without(*places):
    """Change of rows that takes these (row from the top, column) out of every frame."""
    gone = {row * COLUMNS + column for row, column in places}
    return lambda number, rows: [row for k, row in enumerate(rows) if k not in gone]


def test_points_that_no_frame_has_inside_may_be_a_hole(folder):
    hole = [(row, column) for row in (5, 6) for column in (5, 6, 7)]
    write_frames(folder, FIELDS["clamped_y"], change=without(*hole))
    (sentence,) = odd(folder)
    assert "6 neighbouring points inside" in sentence and "declare it" in sentence
    write_frames(folder, FIELDS["clamped_y"], change=without((5, 5), (3, 3), (0, 4), (0, 5), (0, 6), (0, 7)))
    assert odd(folder) == []


def test_a_table_in_pixels_asks_which_way_y_points(folder):
    for path in folder.glob("Pull*.csv"):
        path.write_text(path.read_text().replace("x [pixel];y [pixel];x-displacement [pixel];y-dis", "a;b;c;d", 1))
    columns = {"x": "a", "y": "b", "u": "c", "v": "dplacement", "delimiter": ";", "unit": "pixel"}
    given = {"format": "table", "table": columns}
    assert any("--set y_points=down" in sentence for sentence in odd(folder, **given))
    assert odd(folder, **given, y_points="down") == []


def test_a_record_with_columns_of_other_names_says_how_to_name_them(folder):
    path = folder / "force_disp.csv"
    path.write_text(path.read_text().replace("Force", "Load cell A"))
    said = refused(folder)
    assert "'Time', 'Load cell A' are no known names of a force" in said and "--set force_channel=NAME and" in said
    assert not refused(folder, force_channel="Load cell A")


def test_a_workbook_is_no_record_until_it_is_saved_as_a_table(folder):
    (folder / "force_disp.csv").rename(folder / "force_disp.xlsx")
    assert "save force_disp.xlsx, which is a workbook, as CSV" in refused(folder)


def test_a_point_that_the_software_mistook_counts_as_lost_and_several_together_are_named_by_their_place(folder):
    def mistaken(number, rows, points):
        for point in points if number == 3 else ():
            x, y, u, v = rows[point].split(";")
            rows = [*rows[:point], f"{x};{y};{float(u) + 60.0};{v}", *rows[point + 1 :]]
        return rows

    one = 5 * COLUMNS + 4
    write_frames(folder, FIELDS["clamped_y"], change=lambda n, rows: mistaken(n, rows, [one]))
    seen = inspect(folder, GIVEN)
    assert not seen.known.missing and seen.sheet.outliers == 1 and np.isnan(seen.sheet.u).sum() == 2
    assert any("points off what their neighbours say count as lost: 1 in 3 load steps" in note for note in seen.notes)
    three = [row * COLUMNS + column for row in (4, 5, 6) for column in (3, 4, 5)]
    write_frames(folder, FIELDS["clamped_y"], change=lambda n, rows: mistaken(n, rows, three))
    said = refused(folder)
    assert "frame 3 folds the sheet over" in said and "mm from the lower left point" in said


def test_a_frame_rate_that_is_too_large_leaves_most_of_the_pull_behind(folder):
    assert odd(folder) == []
    assert any("a frame_rate that is too large" in sentence for sentence in odd(folder, frame_rate=2.0))
