"""Exports unlike earlier ones: units after a sign, thousands, one table of all frames."""

import argparse
import re

import numpy as np
import pytest

from hypernode.commands.options import add_folder_options, given_settings
from hypernode.dic.errors import DicError
from hypernode.dic.table import number_in
from hypernode.inspection.folder import inspect
from hypernode.inspection.report import report
from tests.dic.pulls import LINES, STEP, fields, write, write_record
from tests.inspection.test_other_laboratories import COLUMNS, GIVEN, is_right, table
from tests.inspection.test_situations import TIME, force_at, said_of

FORCE = force_at(STEP * TIME)


def apart(sign):
    return [f"{1e3 * f:,.2f}".replace(",", sign) for f in FORCE]


INCHES = [TIME, COLUMNS[1] / 25.4, FORCE / 4.4482216152605]
#: Record: name of its file, header, columns, and what stands between them.
RECORDS = {
    "slash": ("log.csv", "Zeit / s;Weg / mm;Kraft / N", COLUMNS, ";"),
    "in": ("log.csv", "t in s;Weg in mm;F in N", COLUMNS, ";"),
    "Cyrillic units": ("log.csv", "Время, с;Перемещение, мм;Нагрузка, Н", COLUMNS, ";"),
    "inches": (
        "log.csv",
        "Time [sec.],Travel [in],Load [lbF]",
        [TIME, COLUMNS[1] / 25.4, FORCE / 4.4482216152605],
        ",",
    ),
    "thousands apart": (
        "log.csv",
        "Time (s);Force (mN)",
        [TIME, apart("'")],
        ";",
    ),
    "narrow blanks": (
        "log.csv",
        "Temps (s);Force (mN)",
        [TIME, apart("\u202f")],
        ";",
    ),
    "Zwick's ending": ("probe.TRA", "Prüfzeit;Standardweg;Standardkraft\ns;mm;N", COLUMNS, ";"),
    "units behind blanks": ("log.txt", "Time (s) Displacement (mm) Force (N)", COLUMNS, " "),
    "a line of units in brackets": ("log.txt", "Time Displacement Force\n(s) (mm) (N)", COLUMNS, " "),
}


def stacked(path, header, sign=","):
    y, x = (each.ravel() for each in np.meshgrid(LINES, LINES, indexing="ij"))
    frames = [[np.full(len(x), k), x, y, *u.reshape(-1, 2).T] for k, u in enumerate(fields())]
    table(path, header, list(np.concatenate(frames, axis=1)), sign)
    return path.parent


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_is_read_however_its_units_and_thousands_are_written(tmp_path, name):
    file, header, columns, sign = RECORDS[name]
    write(tmp_path, fields())
    table(tmp_path / file, header, columns, sign)
    is_right(inspect(tmp_path, GIVEN))


def test_a_record_of_unknown_names_is_named_with_the_line_of_its_header(tmp_path):
    write(tmp_path, fields())
    table(tmp_path / "wintest.csv", '"Test","7"\n"Elapsed","Load2 450N"\n"Sec","N"', [TIME, FORCE])
    said = said_of(inspect(tmp_path, GIVEN))
    assert "If wintest.csv is it" in said and "wintest.csv:2: 'Elapsed', 'Load2 450N'" in said
    is_right(inspect(tmp_path, {**GIVEN, "force_channel": "Load2 450N", "time_channel": "Elapsed"}))


def test_one_table_of_all_frames_needs_its_column_and_no_more(tmp_path):
    folder = stacked(tmp_path / "all.csv", "Nr;x;y;u;v", ";")
    write_record(folder)
    given = {**GIVEN, "format": "table", "table": {"delimiter": ";", "unit": "mm"}}
    said = said_of(inspect(folder, given))
    assert "each stands there 9 times" in said and "frame: 'NAME'" in said
    found = inspect(folder, {**given, "table": {**given["table"], "frame": "Nr"}})
    assert found.sheet is not None, said_of(found)
    np.testing.assert_allclose(found.sheet.cases[0].stretch, 1.0 + STEP * found.sheet.cases[0].numbers, atol=1e-3)
    wrong = inspect(folder, {**given, "table": {**given["table"], "frame": "Number"}})
    assert "no column 'Number'" in said_of(wrong)


def test_the_option_for_one_table_of_all_frames_names_its_column(tmp_path):
    write_record(stacked(tmp_path / "all.csv", "frame,x,y,u,v"))
    assert "frame: 'frame', unit: mm" in said_of(inspect(tmp_path, GIVEN))


@pytest.mark.parametrize(("sign", "decimal"), [(";", ","), ("\t", "."), ("\t", ","), (" ", ".")])
def test_the_option_for_a_table_without_names_reads_it(tmp_path, sign, decimal):
    y, x = (each.ravel() for each in np.meshgrid(LINES, LINES, indexing="ij"))
    for k, u in enumerate(fields()):
        path = tmp_path / f"frame{k:04d}.csv"
        table(path, "", [x, y, *u.reshape(-1, 2).T], sign, decimal)
        path.write_text(path.read_text().lstrip("\n"))
    write_record(tmp_path)
    shown = re.search(r'--set "(table={x: 1, y: 2, u: 3, v: 4, .*?})"', said_of(inspect(tmp_path, GIVEN)))[1]
    parser = argparse.ArgumentParser()
    add_folder_options(parser)
    told = given_settings(parser.parse_args([str(tmp_path), "--set", "format=table", "--set", shown]))
    assert told["table"]["delimiter"] == ("tab" if sign == "\t" else sign)
    found = inspect(tmp_path, {**GIVEN, **told})
    assert found.sheet is not None, said_of(found)


def test_a_matrix_without_positions_is_no_table_of_points(tmp_path):
    for k, u in enumerate(fields()):
        np.savetxt(tmp_path / f"u_{k:03d}.txt", np.tile(u[..., 0], 2), fmt="%.6f")
    said = said_of(inspect(tmp_path, GIVEN))
    assert "look like a matrix of one field" in said and "numpy.savez" in said and "x: 1" not in said


def test_inches_and_headers_between_blanks_are_read(tmp_path):
    y, x = (each.ravel() for each in np.meshgrid(LINES, LINES, indexing="ij"))
    for k, u in enumerate(fields()):
        columns = [each / 25.4 for each in (x, y, *u.reshape(-1, 2).T)]
        table(tmp_path / f"stage-{k}.txt", "# x [in] y [in] dx [in] dy [in]", columns, " ")
    write_record(tmp_path)
    found = inspect(tmp_path, GIVEN)
    assert found.sheet is not None, said_of(found)
    np.testing.assert_allclose(found.sheet.cases[0].stretch, 1.0 + STEP * found.sheet.cases[0].numbers, atol=1e-3)


@pytest.mark.parametrize(
    ("names", "units"), [("x y u v", "[mm] [mm] [mm] [mm]"), ("Nr x y u v", "- (mm) (mm) (mm) (mm)")]
)
def test_a_line_of_units_in_brackets_has_one_for_each_column_between_blanks(tmp_path, names, units):
    y, x = (each.ravel() for each in np.meshgrid(LINES, LINES, indexing="ij"))
    for k, u in enumerate(fields()):
        columns = [np.arange(len(x)), x, y, *u.reshape(-1, 2).T]
        table(tmp_path / f"stage-{k}.txt", f"{names}\n{units}", columns[-len(names.split()) :], " ")
    write_record(tmp_path)
    found = inspect(tmp_path, GIVEN)
    assert found.sheet is not None, said_of(found)
    np.testing.assert_allclose(found.sheet.cases[0].stretch, 1.0 + STEP * found.sheet.cases[0].numbers, atol=1e-3)


def test_endings_in_other_letters_are_of_one_series(tmp_path):
    write(tmp_path, fields(), [f"frame{k:04d}.{'csv' if k % 2 else 'CSV'}" for k in range(9)])
    write_record(tmp_path)
    assert len(inspect(tmp_path, GIVEN).field.numbers) == 9


@pytest.mark.parametrize("decimal", [None, "."])
def test_commas_of_other_columns_say_nothing_of_the_decimal_sign(tmp_path, decimal):
    y, x = (each.ravel() for each in np.meshgrid(LINES, LINES, indexing="ij"))
    for k, u in enumerate(fields()):
        columns = [len(x) * ["10:11:12,345"], x, y, *u.reshape(-1, 2).T, [f"{j},{k}" for j in range(len(x))]]
        table(tmp_path / f"frame{k:04d}.csv", "Clock;X1;Y1;U1;V1;Id", columns, ";")
    write_record(tmp_path)
    columns = {"x": "X1", "y": "Y1", "u": "U1", "v": "V1", "delimiter": ";", "decimal": decimal, "unit": "mm"}
    found = inspect(tmp_path, {**GIVEN, "format": "table", "table": columns})
    assert found.sheet is not None, said_of(found)


def test_a_sign_that_is_not_that_of_the_other_numbers_is_refused_with_the_key():
    with pytest.raises(DicError, match=r"table: \{decimal"):
        number_in("0,5", ".", blanks=True, where="frame.csv:3", line="1.0;0,5;0;0")


def test_structures_of_matlab_are_searched(tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    u = np.moveaxis(np.array(fields()), 0, -1)
    data = {"x": x, "y": y, "u": u[:, :, 0], "v": u[:, :, 1]}
    scipy_io.savemat(tmp_path / "t.mat", {"data": data, "force": force_at(STEP * np.arange(9.0))})
    is_right(inspect(tmp_path, {**GIVEN, "arrays": {"unit": "mm"}}))
    other = {name: 0.5 * each for name, each in data.items()}
    scipy_io.savemat(tmp_path / "t.mat", {"left": data, "right": other, "force": force_at(STEP * np.arange(9.0))})
    said = said_of(inspect(tmp_path, {**GIVEN, "arrays": {"unit": "mm"}}))
    assert "'left/u left/v'" in said and "'right/u right/v'" in said and "say which are what" in said
    of_left = {"positions": "left/x left/y", "displacements": "left/u left/v", "unit": "mm"}
    is_right(inspect(tmp_path, {**GIVEN, "arrays": of_left}))


def test_a_zero_that_was_set_anew_is_named_with_what_is_refused(tmp_path):
    force = FORCE - np.where(TIME >= 4.0, 1.4 * force_at(STEP * 4.0), 0.0)
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", "Time (s),Force (N)", [TIME, force])
    said = said_of(inspect(tmp_path, GIVEN))
    assert "a stretched sheet pulls" in said and "at 4 s" in said and "a zero that was set anew" in said


def test_a_row_that_is_no_point_is_refused_with_the_way_out(tmp_path):
    write(tmp_path, fields())
    write_record(tmp_path)
    path = tmp_path / "frame0000.csv"
    first, *rows = path.read_text().splitlines()
    path.write_text("\n".join([first, "Mean,,1.0,2.0", *rows[1:], rows[0], ""]))
    assert "delete the line if it is no point" in said_of(inspect(tmp_path, GIVEN))
    with pytest.raises(DicError, match="thousands"):
        number_in("1,000.0", ".", blanks=True, where="frame.csv:3", line="1,000.0;1;0;0")


def test_a_frame_that_is_misnamed_far_away_is_listed_in_no_time(tmp_path):
    write(tmp_path, fields(), [*(f"frame{k}.csv" for k in range(8)), "frame999999999999.csv"])
    write_record(tmp_path)
    found = inspect(tmp_path, GIVEN)
    assert found.field.absent[:2] == [8, 9] and len(found.field.absent) == 1000
    assert "14, 15 and 999999999983 more" in " ".join(report(found))
