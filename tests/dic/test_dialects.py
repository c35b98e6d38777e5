"""Whatever software wrote it, a sheet on the same points is the same series: y upward, reference positions."""

import typing

import numpy as np
import pytest

from hypernode.config.specimen_tests import Format
from hypernode.dic.dialects import BY_NAME, DIALECTS
from hypernode.dic.errors import DicError
from hypernode.dic.folder import dialect_of, find_series
from hypernode.dic.reading import read_series, read_test
from hypernode.dic.series import Frame, Series
from hypernode.dic.writing import write_series
from tests.dic.exports import (
    ASSEMBLED,
    COLUMNS,
    FRAMES,
    LOST,
    ROWS,
    displacement,
    export,
    matrices,
    ncorr,
    points,
    specimen,
    subsets,
    write,
)


@pytest.mark.parametrize("case", FRAMES)
def test_every_dialect_is_recognised_and_gives_the_same_series(tmp_path, case, capsys):
    write(tmp_path, case)
    series = read_series(tmp_path)
    dialect = BY_NAME[case.split(",")[0]]
    assert find_series(tmp_path).dialect is dialect and f"format: {dialect.name}" in capsys.readouterr().err
    step = FRAMES[case][0]
    assert series.unit == ("pixel" if step == 10 else "mm")
    np.testing.assert_allclose(series.x, step * np.arange(COLUMNS), atol=1e-9)
    np.testing.assert_allclose(series.y, step * np.arange(ROWS), atol=1e-9)
    assert len(series.frames) == 3 and series.frames[0].number + 2 == series.frames[2].number
    X, Y = np.meshgrid(series.x, series.y)
    for k, frame in enumerate(series.frames):
        expected = np.stack(displacement(k, X, Y), axis=-1)
        if k:
            expected[ROWS - 1 - LOST // COLUMNS, LOST % COLUMNS] = np.nan
        np.testing.assert_allclose(frame.displacement, expected, atol=1e-9)


def test_every_dialect_has_a_name_in_the_configuration():
    assert {"auto", *BY_NAME} == set(typing.get_args(Format)) and len(BY_NAME) == len(DIALECTS)


def ragged(lines):
    return [*lines[:3], lines[3][: len(lines[3]) // 3], *lines[4:]]


def garbled(lines):
    return [*lines[:2], lines[2].replace("0", "#"), *lines[3:]]


def repeated(lines):
    return [*lines, lines[0]]


@pytest.mark.parametrize("case", FRAMES)
@pytest.mark.parametrize(
    ("change", "message"),
    [(ragged, r":\d+: \d+ fields"), (garbled, r":\d+: not a number"), (repeated, "there twice|promises 30")],
)
def test_a_broken_frame_of_any_dialect_is_named_with_its_line(tmp_path, case, change, message):
    path = write(tmp_path, case, change)
    with pytest.raises(DicError, match=message) as refused:
        read_series(tmp_path)
    assert str(path) in str(refused.value)


@pytest.mark.parametrize("case", FRAMES)
def test_a_frame_of_another_header_and_a_deformed_reference_are_refused(tmp_path, case):
    path = write(tmp_path, case)
    text = path.read_bytes()
    path.write_bytes(b"a,b,c,d,e\r\n1,2,3,4,5\r\n")
    with pytest.raises(DicError, match=r":1: (no column|the header|not a file)"):
        read_series(tmp_path)
    path.write_bytes(text)
    if BY_NAME[case.split(",")[0]].reference:
        first = min(tmp_path.iterdir())
        first.unlink()
        with pytest.raises(DicError, match="the first frame is moved by"):
            read_series(tmp_path)


@pytest.mark.parametrize("case", ["dice", "pyvale", "al_dic"])
def test_a_reference_that_is_not_exported_is_the_frame_before_the_first(tmp_path, case, capsys):
    write(tmp_path, case, frames=(1, 2))
    series = read_series(tmp_path)
    assert [frame.number for frame in series.frames] == [0, 1, 2]
    assert not series.frames[0].displacement.any() and "counts as frame 0" in capsys.readouterr().err


def test_rounding_in_the_reference_makes_it_no_deformed_frame(tmp_path):
    """A picture compared with itself: what is left is no motion, and no frame was taken before it."""
    write(tmp_path, "dice")
    first = min(tmp_path.iterdir())
    lines = first.read_text().splitlines()
    moved = [",".join([*row.split(",")[:3], "1e-06", "-2e-06", "0"]) for row in lines[5:]]
    first.write_text("\n".join([*lines[:5], *moved, ""]))
    assert [frame.number for frame in read_series(tmp_path).frames] == [0, 1, 2]


def test_increments_are_refused(tmp_path):
    write(tmp_path, "dice")
    for path in tmp_path.iterdir():
        path.write_text(path.read_text().replace("correlation: false", "correlation: true"))
    with pytest.raises(DicError, match=r"\.txt:2: displacements from frame to frame"):
        read_series(tmp_path)


@pytest.mark.parametrize("name", ASSEMBLED)
def test_series_that_are_no_table_a_frame_give_the_same_series(tmp_path, name):
    step = export(tmp_path, name)
    assert find_series(tmp_path).dialect.name == name
    series = read_series(tmp_path)
    assert series.unit == ("pixel" if step == 10 else "mm")
    assert [frame.number for frame in series.frames] == [0, 1, 2]
    X, Y = np.meshgrid(step * np.arange(COLUMNS), step * np.arange(ROWS))
    for k, frame in enumerate(series.frames):
        expected = np.stack(displacement(k, X, Y), axis=-1)
        if k:
            expected[ROWS - 1 - LOST // COLUMNS, LOST % COLUMNS] = np.nan
        np.testing.assert_allclose(frame.displacement, expected, atol=1e-9)


def test_broken_subsets_matrices_and_matlab_files_are_named(tmp_path):
    subsets(tmp_path)
    path = tmp_path / "DICe_solution_4.txt"
    path.write_text("\n".join([*path.read_text().splitlines()[:-1], ""]))
    with pytest.raises(DicError, match=r"solution_4\.txt: frame 2 is not there"):
        read_series(tmp_path)
    path.write_text("\n".join([*path.read_text().splitlines(), "2 1 2", ""]))
    with pytest.raises(DicError, match=r"solution_4\.txt:8: 3 fields"):
        read_series(tmp_path)


def test_broken_matrices_are_named(tmp_path):
    matrices(tmp_path)
    path = tmp_path / "Image_0001_0.tif_V[mm].csv"
    path.write_text(path.read_text().rstrip() + ";1\n")
    with pytest.raises(DicError, match=r"V\[mm\]\.csv:5: 7 fields"):
        read_series(tmp_path)
    path.unlink()
    with pytest.raises(DicError, match="no matrix of V"):
        read_series(tmp_path)


def test_matlab_files_that_ncorr_did_not_save_are_named(tmp_path):
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: Ncorr files cannot be written")
    path = tmp_path / "result.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file" + bytes(100))
    with pytest.raises(DicError, match=r"result\.mat: not what Ncorr saves"):
        read_series(tmp_path)
    ncorr(tmp_path)
    with h5py.File(path, "r+") as file:
        del file["data_dic_save/dispinfo/units"]
        file["data_dic_save/dispinfo/units"] = np.array([[ord("k")], [ord("m")]])
    with pytest.raises(DicError, match=r"result\.mat: lengths in 'km'"):
        read_series(tmp_path)


def test_a_declared_table_is_read_as_it_is_declared(tmp_path):
    for k in range(2):
        rows = [f"{p[0]:g}\t{p[1]:g}\t{p[2]:.9g}\t{p[3]:.9g}".replace(".", ",") for p in points(k, 0.5, y_up=False)]
        (tmp_path / f"mine_{k}.txt").write_text("\n".join(["a note", "px\tpy\tdx\tdy", *rows]))
    with pytest.raises(DicError, match=r"no frames: .*mine_0\.txt begins 'a note'.* set format to table"):
        read_series(tmp_path)
    columns = {"x": "px", "y": "py", "u": "dx", "v": "dy", "delimiter": "\t", "decimal": ","}
    declared = specimen(tmp_path, format="table", table={**columns, "unit": "mm"}, y_points="down")
    series = read_test(declared)
    X, Y = np.meshgrid(series.x, series.y)
    np.testing.assert_allclose(series.frames[1].displacement, np.stack(displacement(1, X, Y), axis=-1), atol=1e-8)
    with pytest.raises(DicError, match="no unit is named"):
        read_test(specimen(tmp_path, format="table", table=columns))


def test_a_series_written_and_read_again_keeps_its_bits(tmp_path):
    random = np.random.default_rng(3)
    u = random.normal(size=(2, 7, 5, 2)) * 1e-3
    u[0] = 0.0
    u[1, 2, 3] = np.nan
    written = Series(np.arange(5) / 3, np.arange(7) / 7, [Frame(k, u[k]) for k in range(2)], unit="mm")
    write_series(written, tmp_path)
    series = read_series(tmp_path, dialect=dialect_of(specimen(tmp_path, format="table")))
    assert series.unit == "mm" and (series.x == written.x).all() and (series.y == written.y).all()
    np.testing.assert_array_equal(np.stack([f.displacement for f in series.frames]), u)
