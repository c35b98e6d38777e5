"""Folders of other laboratories: words of other languages, other units, pictures without times, dropped pictures."""

import numpy as np
import pytest

from hypernode.inspection.folder import inspect
from tests.dic.pulls import LINES, NOISE, STEP, fields, write
from tests.inspection.test_situations import SIZE, TIME, force_at, said_of

GIVEN = {**SIZE, "frame_rate": 1.0}
COLUMNS = [TIME, 12.0 * STEP * TIME, force_at(STEP * TIME)]


def table(path, header, columns=None, sign=",", decimal=".", encoding="utf-8", tail=""):
    rows = [
        sign.join(each if isinstance(each, str) else f"{each:.6f}".replace(".", decimal) for each in row)
        for row in zip(*(columns or COLUMNS), strict=True)
    ]
    path.write_bytes(("\n".join([header, *rows]) + "\n" + tail).encode(encoding))


def frames_in_words(folder, header, sign=",", decimal=".", encoding="utf-8"):
    y, x = (each.ravel() for each in np.meshgrid(LINES, LINES, indexing="ij"))
    for k, u in enumerate(fields()):
        columns = [x, y, u[..., 0].ravel(), u[..., 1].ravel()]
        table(folder / f"frame{k:04d}.csv", header, columns, sign, decimal, encoding)


def is_right(found):
    assert found.sheet is not None, said_of(found)
    case = found.sheet.cases[0]
    np.testing.assert_allclose(case.force[1, 1], force_at(STEP * case.numbers), rtol=2e-3)
    np.testing.assert_allclose(case.stretch, 1.0 + STEP * case.numbers, atol=1e-3)


#: Record: header and how it is written, columns where they are others.
RECORDS = {
    "Spanish": {"header": "Tiempo (s),Desplazamiento (mm),Fuerza (N)"},
    "Italian": {"header": "Tempo;Spostamento;Forza\ns;mm;N", "sign": ";", "decimal": ","},
    "Portuguese": {
        **{"header": "Tempo [s];Deslocamento [mm];Força [N]", "sign": ";", "decimal": ","},
        "encoding": "cp1252",
    },
    "Polish": {"header": "Czas [s];Przemieszczenie [mm];Siła [N]", "sign": ";", "decimal": ",", "encoding": "cp1250"},
    "Russian": {"header": "Время (s),Перемещение (mm),Сила (N)", "encoding": "cp1251"},
    "Dutch": {"header": "Tijd [s];Verplaatsing [mm];Kracht [N]", "sign": ";", "decimal": ","},
    "Chinese": {"header": "时间(s),位移(mm),力(N)", "encoding": "gb18030"},
    "Japanese": {"header": "時間[s],変位[mm],荷重[N]", "encoding": "shift_jis"},
    "Trapezium": {"header": '"Name","A"\n"Time","Stroke","Force"\n"sec","mm","N"'},
    "kilograms": {"header": "Time (s),Load (kg)", "columns": [TIME, COLUMNS[2] / 9.80665]},
    "pounds": {"header": "time_s,load_lbs", "columns": [TIME, COLUMNS[2] / 4.4482216152605]},
    "milliseconds": {"header": "Time (ms),Force (N)", "columns": [1e3 * TIME, COLUMNS[2]]},
    "dates": {
        "header": "Time (s),Force (N)",
        "columns": [[f"2023-05-04T10:11:{50.0 + t:06.3f}" for t in TIME], COLUMNS[2]],
    },
}


@pytest.mark.parametrize("name", RECORDS)
def test_records_in_other_words_and_units_are_read_by_themselves(tmp_path, name):
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", **RECORDS[name])
    found = inspect(tmp_path, GIVEN)
    is_right(found)
    assert not said_of(found)


@pytest.mark.parametrize(
    ("header", "more"),
    [
        ("x (mm),y (mm),Desplazamiento X (mm),Desplazamiento Y (mm)", {}),
        ("x [mm];y [mm];déplacement x [mm];déplacement y [mm]", {"sign": ";", "decimal": ","}),
        (
            "X-Koordinate [mm];Y-Koordinate [mm];Verschiebung X [mm];Verschiebung Y [mm]",
            {"sign": ";", "decimal": ",", "encoding": "cp1252"},
        ),
    ],
)
def test_frames_in_other_words_are_read_by_themselves(tmp_path, header, more):
    frames_in_words(tmp_path, header, **more)
    table(tmp_path / "force_disp.csv", "Time (s),Displacement (mm),Force (N)")
    found = inspect(tmp_path, GIVEN)
    is_right(found)
    assert not said_of(found)


@pytest.mark.parametrize("first", [0, 1])
def test_a_record_of_pictures_without_times_is_enough(tmp_path, first):
    write(tmp_path, fields())
    names = [f"img_{k + first:04d}.tif" for k in range(9)]
    table(tmp_path / "force_disp.csv", "File,Force (N)", [names, force_at(STEP * np.arange(9.0))])
    found = inspect(tmp_path, SIZE)
    is_right(found)
    assert ("picture_shift=1" in said_of(found)) == bool(first)


@pytest.mark.parametrize("crosshead", [True, False])
def test_a_camera_that_dropped_pictures_is_told_by_the_curve(tmp_path, crosshead):
    taken = np.array([1, 2, 3, 4, 7, 8, 9, 10])
    write(tmp_path, fields(steps=STEP * taken))
    time = np.round(np.arange(0.0, 10.05, 0.1), 9)
    columns = [time, *([12.0 * STEP * time] if crosshead else []), force_at(STEP * time)]
    table(tmp_path / "force_disp.csv", f"Time (s),{'Displacement (mm),' if crosshead else ''}Force (N)", columns)
    assert "between frames 4 and 5" in said_of(inspect(tmp_path, GIVEN))
    for number in range(8, 4, -1):
        (tmp_path / f"frame{number:04d}.csv").rename(tmp_path / f"frame{number + 2:04d}.csv")
    found = inspect(tmp_path, GIVEN)
    is_right(found)
    assert not said_of(found)


def test_a_load_cell_at_its_limit_whose_reading_is_noisy_is_said(tmp_path):
    write(tmp_path, fields())
    rng = np.random.default_rng(0)
    clipped = np.minimum(COLUMNS[2], 0.6 * COLUMNS[2][-1]) + rng.normal(0.0, 2e-3, len(TIME))
    table(tmp_path / "force_disp.csv", "Time (s),Displacement (mm),Force (N)", [*COLUMNS[:2], clipped])
    assert "the force stays between" in said_of(inspect(tmp_path, GIVEN))


def test_numbers_that_stand_for_no_length_are_lost_or_refused(tmp_path):
    frames = fields()
    frames[3][4, 4] = 1e308, 0.0
    write(tmp_path, frames)
    table(tmp_path / "force_disp.csv", "Time (s),Displacement (mm),Force (N)")
    found = inspect(tmp_path, GIVEN)
    is_right(found)
    assert np.sqrt(np.mean(found.sheet.cases[0].noise.scatter ** 2)) == pytest.approx(NOISE, rel=0.2)


def test_a_name_with_a_number_that_no_computer_counts_is_refused(tmp_path):
    write(tmp_path, fields())
    table(tmp_path / "force_disp.csv", "Time (s),Displacement (mm),Force (N)")
    (tmp_path / "frame0008.csv").rename(tmp_path / f"frame{'9' * 22}.csv")
    assert "is too large a number for a frame" in said_of(inspect(tmp_path, GIVEN))
    (tmp_path / f"frame{'9' * 22}.csv").rename(tmp_path / f"frame{'9' * 12}.csv")
    found = inspect(tmp_path, GIVEN)
    assert found.sheet is None and "before frame" in said_of(found)
