"""Laws of phases whose shape is known: right though the picture lies beside the shape, and fit to predict."""

import json

import numpy as np
import pytest
from PIL import Image

from hypernode.cli import main
from hypernode.material.basis_file import basis_field
from hypernode.storage.netcdf import read, units_of, write
from tests.prediction.test_predict import CELLS, PIXELS, disc, measurement

pytestmark = pytest.mark.slow

#: How far the picture lies beside the shape, in sides of the sheet: half a cell.
BESIDE = 0.5 / CELLS


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A sheet, the picture of its shape half a cell to the right, and what was identified from both."""
    folder = tmp_path_factory.mktemp("phases")
    measurement(folder / "a.nc", disc, 3)
    at = (np.arange(PIXELS) + 0.5) / PIXELS
    X = np.stack(np.meshgrid(at, at[::-1]), axis=-1).reshape(-1, 2)
    seen = disc(X - [BESIDE, 0.0])
    Image.fromarray((255 * seen).astype(np.uint8).reshape(PIXELS, PIXELS)).save(folder / "disc.png")
    given = ["--shape", str(folder / "disc.png"), "--method", "hypernode_isotropic", "--output", str(folder / "known")]
    assert main(["phases", str(folder / "a.nc"), *given]) == 0
    return folder


def test_the_laws_of_both_phases_are_right_and_the_shape_lies_where_it_is(folder):
    found = read(folder / "known" / "constrained.nc")
    basis, params = basis_field(found)
    assert basis.terms == ()
    level, labels = params[0, 0], found["material_label"].values
    stiff, soft = (np.median(level[labels == k]) for k in (1, 0))
    assert np.exp(stiff - soft) == pytest.approx(2.0, rel=0.02)
    cells = found["X"].values[found["cells"].values].mean(axis=1)
    middle = cells[labels == 1].mean(axis=0)
    assert np.abs(middle - [0.45, 0.55]).max() < 0.2 * BESIDE + 0.25 / CELLS
    distance = found["interface_distance"].values[0]
    right, left = (np.interp(0.0, -distance[row], found["X"].values[row, 0]) for row in _beside(found))
    assert 0.5 * (right + left) == pytest.approx(0.45, abs=0.2 * BESIDE)


def _beside(found):
    """Nodes of the row through the middle of the disc, to its right, and to its left from the inside out."""
    X = found["X"].values
    row = np.flatnonzero(np.isclose(X[:, 1], X[np.abs(X[:, 1] - 0.55).argmin(), 1]))
    row = row[np.argsort(X[row, 0])]
    return row[X[row, 0] > 0.45], row[X[row, 0] < 0.45][::-1]


def test_a_sheet_of_one_phase_needs_no_picture_and_predicts_itself(folder):
    measurement(folder / "plain.nc", lambda X: np.zeros(len(X)), 6)
    plain, output = folder / "plain", folder / "prediction.nc"
    assert main(["phases", str(folder / "plain.nc"), "--method", "hypernode_isotropic", "--output", str(plain)]) == 0
    assert main(["predict", str(folder / "plain.nc"), "--laws", str(plain), "--output", str(output)]) == 0
    assert max(json.loads(read(output).attrs["score"])["force_error"]) < 0.01


def test_what_samples_do_not_know_of_a_level_is_part_of_the_spread_of_forces(folder):
    """Nothing but the thickness of the source is uncertain, by 10 %, and so is the force. Samples know the gain."""
    run, output = folder / "budgeted", folder / "budgeted.nc"
    run.mkdir()
    found = read(folder / "known" / "constrained.nc")
    rows = [{"input": "thickness", "prior": 0.1, "level": 0.1}, {"input": "gain", "prior": 0.3, "level": 0.3}]
    variables = {name: (each.dims, each.values) if "." in name else each.values for name, each in found.items()}
    variables |= {name: each.values for name, each in found.coords.items()}
    attributes = {name: each.item() if isinstance(each, np.generic) else each for name, each in found.attrs.items()}
    write(run / "constrained.nc", variables, "field", attributes | {"units": units_of(found), "level_budget": rows})
    shape = ["--shape", str(folder / "disc.png")]
    assert main(["predict", str(folder / "a.nc"), "--laws", str(run), *shape, "--output", str(output)]) == 0
    file = read(output)
    relative = file["edge_force_spread"].values[:, 3, 1] / file["edge_force_predicted"].values[:, 3, 1]
    np.testing.assert_allclose(relative, 0.1, rtol=0.02)


@pytest.mark.parametrize(
    "options, reason",
    [
        (["--method", "paper"], "choose one of hypernode"),
        (["--shape", "disc.png", "--count", "1"], "leave out --shape"),
        (["--flipped"], "add --shape PICTURE"),
        (["--shape", "disc.png", "--count", "3"], "2 grey levels"),
    ],
)
def test_what_is_missing_is_said_with_the_way_out(folder, capsys, monkeypatch, options, reason):
    monkeypatch.chdir(folder)
    assert main(["phases", "a.nc", *options, "--output", "none"]) == 2
    assert reason in capsys.readouterr().err
