"""Any load, several tests, no force at all: what folders say becomes one measurement, or a sentence."""

import json

import numpy as np
import pytest

from hypernode.config.loading import ConfigError, check_config
from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.series import Frame, Series
from hypernode.dic.specimen import import_specimen
from hypernode.dic.writing import write_force_record, write_series
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.stages import import_dic
from hypernode.stages.imported_sheet import variables_of
from hypernode.storage.netcdf import read

WIDTH, HEIGHT, THICKNESS = 12.0, 9.0, 2.0
X, Y = np.linspace(0.0, WIDTH, 13), np.linspace(0.0, HEIGHT, 10)
STRETCHES = [1.0, 1.02, 1.05, 1.08]
SIZES = {"width": WIDTH, "height": HEIGHT, "thickness": THICKNESS, "noise_mm": 1e-6, "frame_rate": 1.0}
#: Load -> mean displacement gradient at a stretch.
GRADIENT = {
    "biaxial": lambda s: np.diag([s - 1.0, 0.5 * (s - 1.0)]),
    "uniaxial_x": lambda s: np.diag([s - 1.0, s**-0.5 - 1.0]),
    "uniaxial_y": lambda s: np.diag([s**-0.5 - 1.0, s - 1.0]),
    "clamped_y": lambda s: np.diag([0.0, s - 1.0]),
    "shear": lambda s: np.array([[0.0, s - 1.0], [0.0, 0.0]]),
    "general": lambda s: np.array([[s - 1.0, 0.2 * (s - 1.0)], [0.1 * (s - 1.0), 0.6 * (s - 1.0)]]),
}
COMPONENTS = {"biaxial": "xy", "uniaxial_x": "x", "uniaxial_y": "y", "clamped_y": "y", "shear": "x", "general": "xy"}


def displacement(load, stretch, x=X, y=Y):
    return np.stack(np.meshgrid(x, y), axis=-1) @ GRADIENT[load](stretch).T


def written(folder, load, x=X, y=Y, change=lambda u: u, forces=None):
    """Frames of a load and forces of 10 and 7 N along x and y at the last one."""
    frames = [Frame(k, change(displacement(load, s, x, y)) if k else 0.0 * displacement(load, s, x, y)) for k, s in
              enumerate(STRETCHES)]  # fmt: skip
    write_series(Series(x - x[0], y - y[0], frames, unit="mm"), folder)
    rise = np.array([(s - 1.0) / (STRETCHES[-1] - 1.0) for s in STRETCHES])
    wanted = COMPONENTS[load] if forces is None else forces
    force = {axis: {"x": 10.0, "y": 7.0}[axis] * rise for axis in wanted}
    if force:
        write_force_record(folder / "force_disp.csv", np.arange(4.0), {axis: rise for axis in force}, force)
    return {"folder": str(folder), "load": load}


def imported(*tests, **settings):
    several = {"tests": list(tests)} if len(tests) > 1 else tests[0]
    return import_specimen(
        Specimen.model_validate({**SIZES, "outline": "edge", "load_steps": 3, **several, **settings})
    )


@pytest.mark.parametrize("load", GRADIENT)
def test_every_load_has_its_forces_on_its_edges_and_balances(tmp_path, load):
    sheet = imported(written(tmp_path, load))
    np.testing.assert_allclose(sheet.H[-1], GRADIENT[load](1.08), atol=1e-12)
    expected = np.full((4, 2), np.nan)
    if load == "shear":
        expected[2:, 0] = -10.0, 10.0
    else:
        for axis in COMPONENTS[load]:
            expected[2 * "xy".index(axis) :, "xy".index(axis)][:2] = np.array([-1.0, 1.0]) * {"x": 10.0, "y": 7.0}[axis]
    np.testing.assert_allclose(sheet.edge_force[-1], expected)
    largest = {"shear": 0.08, "uniaxial_y": 0.08, "clamped_y": 0.08}.get(load, 0.08)
    assert sheet.stretch[-1] == pytest.approx(1.0 + largest)


def test_tests_of_one_specimen_follow_one_another_each_with_its_load_and_record(tmp_path):
    loads = ("biaxial", "uniaxial_x", "uniaxial_y")
    sheet = imported(*(written(tmp_path / load, load) for load in loads), frames=None)
    assert sheet.load_case.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    for k, load in enumerate(loads):
        np.testing.assert_allclose(sheet.H[3 * k + 2], GRADIENT[load](1.08), atol=1e-12)
    known = np.isfinite(sheet.edge_force[::3])
    assert [known[k].sum() for k in range(3)] == [4, 2, 2]


def test_a_test_takes_over_what_its_specimen_says_but_not_its_frames(tmp_path):
    tests = [{**written(tmp_path / "a", "biaxial"), "frames": [2]}, written(tmp_path / "b", "uniaxial_x")]
    sheet = imported(*tests)
    assert [case.numbers.tolist() for case in sheet.cases] == [[2], [1, 2, 3]]


def test_grids_of_tests_are_laid_over_one_another_by_their_centres(tmp_path):
    """The second grid is coarser and as large: what it says of a linear field is interpolated exactly."""
    coarse = np.linspace(0.0, WIDTH, 8), np.linspace(0.0, HEIGHT, 6)
    tests = [written(tmp_path / "a", "biaxial"), written(tmp_path / "b", "uniaxial_x", *coarse)]
    sheet = imported(*tests)
    np.testing.assert_allclose(sheet.u[-1], sheet.mesh.nodes @ GRADIENT["uniaxial_x"](1.08).T, atol=1e-12)


def test_a_smaller_field_needs_its_place_and_cuts_the_grid(tmp_path):
    small = X[2:-1], Y[1:-2]
    tests = [written(tmp_path / "a", "biaxial"), written(tmp_path / "b", "uniaxial_x", *small)]
    with pytest.raises(DicError, match=r"b: its field of 9 x 6 mm is not that of .*a, 12 x 9 mm: .*grid_offset"):
        imported(*tests, outline="cut", edge_ring=0)
    sheet = imported(tests[0], {**tests[1], "grid_offset": [X[2], Y[1]]}, outline="cut", edge_ring=0)
    assert sheet.mesh.lower.tolist() == [X[2], Y[1]] and len(sheet.mesh.nodes) == len(small[0]) * len(small[1])
    np.testing.assert_allclose(sheet.H[-1], GRADIENT["uniaxial_x"](1.08), atol=1e-12)


def test_what_the_camera_moved_is_taken_out_and_said(tmp_path, capsys):
    angle = np.radians(1.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    place = np.stack(np.meshgrid(X, Y), axis=-1)
    moved = written(tmp_path, "biaxial", change=lambda u: (place + u) @ turn.T + [0.3, -0.2] - place)
    sheet = imported(moved)
    np.testing.assert_allclose(sheet.H[-1], GRADIENT["biaxial"](1.08), atol=1e-9)
    np.testing.assert_allclose(np.degrees(sheet.cases[0].camera_angle), 1.0, atol=1e-6)
    assert "turned by up to 1 degrees in 3 frames" in capsys.readouterr().err
    kept = imported(moved, camera_motion=False)
    assert abs(kept.H[-1, 1, 0]) > 0.01


def test_a_biaxial_test_needs_a_force_along_each_axis(tmp_path):
    test = written(tmp_path, "biaxial", forces="x")
    with pytest.raises(DicError, match=r"one force \('Force'\), and a biaxial test has one along x and one along y"):
        imported(test)


def test_channels_are_named_by_axis(tmp_path):
    test = written(tmp_path, "biaxial")
    path = tmp_path / "force_disp.csv"
    path.write_text(path.read_text().replace('"Force x","Force y"', '"Cell 2","Cell 1"'))
    sheet = imported({**test, "force_channel": {"x": "Cell 2", "y": "Cell 1"}})
    assert sheet.edge_force[-1, EDGE_NAMES.index("right"), 0] == pytest.approx(10.0)
    swapped = imported({**test, "force_channel": {"x": "Cell 1", "y": "Cell 2"}})
    assert swapped.edge_force[-1, EDGE_NAMES.index("right"), 0] == pytest.approx(7.0)


def test_a_sheet_is_sheared_to_either_side(tmp_path):
    test = written(tmp_path, "shear", change=lambda u: -u)
    with pytest.raises(DicError, match="shear to the right, as positive"):
        imported(test)
    rise = (np.array(STRETCHES) - 1.0) / (STRETCHES[-1] - 1.0)
    write_force_record(tmp_path / "force_disp.csv", np.arange(4.0), {"x": -rise}, {"x": -10.0 * rise})
    sheet = imported(test)
    np.testing.assert_allclose(sheet.stretch, STRETCHES[1:])
    assert sheet.H[-1, 0, 1] == pytest.approx(-0.08)
    assert sheet.edge_force[-1, EDGE_NAMES.index("top"), 0] == pytest.approx(-10.0)


def test_steps_of_a_general_load_follow_its_shear_and_no_force_is_taken_for_one_across_it(tmp_path):
    test = written(tmp_path, "shear", forces="y") | {"load": "general", "force_channel": {"y": "Force"}}
    with pytest.raises(DicError, match=r"along y, along which the sheet hardly stretches .* sheared by 0\.08"):
        imported(test)
    sheet = imported({**test, "force_file": None})
    assert sheet.cases[0].numbers.tolist() == [1, 2, 3]
    np.testing.assert_allclose(sheet.cases[0].stretch, STRETCHES[1:])


def test_without_a_record_one_resultant_sets_the_level(tmp_path):
    test = written(tmp_path, "biaxial", forces="")
    sheet = imported({**test, "force_file": None})
    known = np.isfinite(sheet.edge_force)
    assert known.sum() == 2 and not sheet.forces_known
    s, t = 1.08, 1.04
    stress = s - s**-3 * t**-2
    assert sheet.edge_force[-1, 1, 0] == pytest.approx(stress * HEIGHT * THICKNESS)


def test_frames_are_chosen_by_time(tmp_path):
    test = written(tmp_path, "biaxial")
    sheet = imported({**test, "times": [1.1, 2.9]}, load_steps=None)
    assert sheet.cases[0].numbers.tolist() == [1, 3]
    with pytest.raises(DicError, match=r"no frame is of 7 s; they are from 1 to 3 s"):
        imported({**test, "times": [7.0]}, load_steps=None)


def test_noise_that_nobody_states_is_that_of_the_frames(tmp_path):
    random = np.random.default_rng(2)
    fine = np.linspace(0.0, WIDTH, 41), np.linspace(0.0, HEIGHT, 31)
    noise = np.array([0.002, 0.006])
    test = written(tmp_path, "biaxial", *fine, lambda u: u + random.normal(0.0, 1.0, u.shape) * noise)
    sheet = imported(test, noise_mm=None)
    np.testing.assert_allclose(sheet.cases[0].noise.scatter, np.tile(noise, (3, 1)), rtol=0.15)
    assert "local fit" in sheet.cases[0].noise.source


def test_what_frames_tell_is_kept_beside_a_noise_that_is_stated(tmp_path):
    random = np.random.default_rng(2)
    fine = np.linspace(0.0, WIDTH, 41), np.linspace(0.0, HEIGHT, 31)
    test = written(tmp_path, "biaxial", *fine, lambda u: u + random.normal(0.0, 0.004, u.shape))
    variables = variables_of(imported(test, noise_mm=0.01), np.zeros(2))
    assert (variables["noise_level"] == 0.01).all() and (variables["noise_scatter"] == 0.01).all()
    np.testing.assert_allclose(variables["frames_noise_scatter"], 0.004, rtol=0.15)


def test_points_too_few_to_tell_their_noise_take_the_stated_one(tmp_path):
    few = np.linspace(0.0, WIDTH, 5), np.linspace(0.0, HEIGHT, 5)
    variables = variables_of(imported(written(tmp_path, "biaxial", *few), noise_mm=0.01, edge_ring=0), np.zeros(2))
    assert (variables["noise_level"] == 0.01).all() and "frames_noise_level" not in variables


def test_errors_that_every_frame_repeats_count_as_larger_ones(tmp_path):
    """A mean over frames takes out what is independent in them, and nothing of what is not."""
    fine = np.linspace(0.0, WIDTH, 41), np.linspace(0.0, HEIGHT, 31)
    same = np.random.default_rng(2).normal(0.0, 0.004, (31, 41, 2))
    sheet = imported(written(tmp_path, "biaxial", *fine, lambda u: u + same), noise_mm=None)
    noise = sheet.cases[0].noise
    np.testing.assert_allclose(noise.scatter, 0.004, rtol=0.15)
    assert 1.4 < np.mean(noise.level / noise.scatter) < 2.0


def test_a_map_of_the_thickness_is_interpolated_and_kept_by_cell(tmp_path):
    test = written(tmp_path / "frames", "biaxial")
    chart = tmp_path / "thickness.csv"
    corners = [(0, 0), (WIDTH, 0), (0, HEIGHT), (WIDTH, HEIGHT)]
    chart.write_text(
        "x [mm],y [mm],thickness [mm]\n" + "".join(f"{x},{y},{1.8 + 0.4 * x / WIDTH}\n" for x, y in corners)
    )
    sheet = imported(test, thickness_map=str(chart))
    np.testing.assert_allclose(sheet.relative_thickness, 0.9 + 0.2 * sheet.mesh.centres[:, 0] / WIDTH, rtol=1e-9)
    assert chart in sheet.files
    chart.write_text("x,y,thickness\n0,0,0\n")
    with pytest.raises(DicError, match=r"thickness\.csv:2: needs a position and a positive thickness"):
        imported(test, thickness_map=str(chart))


def test_methods_of_one_thickness_refuse_a_map(tmp_path):
    test = written(tmp_path, "biaxial")
    (tmp_path / "t.csv").write_text("x,y,thickness\n")
    raw = {"specimens": {"s": {**SIZES, **test, "thickness_map": str(tmp_path / "t.csv")}}}
    assert set(check_config(raw).cases) == {"s"}
    raw["cases"] = {"c": {"specimen": "s", "methods": ["paper"]}}
    with pytest.raises(ConfigError, match="paper takes the sheet as everywhere of one thickness"):
        check_config(raw)


def test_the_file_says_of_each_test_what_it_is(tmp_path):
    tests = [written(tmp_path / load, load) for load in ("biaxial", "uniaxial_x")]
    config = check_config({"specimens": {"s": {**SIZES, "outline": "edge", "tests": tests}}})
    import_dic.run(config, "s", str(tmp_path / "m.nc"), {})
    data = read(tmp_path / "m.nc")
    assert json.loads(data.attrs["load_cases"]) == ["biaxial", "uniaxial_x"] and data.sizes["test"] == 2
    assert data.attrs["forces"] == "measured" and data.attrs["outline"] == "edge"
    assert len(json.loads(data.attrs["noise_sources"])) == 2 and (data["relaxation"].values == 1.0).all()


def test_an_edge_of_the_sheet_that_is_dropped_is_none():
    with pytest.raises(ValueError, match=r"edge_ring = 1 drops points on the edge of the sheet"):
        Specimen.model_validate({**SIZES, "folder": "f", "outline": "edge", "edge_ring": 1})
    assert Specimen.model_validate({**SIZES, "folder": "f", "outline": "edge"}).dropped_rings == 0
    assert Specimen.model_validate({**SIZES, "folder": "f"}).dropped_rings == 1
