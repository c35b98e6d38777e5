"""A vendor's folder becomes a measurement in mm, N and MPa, or a message with file and line."""

import json

import numpy as np
import pytest

from hypernode.config.loading import check_config
from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.reading import read_series
from hypernode.dic.relaxing import not_held_out
from hypernode.dic.specimen import import_specimen
from hypernode.stages import import_dic
from hypernode.storage.netcdf import read

HEADER = "x [pixel];y [pixel];x-displacement [pixel];y-displacement [pixel];Displacement [pixel]"
PIXEL = 0.05


def write_frame(folder, number, stretch, change=lambda rows: rows):
    rows = []
    for y in range(10, 10 + 23 * 9, 23):
        for x in range(5, 5 + 23 * 7, 23):
            # The sheet is pulled upward: pixel y runs downward, so the displacement is negative.
            uy = -(stretch - 1.0) * (10 + 23 * 8 - y)
            ux = (stretch**-0.5 - 1.0) * (x - 5)
            rows.append(f"{x};{y};{ux + 1e-9 * (number > 1):.9g};{uy + 1e-9 * (number > 1):.9g};0")
    (folder / f"Test{number:04d}.csv").write_text("\n".join([HEADER, *change(rows)]) + "\r\n")


@pytest.fixture
def folder(tmp_path):
    for number, stretch in ((1, 1.0), (6, 1.05), (11, 1.1)):
        write_frame(tmp_path, number, stretch)
    force = ["Time,Displacement,Force", "(s),(mm),(N)"] + [f'"{t}","0","{10 * t}"' for t in np.linspace(0, 3, 31)]
    (tmp_path / "force_disp.csv").write_text("\n".join(force))
    return tmp_path


def config(folder, **changes):
    specimen = {
        "folder": str(folder), "width": 161 * PIXEL, "height": 207 * PIXEL, "thickness": 2.0, "pixel_size": PIXEL,
        "frame_rate": 5.0, "edge_ring": 1, "frames": [6, 11], **changes,
    }  # fmt: skip
    method = {
        "interpolant": {"features": 2, "frequency_scale": 1, "widths": [2], "iterations": 1},
        "node": {"terms": ["I1"], "hidden": [2]}, "hypernetwork": {"features": 2, "frequency_scale": 1, "widths": [2]},
        **{k: {"iterations": 1} for k in ("homogenised", "initialisation", "pretraining", "training")},
    }  # fmt: skip
    return check_config({
        "specimens": {"s": specimen}, "methods": {"m": method}, "cases": {"c": {"specimen": "s", "methods": ["m"]}},
    })  # fmt: skip


def imported(folder, tmp_path, **changes):
    import_dic.run(config(folder, **changes), "c", str(tmp_path / "out.nc"), {})
    return read(tmp_path / "out.nc")


def test_lengths_forces_and_directions(folder, tmp_path):
    data = imported(folder, tmp_path)
    np.testing.assert_allclose(data["stretch"], [1.05, 1.10], rtol=1e-6)
    np.testing.assert_allclose(data["H"].values[:, 0, 0], [1.05**-0.5 - 1, 1.1**-0.5 - 1], rtol=1e-5)
    spacing = 23 * PIXEL
    corners = data["corners"].values
    np.testing.assert_allclose(corners[1] - corners[0], [4 * spacing, 6 * spacing])
    # Frame k is taken at (k - 1)/rate; the record gives 10 N/s; the kept grid is narrower than the sheet.
    np.testing.assert_allclose(data["time"], [1.0, 2.0])
    np.testing.assert_allclose(data["edge_force"].values[:, 3, 1], np.array([10.0, 20.0]) * 4 * spacing / (161 * PIXEL))
    top = data["X"].values[:, 1] == corners[1, 1]
    assert (data["u_measured"].values[0, -1, top, 1] > 0).all(), "y points upward"


def test_what_the_record_reads_before_the_sheet_pulls_is_subtracted(folder, tmp_path):
    plain = imported(folder, tmp_path)["edge_force"].values
    (tmp_path / "out.nc").unlink()
    less = imported(folder, tmp_path, force_offset=2.5)["edge_force"].values
    np.testing.assert_allclose(less[:, 3, 1] / plain[:, 3, 1], [7.5 / 10.0, 17.5 / 20.0])


def relaxing_record(folder):
    """Twelve frames at a constant rate, and a neo-Hookean sheet whose force relaxes to 5/7 with 0.3 s."""
    for number in range(2, 14):
        write_frame(folder, number, 1.0 + 0.01 * (number - 1))
    t = np.linspace(0, 3, 601)
    elastic = 1.0 + 0.05 * t - (1.0 + 0.05 * t) ** -2
    kernel = np.exp(-np.abs(t[:, None] - t[None]) / 0.3) * (t[:, None] >= t[None])
    force = 100.0 * (elastic + 0.4 * np.trapezoid(kernel * np.gradient(elastic, t)[None], t, axis=1))
    rows = ["Time,Displacement,Force", "(s),(mm),(N)"] + [f"{a},0,{b}" for a, b in zip(t, force, strict=True)]
    (folder / "force_disp.csv").write_text("\n".join(rows))
    return t, 100.0 * elastic


def test_what_is_a_matter_of_time_is_told_apart_and_the_record_stays_as_it_is(folder, tmp_path):
    time, elastic = relaxing_record(folder)
    chosen = {"frames": None, "stretches": [1.04, 1.06, 1.08, 1.11]}
    data = imported(folder, tmp_path, **chosen)
    rigid = data["edge_force"].values[:, 3, 1] / data["relaxation"].values
    expected = np.interp(data["time"], time, elastic)
    np.testing.assert_allclose(rigid / rigid[-1], expected / expected[-1], rtol=0.01)
    (tmp_path / "out.nc").unlink()
    plain = imported(folder, tmp_path, relaxation=False, **chosen)
    np.testing.assert_array_equal(plain["relaxation"], 1.0)
    np.testing.assert_array_equal(plain["edge_force"], data["edge_force"])
    bent = plain["edge_force"].values[:, 3, 1]
    assert (bent / bent[-1] / (expected / expected[-1]))[0] > 1.05


def test_between_frames_and_after_the_last_one_used_the_crosshead_tells_how_the_stretch_goes_on(folder, tmp_path):
    """Five frames in the first half of a pull; a record without crosshead is read until the last of them."""
    time, elastic = relaxing_record(folder)
    chosen = {"frames": None, "stretches": [1.02, 1.03, 1.04, 1.05, 1.06]}
    short = imported(folder, tmp_path, **chosen)
    (tmp_path / "out.nc").unlink()
    rows = (folder / "force_disp.csv").read_text().splitlines()
    fields = [row.split(",") for row in rows[2:]]
    moved = [f"{a},{0.5 * float(a)},{force}" for a, _, force in fields]
    (folder / "force_disp.csv").write_text("\n".join([*rows[:2], *moved]))
    data = imported(folder, tmp_path, **chosen)
    assert short["relaxation_time"][0, -1] == pytest.approx(data["time"][-1])
    assert data["relaxation_time"][0, -1] == pytest.approx(2.4)
    rigid = data["edge_force"].values[:, 3, 1] / np.interp(data["time"], time, elastic)
    error = data["relaxation"].values / (rigid / rigid.mean()) - 1.0
    spread = data["force_relaxation_uncertainty"].values
    assert 0.0 < np.abs(error).max() <= 2.0 * np.abs(spread).max()
    assert data["relaxation"].values.mean() == pytest.approx(1.0)


def test_a_sample_is_of_the_frame_nearest_to_it_and_held_out_with_that():
    time, frames = np.arange(0.0, 4.5, 0.5), np.arange(5.0)
    seen = not_held_out(time, frames, np.array([True, False, True, False, True]), 1.0)
    assert time[seen].tolist() == [0.0, 0.5, 1.0, 2.0, 2.5, 4.0]


def test_every_frame_that_was_read_is_named(folder, tmp_path):
    relaxing_record(folder)
    data = imported(folder, tmp_path, frames=None, stretches=[1.04, 1.06])
    assert len(json.loads(data.attrs["raw_inputs"])) == 14


def test_a_frame_whose_end_row_is_lost_is_no_load_step_and_tells_nothing_of_time(folder, tmp_path):
    relaxing_record(folder)
    whole = imported(folder, tmp_path, frames=None, stretches=[1.04, 1.08, 1.11])["relaxation"].values
    (tmp_path / "out.nc").unlink()

    def lose(rows):
        near = sorted(rows, key=lambda row: float(row.split(";")[1]))
        return [*near[:7], *(";".join([*row.split(";")[:2], "0", "0", "0"]) for row in near[7:14]), *near[14:]]

    write_frame(folder, 7, 1.06, lose)
    data = imported(folder, tmp_path, frames=None, stretches=[1.04, 1.08, 1.11])
    assert json.loads(data.attrs["frames"]) == [[5, 9, 12]]
    np.testing.assert_allclose(data["relaxation"], whole, rtol=5e-3)


def test_steps_chosen_by_stretch(folder, tmp_path):
    data = imported(folder, tmp_path, frames=None, stretches=[1.04, 1.099])
    assert json.loads(data.attrs["frames"]) == [[6, 11]]


def test_a_lost_point_is_missing_data_and_no_hole(folder, tmp_path):
    def lose(rows):
        x, y, *_ = rows[31].split(";")
        return [*rows[:31], f"{x};{y};0;0;0", *rows[32:]]

    write_frame(folder, 11, 1.1, lose)
    data = imported(folder, tmp_path)
    assert json.loads(str(data.attrs["lost_points"])) == 1
    assert data.sizes["node"] == 5 * 7 and data.sizes["cell"] == 4 * 6
    lost = np.isnan(data["u_measured"].values[0]).any(axis=2)
    assert lost.sum(axis=1).tolist() == [int(number == 11) for number in json.loads(data.attrs["frames"])[0]]
    assert np.isfinite(data["H"]).all()


def test_a_frame_that_lost_most_of_its_points_is_refused(folder, tmp_path):
    write_frame(
        folder, 11, 1.1, lambda rows: [f"{';'.join(row.split(';')[:2])};0;0;0" for row in rows[:-9]] + rows[-9:]
    )
    with pytest.raises(DicError, match="frame 11 has lost 34 of 35 points"):
        imported(folder, tmp_path)


def test_a_hole_is_where_it_is_declared(folder, tmp_path):
    specimen = config(folder).specimens["s"]
    whole, pierced = (
        import_specimen(specimen),
        import_specimen(specimen, lambda X: (np.abs(X - 0.5) < 0.2).all(axis=1) * 1.0),
    )
    assert len(pierced.mesh.cells) < len(whole.mesh.cells)
    np.testing.assert_array_equal(pierced.u[0][0], whole.u[0][0])


CORRUPTIONS = {
    "ragged": (lambda rows: [*rows[:3], "1;2", *rows[4:]], r"0011\.csv:5: 2 fields"),
    "decimal comma": (lambda rows: [r.replace(".", ",") for r in rows], r"0011\.csv:2: .*decimal comma"),
    "wrong delimiter": (lambda rows: [r.replace(";", ",") for r in rows], r"0011\.csv:2: 1 fields"),
    "duplicate": (lambda rows: [*rows, rows[0]], r"there twice"),
    "off grid": (lambda rows: ["6" + rows[0][1:], *rows[1:]], r"0011\.csv:2: .*not on the grid"),
    "empty": (lambda rows: [], r"0011\.csv:2: no points"),
}


@pytest.mark.parametrize("name", CORRUPTIONS)
def test_a_broken_frame_is_named_with_its_line(folder, tmp_path, name):
    change, message = CORRUPTIONS[name]
    write_frame(folder, 11, 1.1, change)
    with pytest.raises(DicError, match=message):
        imported(folder, tmp_path)
    assert not (tmp_path / "out.nc").exists()


def test_a_missing_frame_names_the_nearest(folder, tmp_path):
    with pytest.raises(DicError, match="frame 9 is not there; the nearest is 11"):
        imported(folder, tmp_path, frames=[6, 9])


def test_a_record_shorter_than_the_frames_is_an_error(folder, tmp_path):
    with pytest.raises(DicError, match="ends at 3 s, before frame 11"):
        imported(folder, tmp_path, frame_rate=2.5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Time,Force\n0,1\n1,2\n", r"csv:2: the line of units"),
        ("Time,Force\n(s),(N)\n0,1\n2,2\n1,3\n", r"csv:5: time goes back"),
        ("Time,Weight\n(s),(N)\n0,1\n", r"csv:1: 'Time', 'Weight' are no known names of a force"),
        ("Time,Force\n(s),(N)\n0,a\n", r"csv:3: not a sample"),
    ],
)
def test_a_broken_force_record_is_named_with_its_line(tmp_path, text, message):
    (tmp_path / "force.csv").write_text(text)
    with pytest.raises(DicError, match=message):
        read_force_record(tmp_path / "force.csv")


def test_kilonewtons_are_converted(tmp_path):
    (tmp_path / "force.csv").write_text("Time,Force\n(s),(kN)\n0,0.5\n1,1.0\n")
    np.testing.assert_allclose(read_force_record(tmp_path / "force.csv").force[:, 0], [500.0, 1000.0])


def test_a_folder_without_frames_is_an_error(tmp_path):
    with pytest.raises(DicError, match="no frames"):
        read_series(tmp_path)
