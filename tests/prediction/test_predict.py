"""Laws from one sheet predict another one: its forces, its displacements, and how sure they are."""

import json

import numpy as np
import pytest
from PIL import Image

from hypernode.cli import main
from hypernode.config.methods import Constrained
from hypernode.mechanics.loads import make_load
from hypernode.stages import constrained
from hypernode.storage.netcdf import EXPERIMENT_UNITS, SYNTHETIC_UNITS, read, write
from tests.sheets import believed, observed_coarsely

pytestmark = pytest.mark.slow
NOISE, CELLS, PIXELS = 2e-4, 12, 96
LOAD = make_load("clamped_y", [1.05, 1.1, 1.15])
SETTINGS = Constrained(terms=[], layers=True, posterior_samples=8, seed=1)


def disc(X):
    return (np.linalg.norm(X - [0.45, 0.55], axis=1) < 0.27).astype(float)


def bar(X):
    """Beside the middle in both directions, so that a turned picture is seen to be turned."""
    return ((np.abs(X[:, 0] - 0.375) < 0.25) & (np.abs(X[:, 1] - 17 / 24) < 0.125)).astype(float)


def measurement(path, inclusion, seed, **further):
    data, _ = observed_coarsely(CELLS, inclusion, LOAD, 0.0)
    path.with_suffix(".npy").write_bytes(data["u_measured"].values[0].tobytes())
    noise = np.random.default_rng(seed).normal(0.0, NOISE, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + noise), NOISE)
    attributes = data.attrs | {"mesh": "finer", "noise_uncertainty": 0.05, "units": EXPERIMENT_UNITS} | further
    write(path, {name: each.values for name, each in data.variables.items()}, "sheet", attributes)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The measurement of sheet A and what was identified from it, that of sheet B, and the picture of B's shape."""
    folder = tmp_path_factory.mktemp("predict")
    measurement(folder / "a.nc", disc, 3)
    measurement(folder / "b.nc", bar, 4)
    (folder / "run").mkdir()
    constrained.run(SETTINGS, "a", str(folder / "a.nc"), str(folder / "run" / "constrained.nc"), {"rule": "test"})
    at = (np.arange(PIXELS) + 0.5) / PIXELS
    X = np.stack(np.meshgrid(at, at[::-1]), axis=-1).reshape(-1, 2)
    picture = Image.fromarray((255 * bar(X)).astype(np.uint8).reshape(PIXELS, PIXELS))
    picture.save(folder / "bar.png")
    picture.transpose(Image.Transpose.FLIP_TOP_BOTTOM).save(folder / "upside_down.png")
    return folder


def predicted(folder, capsys, *options, name="b.nc"):
    """(what was said, the file) of a prediction of sheet B."""
    output = folder / "prediction.nc"
    given = [str(folder / name)] if name else []
    assert main(["predict", *given, "--laws", str(folder / "run"), *options, "--output", str(output), "--json"]) == 0
    return json.loads(capsys.readouterr().out), read(output)


@pytest.fixture(scope="module")
def right(folder):
    """(score, file) of the prediction of sheet B from the laws of A and the picture of B."""
    output = folder / "right.nc"
    given = ["--laws", str(folder / "run"), "--shape", str(folder / "bar.png"), "--output", str(output)]
    assert main(["predict", str(folder / "b.nc"), *given]) == 0
    file = read(output)
    return json.loads(file.attrs["score"]), file


def test_laws_of_one_sheet_predict_another_within_two_per_cent_of_force_and_one_of_displacement(folder, right):
    score, file = right
    assert max(score["force_error"]) < 0.02
    true = np.frombuffer((folder / "b.npy").read_bytes()).reshape(file["u"].shape)
    for found, known, step_error, noise in zip(
        file["u"].values, true, score["displacement_error"], score["displacement_noise"], strict=True
    ):
        assert np.linalg.norm(found - known) < 0.01 * np.linalg.norm(known)
        assert step_error < 0.01 + noise
    top = file["edge_force_predicted"].values[:, 3, 1]
    np.testing.assert_allclose(top, -file["edge_force_predicted"].values[:, 2, 1], rtol=1e-4)


def test_the_spread_covers_what_is_missed_of_the_forces_and_is_no_larger_than_it_need_be(right):
    score, file = right
    assert score["force_within"] == 1.0
    relative = file["edge_force_spread"].values[:, 3, 1] / file["edge_force_predicted"].values[:, 3, 1]
    assert (relative > 1e-4).all() and (relative < 0.02).all()
    assert score["displacement_within"] > 0.8


def test_a_picture_upside_down_is_worse_and_flipped_is_the_same(folder, capsys, right):
    score, _ = right
    wrong, _ = predicted(folder, capsys, "--shape", str(folder / "upside_down.png"))
    assert max(wrong["displacement_error"]) > 3 * max(score["displacement_error"])
    flipped, _ = predicted(folder, capsys, "--shape", str(folder / "upside_down.png"), "--flipped")
    assert flipped["displacement_error"] == score["displacement_error"]


def test_pooling_a_specimen_with_itself_changes_nothing(folder, right):
    shape, (_, alone) = ("--shape", str(folder / "bar.png")), right
    both = f"{folder / 'run'}+{folder / 'run'}"
    output = folder / "pooled.nc"
    assert main(["predict", str(folder / "b.nc"), "--laws", both, *shape, "--output", str(output)]) == 0
    pooled = read(output)
    for name in ("u", "edge_force_predicted", "edge_force_spread"):
        np.testing.assert_allclose(pooled[name].values, alone[name].values, rtol=1e-9)


def test_a_sheet_that_nobody_tested_has_the_forces_of_the_one_that_was(folder, capsys):
    sheet = ["--size", "1", "1", "1", "--stretches", "1.05", "1.1", "1.15"]
    said, planned = predicted(folder, capsys, *sheet, "--shape", str(folder / "bar.png"), name=None)
    assert said["force_error"] is None and said["displacement_error"] is None
    measured = read(folder / "b.nc")["edge_force"].values[:, 3, 1]
    np.testing.assert_allclose(planned["edge_force_predicted"].values[:, 3, 1], measured, rtol=0.02)


def test_the_figure_is_drawn_with_and_without_a_test(folder):
    for given, panels in ((["b.nc"], 5), ([], 3)):
        sheet = [str(folder / each) for each in given] or ["--size", "1", "1", "1", "--stretches", "1.1"]
        figure, output = folder / f"{panels}.png", folder / f"{panels}.nc"
        options = ["--shape", str(folder / "bar.png"), "--output", str(output), "--figure", str(figure)]
        assert main(["predict", *sheet, "--laws", str(folder / "run"), *options]) == 0
        from hypernode.figures.prediction import draw

        named = [axes for axes in draw(read(output)).axes if axes.get_title(loc="left")]
        assert len(named) == panels and figure.stat().st_size > 0


def test_laws_in_other_units_than_the_sheet_are_refused(folder, monkeypatch, capsys):
    monkeypatch.setattr("tests.prediction.test_predict.EXPERIMENT_UNITS", SYNTHETIC_UNITS)
    measurement(folder / "pascal.nc", bar, 5)
    assert main(["predict", str(folder / "pascal.nc"), "--laws", f"{folder / 'run'}:1"]) == 2
    assert "the same units" in capsys.readouterr().err


def test_laws_of_thin_sheets_predict_no_thick_body(folder, capsys):
    measurement(folder / "thick.nc", bar, 5, plane="strain")
    assert main(["predict", str(folder / "thick.nc"), "--laws", f"{folder / 'run'}:1"]) == 2
    said = capsys.readouterr().err
    assert "plane stress" in said and "plane strain" in said


@pytest.mark.parametrize(
    "options, reason",
    [
        (["b.nc", "--laws", "run"], "--shape FILE"),
        (["b.nc", "--laws", "run:1", "run:1", "run:2", "--shape", "bar.png"], "2 grey levels"),
        (["b.nc", "--laws", "run:3"], "no 3"),
        (["b.nc", "--laws", "nowhere"], "results/CASE/METHOD"),
        (["b.nc", "--laws", "run", "--lines", "run:1"], "constrained.nc is not there"),
        (["b.nc", "--laws", "run+run:1"], "different numbers of phases"),
        (["b.nc", "--laws", "run:1", "--stretches", "1.1"], "--stretches"),
        (["--laws", "run:1", "--size", "1", "1", "1"], "--stretches"),
        (["b.nc", "--laws", "run:1", "--flipped"], "--flipped"),
        (["run/constrained.nc", "--laws", "run:1"], "is no measurement"),
    ],
)
def test_what_is_missing_is_said_with_the_way_out(folder, capsys, monkeypatch, options, reason):
    monkeypatch.chdir(folder)
    assert main(["predict", *options]) == 2
    assert reason in capsys.readouterr().err
