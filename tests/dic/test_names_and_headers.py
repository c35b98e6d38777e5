"""Names that are clocks or hold several numbers, steps in folders, and headers in people's words."""

import numpy as np
import pytest

from hypernode.config.specimens import Specimen
from hypernode.dic.clock_names import times_of
from hypernode.dic.column_names import named_table
from hypernode.dic.declared import Declared
from hypernode.dic.dialects import declared
from hypernode.dic.errors import DicError
from hypernode.dic.folder import find_series
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.reading import read_series, read_test

from .pulls import LINES, fields, write, write_record


@pytest.mark.parametrize(
    ("names", "times"),
    [
        (["cam_20230504_101158.csv", "cam_20230504_101159.csv", "cam_20230504_101200.csv"], [0, 1, 2]),
        (["101158.csv", "101159.csv", "101200.csv", "101201.csv"], [0, 1, 2, 3]),
        (["a_10-11-58.500.csv", "a_10-11-59.000.csv", "a_10-12-00.250.csv"], [0, 0.5, 1.75]),
        (["2023-05-04 23-59-59.csv", "2023-05-05 00-00-01.csv"], [0, 2]),
        (["x20230504101158.csv", "x20230504101200.csv"], [0, 2]),
    ],
)
def test_names_that_are_clocks_are_seconds(tmp_path, names, times):
    found = times_of(names)
    np.testing.assert_allclose(np.sort(found) - min(found), times)
    write(tmp_path, fields()[: len(names)], names=names)
    series = find_series(tmp_path)
    assert list(series.times.values()) == pytest.approx(times)
    assert [path.name for path in series.files.values()] == names


@pytest.mark.parametrize(
    "names", [["f000001.csv", "f000002.csv"], ["f100000.csv", "f100001.csv"], ["a1.csv", "a2.csv"]]
)
def test_counters_are_no_clocks(names):
    assert times_of(names) is None


def test_a_number_beside_which_a_load_grows_is_that_of_the_frame(tmp_path):
    write(tmp_path, fields()[:3], names=["pull_0001_load0N.csv", "pull_0002_load12N.csv", "pull_0003_load25N.csv"])
    assert list(find_series(tmp_path).files) == [1, 2, 3]


def test_two_cameras_are_two_series(tmp_path):
    names = [f"cam{camera}_{k:04d}.csv" for camera in (0, 1) for k in (1, 2)]
    write(tmp_path, fields()[:4], names=names)
    with pytest.raises(DicError, match="several series"):
        find_series(tmp_path)


def test_folders_that_are_steps_of_one_test_are_said(tmp_path):
    frames = fields()
    for k in (1, 2, 3):
        write(tmp_path / str(10 * k), [frames[k]], names=["nodes.csv"])
    with pytest.raises(DicError, match=r"steps of one test.*10/nodes.csv as Step0010.csv.*implied_reference=true"):
        read_series(tmp_path)
    flat = write(tmp_path / "flat", frames[1:4], names=["Step0010.csv", "Step0020.csv", "Step0030.csv"])
    with pytest.raises(DicError, match="implied_reference: true"):
        read_series(flat)
    series = read_series(flat, declared=Declared(implied_reference=True))
    # As long before the first step as the others are apart: a step earlier, and its force is that of the sheet at rest.
    assert [frame.number for frame in series.frames] == [0, 10, 20, 30]
    assert not series.frames[0].displacement.any()


def test_positions_that_move_with_the_sheet_are_named(tmp_path):
    folder = write(tmp_path, fields(), deformed=True)
    with pytest.raises(DicError, match=r"positions move with the sheet.*deformed: true"):
        read_series(folder)
    table = declared("x", "y", "u", "v", ",", ".", True)
    assert np.nanmax(read_series(folder, dialect=table).frames[-1].displacement[..., 1]) == pytest.approx(
        1.92, abs=0.02
    )


HEADERS = [
    ("x [mm],y [mm],x-displacement [mm],y-displacement [mm]", "mm"),
    ("X(mm),Y(mm),U(mm),V(mm)", "mm"),
    ("Position X (mm),Position Y (mm),Displacement X (mm),Displacement Y (mm)", "mm"),
    ("x_px,y_px,u_x_px,u_y_px", "px"),
    ("x-Koordinate [mm],y-Koordinate [mm],x-Verschiebung [mm],y-Verschiebung [mm]", "mm"),
    ("X [mm],Y [mm],Déplacement X [mm],Déplacement Y [mm]", "mm"),
    ("x [µm],y [µm],ux [µm],uy [µm]", "µm"),
    ("Coordenada X [mm],Coordenada Y [mm],Desplazamiento X [mm],Desplazamiento Y [mm]", "mm"),
    ("Coordinata x (mm),Coordinata y (mm),Spostamento x (mm),Spostamento y (mm)", "mm"),
    ("x-coordinate (mm),y-coordinate (mm),horizontal displacement (mm),vertical displacement (mm)", "mm"),
]


@pytest.mark.parametrize(("header", "unit"), HEADERS)
def test_a_header_in_people_s_words_is_read(tmp_path, header, unit):
    assert named_table([header]).unit == unit
    series = read_series(write(tmp_path, fields(), header=header))
    factor = 1e-3 if unit == "µm" else 1.0
    assert series.frames[-1].displacement[-1, :, 1].mean() == pytest.approx(1.92 * factor, abs=0.01 * factor)


@pytest.mark.parametrize("header", ["Time,Force,x,y", "X,x,Y,y,u,v", "x,y,exx,eyy"])
def test_a_header_that_does_not_say_all_columns_once_is_none(header):
    assert named_table([header]) is None


def test_columns_may_be_named_with_their_units(tmp_path):
    folder = write(tmp_path, fields(), header=HEADERS[0][0])
    names = HEADERS[0][0].split(",")
    assert read_series(folder, dialect=declared(*names, ",", ".", False)).unit == "mm"


def test_units_may_stand_in_a_line_below_the_names(tmp_path):
    series = read_series(write(tmp_path, fields(), header="x,y,u,v\n[mm],[mm],[mm],[mm]"))
    assert series.unit == "mm" and series.frames[-1].displacement[-1, :, 1].mean() == pytest.approx(1.92, abs=0.01)


def test_positions_before_and_after_are_displacements(tmp_path):
    ends = [u + np.stack(np.meshgrid(LINES, LINES), axis=-1) for u in fields()]
    series = read_series(write(tmp_path / "named", ends, header="x0 [mm],y0 [mm],x1 [mm],y1 [mm]"))
    assert series.frames[-1].displacement[-1, :, 1].mean() == pytest.approx(1.92, abs=0.01)
    table = declared("x", "y", "u", "v", ",", ".", False, unit="mm", positions=True)
    declared_so = read_series(write(tmp_path / "said", ends), dialect=table)
    np.testing.assert_array_equal(declared_so.frames[-1].displacement, series.frames[-1].displacement)


def test_a_table_without_a_header_is_told_the_option_that_numbers_its_columns(tmp_path):
    folder = write(tmp_path, fields(), header="# a program's own words")
    for path in folder.glob("*.csv"):
        path.write_text(path.read_text().split("\n", 1)[1])
    with pytest.raises(DicError, match=r"has no header.*format=table --set \"table=\{x: 1, y: 2, u: 3, v: 4, unit"):
        read_series(folder)
    test = Specimen.model_validate(
        {"folder": str(folder), "width": 12, "height": 12, "thickness": 1, "format": "table"}
        | {"table": {"x": 1, "y": 2, "u": 3, "v": 4, "unit": "mm"}}
    )
    assert read_test(test).frames[-1].displacement[-1, :, 1].mean() == pytest.approx(1.92, abs=0.01)


def test_days_of_a_spreadsheet_in_a_record_are_seconds_since_the_first(tmp_path):
    path = write_record(tmp_path, 8, lambda t: f"{45352.99995 + t / 86400.0:.9f}") / "force_disp.csv"
    path.write_text(path.read_text().replace("(s),(N)", ",(N)"))
    np.testing.assert_allclose(read_force_record(path).time, np.arange(0.0, 8.05, 0.1), atol=1e-4)


def test_a_table_without_units_is_told_the_option_that_says_them(tmp_path):
    folder = write(tmp_path, fields(), header="x,y,ux,uy")
    with pytest.raises(DicError, match=r"table=\{x: 'x', y: 'y', u: 'ux', v: 'uy', unit: mm\}"):
        read_series(folder)


def test_times_of_day_in_a_record_are_seconds_since_the_first(tmp_path):
    def clock(t):
        minutes, seconds = divmod(23 * 3600 + 3590 + t, 60)
        return f"{int(minutes) // 60 % 24:02d}:{int(minutes) % 60:02d}:{seconds:05.2f}"

    read = read_force_record(write_record(tmp_path, 20, clock) / "force_disp.csv")
    np.testing.assert_allclose(read.time, np.arange(0.0, 20.05, 0.1), atol=1e-9)


def test_the_column_of_the_time_has_a_key(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("Zeitpunkt (s),Force (N)\n0,0\n1,0.5\n")
    with pytest.raises(DicError, match="time_channel"):
        read_force_record(path)
    np.testing.assert_allclose(read_force_record(path, time="Zeitpunkt").time, [0.0, 1.0])


def test_one_table_of_all_frames_is_read_by_its_column_of_frames(tmp_path):
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    cells = [np.stack([np.full(x.shape, 2.0 * k), x, y, u[..., 0], u[..., 1]], axis=-1) for k, u in enumerate(fields())]
    path = tmp_path / "all.csv"
    rows = np.concatenate(cells).reshape(-1, 5)
    np.savetxt(path, rows, delimiter=",", header="frame,x [mm],y [mm],u [mm],v [mm]", comments="", fmt="%.6f")
    series = read_series(tmp_path)
    assert [frame.number for frame in series.frames] == list(range(0, 18, 2))
    assert series.frames[-1].displacement[-1, :, 1].mean() == pytest.approx(1.92, abs=0.01)
    path.write_text(path.read_text().replace("\n2.000000,", "\n2.500000,", 1))
    with pytest.raises(DicError, match="holds no number of a frame"):
        read_series(tmp_path)


def test_positions_in_pixels_and_displacements_in_mm_are_told_the_factor_that_joins_them(tmp_path):
    folder = write(tmp_path, fields(), header="x [px],y [px],u [mm],v [mm]")
    with pytest.raises(DicError, match="--set displacement_factor=N"):
        read_series(folder)
    series = read_series(folder, declared=Declared(displacement_factor=20.0))
    assert series.unit == "pixel" and series.frames[-1].displacement[-1, :, 1].mean() == pytest.approx(38.4, abs=0.2)
