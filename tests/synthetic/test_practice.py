"""A sheet to practise with is what it is said to be, and its folder is one that a laboratory could bring."""

import json
import os

import numpy as np
import pytest

from hypernode import cli
from hypernode.commands.practice import LOADS
from hypernode.synthetic import practice
from hypernode.synthetic.practice import SIDE, practice_test


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Half of the points along a side, and half of the frames."""
    monkeypatch.setattr(practice, "POINTS", 21)
    monkeypatch.setattr(practice, "FRAMES", 5)
    before = dict(os.environ)
    yield
    # The command sets the compiler up for its own process.
    os.environ.clear()
    os.environ.update(before)


def test_the_sheet_is_stiffer_than_its_matrix_and_softer_than_its_inclusion():
    test = practice_test("uniaxial_y", 0.0)
    stretch = 1.0 + test.moved["y"] / SIDE
    homogeneous = SIDE * practice.THICKNESS * (stretch - stretch**-2.0)
    force = test.force["y"]
    assert force[0] == 0.0 and (np.diff(force) > 0.0).all()
    assert (practice.MATRIX * homogeneous[1:] < force[1:]).all()
    assert (force[1:] < practice.INCLUSION * homogeneous[1:]).all()


def test_noise_is_as_large_as_it_is_said_to_be_and_the_reference_has_none():
    exact, noisy, again = (practice_test("clamped_y", noise, seed=3) for noise in (0.0, 0.01, 0.01))
    np.testing.assert_array_equal(noisy.displacement, again.displacement)
    error = noisy.displacement - exact.displacement
    assert not error[0].any()
    assert np.std(error[1:]) == pytest.approx(0.01, rel=0.05)
    np.testing.assert_allclose(exact.displacement[-1, -1, :, 1], 0.2 * SIDE, rtol=1e-12)


@pytest.mark.parametrize(
    "kind", ["clamped_y", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("biaxial", "shear", "uniaxial_x"))]
)
def test_a_folder_can_be_imported_and_shows_its_load(kind, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["practice", "pull", "--load", kind]) == 0
    assert "disc at 8, 11 mm" in capsys.readouterr().out
    words = ["--size", f"{SIDE}", f"{SIDE}", f"{practice.THICKNESS}", "--frame-rate", "1"]
    if kind == "shear":
        # Displacements of a shear are those of a pull whose components are swapped, so that its owner is asked.
        assert cli.main(["inspect", "pull", *words]) == 1
        assert "--load shear says that they are right" in capsys.readouterr().out
        words += ["--load", "shear"]
    assert cli.main(["inspect", "pull", *words, "--json"]) == 0
    seen = json.loads(capsys.readouterr().out)
    assert seen["load"]["kind"] == kind and not seen["odd"]


def test_a_folder_that_holds_something_is_left_alone(tmp_path, capsys):
    (tmp_path / "notes.txt").write_text("mine")
    assert cli.main(["practice", str(tmp_path)]) == 2
    assert "holds something already" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    assert cli.main(["practice", str(tmp_path / "new"), "--noise", "-1"]) == 2


def test_every_load_that_a_machine_can_be_told_is_offered():
    assert "general" not in LOADS and {"clamped_x", "biaxial", "shear"} <= set(LOADS)
