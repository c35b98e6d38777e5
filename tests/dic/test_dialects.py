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
    COLUMNS,
    DICE_PREAMBLE,
    FRAMES,
    LOST,
    ROWS,
    displacement,
    points,
    specimen,
    write,
    zero,
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


def test_increments_are_refused(tmp_path):
    write(tmp_path, "dice")
    for path in tmp_path.iterdir():
        path.write_text(path.read_text().replace("correlation: false", "correlation: true"))
    with pytest.raises(DicError, match=r"\.txt:2: displacements from frame to frame"):
        read_series(tmp_path)


def subsets(folder, columns=COLUMNS, frames=(0, 1, 2)):
    """One file for each point, with a row for each frame."""
    header = "FRAME COORDINATE_X COORDINATE_Y DISPLACEMENT_X DISPLACEMENT_Y SIGMA"
    tables = [list(points(k, 10, y_up=False)) for k in frames]
    for index in range(columns * ROWS):
        rows = [f"{k} {' '.join(map(repr, t[index][:4]))} {-1 if t[index][4] else 0.1}" for k, t in enumerate(tables)]
        (folder / f"DICe_solution_{index}.txt").write_text("\n".join([DICE_PREAMBLE + header, *rows]))


def matrices(folder):
    """One file for each field of each frame, with a decimal comma and Italian words for what is no number."""
    for k in range(3):
        cells = np.array([p[:4] for p in points(k, 0.5, y_up=False, deformed=True)]).reshape(ROWS, COLUMNS, 4)
        for j, field in enumerate("XYUV"):
            text = [[f"{value:.15g}".replace(".", ",") for value in row] for row in cells[..., j]]
            if k and field in "UV":
                text[LOST // COLUMNS][LOST % COLUMNS] = "Non un numero reale"
            (folder / f"Image_{k:04d}_0.tif_{field}[mm].csv").write_text("\n".join(map(";".join, text)))


def ncorr(folder):
    """A structure array as MATLAB 7.3 saves it."""
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: Ncorr files cannot be written")
    fields = [np.array([zero(*p)[2:] for p in points(k, 0.5, y_up=False)]).reshape(ROWS, COLUMNS, 2) for k in (1, 2)]
    path = folder / "result.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        saved = file.create_group("data_dic_save")
        for key, value in {"spacing": [[4.0]], "pixtounits": [[0.1]], "units": [[ord(c)] for c in "mm"]}.items():
            saved[f"dispinfo/{key}"] = np.array(value)
        for j, name in enumerate("uv"):
            references = []
            for k, each in enumerate(fields):
                file[f"#refs#/{name}{k}"] = each[..., j].T
                references.append([file[f"#refs#/{name}{k}"].ref])
            saved.create_dataset(f"displacements/plot_{name}_ref_formatted", data=references, dtype=h5py.ref_dtype)
    with open(path, "r+b") as handle:
        handle.write(b"MATLAB 7.3 MAT-file, Platform: any")


@pytest.mark.parametrize(
    ("writer", "name", "step"),
    [(subsets, "dice_subsets", 10), (matrices, "matchid_matrices", 0.5), (ncorr, "ncorr", 0.5)],
)
def test_series_that_are_no_table_a_frame_give_the_same_series(tmp_path, writer, name, step):
    writer(tmp_path)
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
    path.write_text("\n".join(path.read_text().splitlines()[:-1]))
    with pytest.raises(DicError, match=r"solution_4\.txt: frame 2 is not there"):
        read_series(tmp_path)
    path.write_text("\n".join([*path.read_text().splitlines(), "2 1 2"]))
    with pytest.raises(DicError, match=r"solution_4\.txt:8: 3 fields"):
        read_series(tmp_path)


def test_broken_matrices_are_named(tmp_path):
    matrices(tmp_path)
    path = tmp_path / "Image_0001_0.tif_V[mm].csv"
    path.write_text(path.read_text() + ";1")
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
    with pytest.raises(DicError, match=r"no frames: .*mine_0\.txt begins 'a note'.* format: table"):
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
    written = Series(np.arange(5) / 3, np.arange(7) / 7, [Frame(k, u[k]) for k in range(2)], "mm")
    write_series(written, tmp_path)
    series = read_series(tmp_path, dialect=dialect_of(specimen(tmp_path, format="table")))
    assert series.unit == "mm" and (series.x == written.x).all() and (series.y == written.y).all()
    np.testing.assert_array_equal(np.stack([f.displacement for f in series.frames]), u)
