"""Whatever software wrote it, a sheet on the same points is the same series: y upward, reference positions."""

import typing

import numpy as np
import pytest

from hypernode.config.loading import ConfigError, check_config
from hypernode.config.specimens import Format, Specimen
from hypernode.dic.dialects import BY_NAME, DIALECTS
from hypernode.dic.errors import DicError
from hypernode.dic.folder import dialect_of, find_series, numbered
from hypernode.dic.reading import read_series, read_specimen
from hypernode.dic.series import Frame, Series
from hypernode.dic.writing import write_series

COLUMNS, ROWS = 6, 5
#: The point that is lost in every deformed frame, by its place in a file whose rows run downward.
LOST = 8
VIC_NAMES = ' "X",  "Y",  "Z",  "U",  "V",  "W",  "exx",  "sigma",  "x",  "y",  "u",  "v"'
DICE_PREAMBLE = "***\n*** Incremental correlation: false\n*** y positive down\n***\n"
GOM = "# Units: length:mm angle:deg time:s\n# stage;index;relative_time;date\n# 1;0;0.0;today\n"
NODEMAP = "# A test\n# force                : analog_input        : 12.5\n#####\n"
MATCHID = (
    "Coordinates.Image X [Pixel],Coordinates.Image Y [Pixel],coor.X [mm],coor.Y [mm],coor.Z [mm],"
    "disp.Horizontal Displacement U [mm],disp.Vertical Displacement V [mm],disp.Out-Of-Plane: W [mm],"
    "ext.Time [s],ext.Force [N]"
)
MATCHID_2D = (
    "Coordinates.Image X [Pixel],Coordinates.Image Y [Pixel],disp.Horizontal Displacement U [Pixel],"
    "disp.Vertical Displacement V [Pixel]"
)
DAVIS = "x [pixel];y [pixel];x-displacement [pixel];y-displacement [pixel]"
DAVIS_8 = '#DaVis 8.1.2 2D-vector 8 6 5 "" "mm" "" "mm" "displacement" "mm"'
STEREO = "x [mm];y [mm];z [mm];X-displacement [mm];Y-displacement [mm];Z-displacement [mm];Angle [°]"


def displacement(k, X, Y):
    """Of frame k, which moves the sheet up and to the right."""
    return k * (0.03 * X + 0.05), k * (0.02 * Y + 0.04)


def points(k, step, y_up, v_up=None, deformed=False):
    """x, y, u, v, whether lost, of every point of frame k as a file has them."""
    for index in range(COLUMNS * ROWS):
        X, Y = step * (index % COLUMNS), step * (ROWS - 1 - index // COLUMNS)
        u, v = displacement(k, X, Y)
        v = v if (y_up if v_up is None else v_up) else -v
        y = Y if y_up else step * (ROWS - 1) - Y
        moved = (u, v) if deformed else (0.0, 0.0)
        yield X + moved[0], y + moved[1], u, v, k > 0 and index == LOST


def zero(x, y, u, v, lost):
    return [x, y, *((0, 0) if lost else (u, v))]


def stereo(x, y, u, v, lost):
    return None if lost else [x, y, 0.5, u, v, 0.001, 1]


def matchid(x, y, u, v, lost):
    return [1000 * x, 1000 * y, x, y, 0.5, *(("", "") if lost else (u, v)), 0.001, 2.5, 0.3]


def vic(x, y, u, v, lost):
    return [-9.1, -7.4, 410.0, 0, 0, 0, 0, -1, 2, 3, 0, 0] if lost else [x, y, 0.5, u, v, 0, 0, 0.01, 2, 3, 0, 0]


def vic_2d(x, y, u, v, lost):
    return [-9.1, -7.4, 0, 0, -1] if lost else [x, y, u, v, 0.01]


def blank(x, y, u, v, lost):
    return [x, y, *(("nan", "nan") if lost else (u, v))]


#: Dialect -> (step, header, cells of a point, delimiter, decimal sign, name of a file, number of the first frame).
FRAMES = {
    "davis": (10, DAVIS, zero, ";", ".", "Test{:04d}.csv", 1),
    "davis_mm": (0.5, DAVIS.replace("pixel", "mm"), zero, ";", ".", "Test{:04d}.csv", 1),
    "davis_stereo": (0.5, STEREO, stereo, ";", ".", "B{:04d}.csv", 1),
    "davis8": (0.5, DAVIS_8, zero, "\t", ",", "B{:05d}.txt", 1),
    "matchid_2024": (0.5, MATCHID, matchid, ",", ".", "Image_{:04d}_0.tiff.csv", 0),
    "matchid_2023": (0.5, "x_pic,y_pic,x,y,z,u,v,w,exx,eyy", matchid, ",", ".", "B{:04d}_0.tif.csv", 1),
    "matchid_2d": (10, MATCHID_2D, blank, ",", ".", "Image_{:04d}_0.tiff.csv", 0),
    "vic3d": (0.5, VIC_NAMES, vic, ",", ".", "17_A-4B_sys1-{:04d}_0.csv", 0),
    "vic3d, German": (0.5, VIC_NAMES.replace(",", ";"), vic, ";", ",", "pull-{:04d}_0.csv", 0),
    "vic2d_mm": (0.5, '"x_c","y_c","u_c","v_c","sigma"', vic_2d, ",", ".", "pull-{:04d}_0.csv", 0),
    "vic2d": (10, '"x","y","u","v","sigma"', vic_2d, ",", ".", "pull-{:04d}_0.csv", 0),
    "dice": (
        10, DICE_PREAMBLE + "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,MATCH",
        lambda x, y, u, v, lost: [7, x, y, u, v, -1 if lost else 0], ",", ".", "DICe_solution_{:02d}.txt", 0,
    ),
    "gom": (
        0.5, GOM + "id;x;y;z;displacement_x;displacement_y;displacement_z;epsilon_x",
        lambda x, y, u, v, lost: None if lost else [1, x, y, 0.5, u, v, 0, 0], ";", ".", "pull_{:d}.555 s.csv", 20,
    ),
    "gom_nodemap": (
        0.5, NODEMAP + "#   ID;  x_undef [mm];  y_undef [mm];  z_undef [mm];  u [mm];  v [mm];  w [mm];  epsx [%]",
        lambda x, y, u, v, lost: None if lost else [1, x, y, 0.5, u, v, 0, 0], ";", ".", "nodemap_{:d}.txt", 1,
    ),
    "pyvale": (
        10, '"subset_x","subset_y","disp_u","disp_v","disp_mag","converged","num_iter",',
        lambda x, y, u, v, lost: [x, y, *(("nan", "nan") if lost else (u, v)), 0, str(not lost), 3, ""],
        ",", ".", "dic_results_im{:04d}.csv", 0,
    ),
    "al_dic": (
        10, "\ufeffnode_id,x_px,y_px,disp_u,disp_v,disp_magnitude",
        lambda x, y, u, v, lost: [0, x, y, *(("nan", "nan") if lost else (u, v)), 0], ",", ".", "frame_{:04d}.csv", 0,
    ),
    "table": (0.5, "x [mm],y [mm],u [mm],v [mm]", blank, ",", ".", "f{:02d}.csv", 1),
}  # fmt: skip


def write(folder, case, change=lambda lines: lines, frames=(0, 1, 2)):
    """Frames of a dialect; ``change`` is made to the lines of the last."""
    step, header, cells, delimiter, decimal, name, first = FRAMES[case]
    dialect = BY_NAME[case.split(",")[0]]
    for k in frames:
        rows = [cells(*p) for p in points(k, step, dialect.y_up, dialect.v_up, dialect.deformed)]
        lines = [delimiter.join(f"{c}" if isinstance(c, str) else f"{c:.15g}" for c in row) for row in rows if row]
        lines = [line.replace(".", decimal) for line in lines]
        lines = [*header.split("\n"), *(lines if k < frames[-1] else change(lines))]
        path = folder / name.format(first + k)
        path.write_bytes("\r\n".join([*lines, ""]).encode("cp1252" if "°" in header else "utf-8"))
    return path


def specimen(folder, **changes):
    sizes = {"width": 1, "height": 1, "thickness": 1, "frame_rate": 1, "noise_mm": 0.01}
    return Specimen.model_validate({"folder": str(folder), **sizes, **changes})


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
    series = read_specimen(declared)
    X, Y = np.meshgrid(series.x, series.y)
    np.testing.assert_allclose(series.frames[1].displacement, np.stack(displacement(1, X, Y), axis=-1), atol=1e-8)
    with pytest.raises(DicError, match="no unit is named"):
        read_specimen(specimen(tmp_path, format="table", table=columns))


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


def scattered(folder, place, w=lambda k, x, y: None):
    """Two frames of a declared or a stereo table at any points."""
    X, Y = (a.ravel() for a in np.meshgrid(0.5 * np.arange(12), 0.5 * np.arange(10)))
    x, y = place(X, Y)
    for k in range(2):
        u, v = displacement(k, x, y)
        out = w(k, x, y)
        columns = [x, y, u, v] if out is None else [x, y, np.zeros_like(x), u, v, out, x]
        header = "x [mm],y [mm],u [mm],v [mm]" if out is None else STEREO
        delimiter = "," if out is None else ";"
        rows = [delimiter.join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
        (folder / f"f{k:04d}.csv").write_text("\n".join([header, *rows]))


def test_points_near_a_grid_are_interpolated_onto_one_and_the_log_says_how_far(tmp_path, capsys):
    random = np.random.default_rng(1)
    scattered(
        tmp_path, lambda X, Y: (X + 0.05 * random.uniform(-1, 1, X.shape), Y + 0.05 * random.uniform(-1, 1, X.shape))
    )
    series = read_series(tmp_path)
    u = series.frames[1].displacement
    assert (len(series.x), len(series.y)) == (12, 10) and np.isfinite(u[1:-1, 1:-1]).all()
    # The displacement is linear: its interpolation is exact, up to a constant from the shift of the origin.
    np.testing.assert_allclose(np.diff(u[1:-1, 1:-1, 0], axis=1), 0.03 * (series.x[1] - series.x[0]), rtol=1e-6)
    assert "of a step away" in capsys.readouterr().err


def test_a_grid_turned_against_the_axes_is_not_extrapolated(tmp_path):
    c, s = np.cos(0.2), np.sin(0.2)
    scattered(tmp_path, lambda X, Y: (c * X - s * Y, s * X + c * Y))
    u = read_series(tmp_path).frames[1].displacement
    assert np.isnan(u[0, 0]).all() and np.isnan(u[-1, -1]).all() and np.isfinite(u[5, 5]).all()


def test_a_hole_among_scattered_points_is_lost(tmp_path):
    def place(X, Y):
        far = np.hypot(X - 2.75, Y - 2.25) > 1.2
        return X[far] + 0.03 * Y[far], Y[far]

    scattered(tmp_path, place)
    series = read_series(tmp_path)
    column = np.argmin(np.abs(series.x - 2.8))
    assert np.isnan(series.frames[1].displacement[4:6, column]).all()
    assert np.isfinite(series.frames[1].displacement[1, 4:8]).all()


def test_points_twice_in_a_scattered_frame_are_refused(tmp_path):
    scattered(tmp_path, lambda X, Y: (X + 0.03 * Y, Y))
    path = tmp_path / "f0001.csv"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines, lines[4]]))
    with pytest.raises(DicError, match=r"f0001\.csv:122: the point .* there twice"):
        read_series(tmp_path)


def test_a_sheet_that_leaves_its_plane_is_refused_unless_allowed(tmp_path):
    scattered(tmp_path, lambda X, Y: (X, Y), lambda k, x, y: k * 0.1 * x)
    with pytest.raises(DicError, match="allow_out_of_plane"):
        read_series(tmp_path)
    assert 0.09 < read_series(tmp_path, allow_out_of_plane=True).out_of_plane <= 0.1


def test_a_tilted_sheet_is_seen_in_its_own_plane(tmp_path):
    X, Y = (a.ravel() for a in np.meshgrid(0.5 * np.arange(12), 0.5 * np.arange(10)))
    c, s = np.cos(0.3), np.sin(0.3)
    for k in range(2):
        # Stretched by 2 % along a direction that leans out of the x-y plane.
        columns = [c * X, Y, s * X, 0.02 * k * c * X, 0 * X + 1e-9 * k, 0.02 * k * s * X, X]
        rows = [";".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
        (tmp_path / f"B{k:04d}.csv").write_text("\n".join([STEREO, *rows]))
    series = read_series(tmp_path)
    np.testing.assert_allclose(np.diff(series.x), 0.5, rtol=1e-6)
    np.testing.assert_allclose(np.diff(series.frames[1].displacement[3, :, 0]), 0.01, rtol=1e-4)
    assert series.out_of_plane < 1e-6


def test_pixels_need_their_size_and_millimetres_none(tmp_path, capsys):
    write(tmp_path, "davis")
    with pytest.raises(DicError, match="give pixel_size"):
        read_specimen(specimen(tmp_path)).millimetres(None)
    assert read_specimen(specimen(tmp_path)).millimetres(0.25) == 0.25
    for path in tmp_path.iterdir():
        path.unlink()
    write(tmp_path, "davis_mm")
    assert read_specimen(specimen(tmp_path, pixel_size=0.25)).millimetres(0.25) == 1.0
    assert "pixel_size is ignored" in capsys.readouterr().err
    with pytest.raises(ConfigError, match="give pixel_size, or noise_mm"):
        check_config({
            "specimens": {"s": {"folder": "f", "width": 1, "height": 1, "thickness": 1, "frame_rate": 1}},
            "cases": {"c": {"specimen": "s"}},
        })  # fmt: skip


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (["test10001.csv", "test10002.csv", "test10012.csv"], [1, 2, 12]),
        (["Name0099.csv", "Name0100.csv"], [99, 100]),
        (["Image_0000_0.tiff.csv", "Image_0007_0.tiff.csv"], [0, 7]),
        (["pull2024_9.csv", "pull2024_10.csv"], [9, 10]),
        (["DICe_solution_01.txt", "DICe_solution_11.txt"], [1, 11]),
        (["17_A-4B_pull-sys1-0003_0.csv"], [3]),
    ],
)
def test_frames_are_numbered_by_the_digits_that_vary(tmp_path, names, numbers):
    assert sorted(numbered(tmp_path, [tmp_path / name for name in names])) == numbers


@pytest.mark.parametrize("names", [["a1_0001.csv", "a2_0001.csv"], ["t10001.csv", "t20001.csv", "t10002.csv"]])
def test_two_series_of_like_names_are_refused(tmp_path, names):
    with pytest.raises(DicError, match="several series"):
        numbered(tmp_path, [tmp_path / name for name in names])


def test_two_series_in_a_folder_and_a_frame_twice_are_refused(tmp_path):
    write(tmp_path, "davis")
    write(tmp_path, "vic3d")
    with pytest.raises(DicError, match="several series"):
        read_series(tmp_path)
    assert read_series(tmp_path, dialect=BY_NAME["vic3d"]).unit == "mm"
    (tmp_path / "Test01.csv").write_bytes((tmp_path / "Test0001.csv").read_bytes())
    with pytest.raises(DicError, match="frame 1 is there twice"):
        read_series(tmp_path, dialect=BY_NAME["davis"])


def test_times_in_names_give_the_order_and_stay_with_the_frames(tmp_path):
    write(tmp_path, "gom")
    assert [(f.number, f.time) for f in read_series(tmp_path).frames] == [(1, 20.555), (2, 21.555), (3, 22.555)]


def test_time_and_force_of_the_file_stay_with_the_frames(tmp_path):
    write(tmp_path, "matchid_2024")
    assert [(f.time, f.force) for f in read_series(tmp_path).frames] == [(2.5, 0.3)] * 3
