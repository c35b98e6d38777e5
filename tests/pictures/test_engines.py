"""Engines of correlation on a speckle of known stretch; tests of engines that are not here are left out."""

import numpy as np
import pytest

from hypernode.config.correlation import Correlation
from hypernode.config.pictures import Pictures
from hypernode.pictures.correlation import Correlated, correlate, python_of
from hypernode.pictures.errors import EngineMissing, PictureError
from hypernode.pictures.photograph import recorded
from hypernode.pictures.speckle import Pattern, sprayed
from tests.pictures.warped import pattern, stretched, warped

SIDE = 420
STRETCHES = (0.07, 0.14, 0.20)
MASK = np.zeros((SIDE, SIDE), bool)
MASK[40:-40, 40:-40] = True


def engine(name):
    """Settings of an engine that is here."""
    try:
        python_of(name)
    except EngineMissing as error:
        pytest.skip(str(error))
    return {"engine": name, "subset": 25, "step": 16}


@pytest.fixture(scope="module")
def pictures():
    grey = pattern(SIDE)
    return np.stack([warped(grey, stretched(SIDE, most)) for most in (0.0, *STRETCHES)])


@pytest.fixture(scope="module")
def followed(pictures):
    """name -> points, each engine asked once."""
    found = {}

    def by(name):
        if name not in found:
            found[name] = correlate(pictures, MASK, Correlation(**engine(name)))
        return found[name]

    return by


def error(found, frame):
    truth = stretched(SIDE, STRETCHES[frame - 1])(found.column.astype(float), found.row.astype(float))
    return found.displacement[frame] - np.stack(truth, axis=-1)


@pytest.mark.parametrize("name", ["pyvale", "al_dic"])
def test_a_known_stretch_is_followed_to_three_hundredths_of_a_pixel(name, followed):
    found = followed(name)
    for frame in range(1, len(STRETCHES) + 1):
        wrong = error(found, frame)
        assert np.isfinite(wrong).all(-1).mean() > 0.95
        assert np.sqrt(np.nanmean(wrong**2, axis=0)).max() < 0.03
        assert np.nanmedian(found.correlation[frame]) > 0.99
    assert (found.displacement[0] == 0.0).all()


@pytest.mark.parametrize("name", ["pyvale", "al_dic"])
def test_pictures_compared_one_after_the_other_add_up(name, pictures):
    found = correlate(pictures, MASK, Correlation(**engine(name), incremental=True))
    assert np.sqrt(np.nanmean(error(found, len(STRETCHES)) ** 2, axis=0)).max() < 0.03


def test_discs_on_a_sheet_that_grows_by_a_quarter_are_not_taken_for_others():
    pictures = Pictures(pixels=SIDE)
    discs = Pattern.of(sprayed((SIDE, SIDE), pictures.speckle), (SIDE, SIDE))
    row, column = np.mgrid[:SIDE, :SIDE].astype(float)
    taken = []
    for frame, factor in enumerate((1.0, 1.25)):
        X = np.stack([column.ravel(), row.ravel()], axis=1)
        light = discs.at(SIDE / 2 + (X - SIDE / 2) / factor).reshape(SIDE, SIDE)
        taken.append(recorded(pictures.dark + (pictures.bright - pictures.dark) * light, pictures, frame))
    # So far from the edge that its corners stay within the picture.
    mask = np.zeros_like(MASK)
    mask[60:-60, 60:-60] = True
    found = correlate(np.stack(taken), mask, Correlation(**engine("al_dic") | {"subset": 21, "step": 8}))
    wrong = found.displacement[-1] - 0.25 * (np.stack([found.column, found.row], axis=1) - SIDE / 2)
    assert np.isfinite(wrong).all(-1).mean() > 0.95
    assert np.sqrt(np.nanmean(wrong**2, axis=0)).max() < 0.03


def test_both_engines_see_the_same(followed):
    one, other = followed("pyvale"), followed("al_dic")
    place = {pixel: k for k, pixel in enumerate(zip(other.column, other.row, strict=True))}
    both = [(k, place[pixel]) for k, pixel in enumerate(zip(one.column, one.row, strict=True)) if pixel in place]
    assert len(both) > 0.8 * len(one.column)
    mine, theirs = np.array(both).T
    apart = one.displacement[:, mine] - other.displacement[:, theirs]
    assert np.sqrt(np.nanmean(apart**2)) < 0.03


def test_points_lie_on_the_grid_within_the_mask_and_survive_storage(followed):
    found = followed("pyvale")
    assert set(np.diff(np.unique(found.column))) == set(np.diff(np.unique(found.row))) == {found.step}
    assert MASK[found.row, found.column].all()
    again = Correlated.from_dataset(found.to_dataset())
    assert np.array_equal(again.displacement, found.displacement, equal_nan=True)
    assert np.array_equal(again.column, found.column) and again.step == found.step


@pytest.mark.parametrize("name", ["pyvale", "al_dic"])
def test_a_point_whose_texture_is_gone_is_lost_and_said_so(name, pictures):
    blank = pictures[:2].copy()
    # In the middle, where the first subset would be compared.
    blank[1, 180:240, 180:240] = 128
    found = correlate(blank, MASK, Correlation(**engine(name)))
    gone = (abs(found.column - 210) < 15) & (abs(found.row - 210) < 15)
    assert np.isnan(found.displacement[1, gone]).all() and np.isnan(found.correlation[1, gone]).all()
    assert np.isfinite(found.displacement[1, ~gone]).mean() > 0.9


@pytest.mark.parametrize("name", ["pyvale", "al_dic"])
def test_a_point_that_leaves_the_picture_is_lost(name, pictures):
    found = correlate(pictures[::3], np.ones_like(MASK), Correlation(**engine(name)))
    there = found.column + stretched(SIDE, STRETCHES[-1])(found.column.astype(float), found.row.astype(float))[0]
    out = (there < 0) | (there > SIDE - 1)
    assert out.sum() > 20 and np.isnan(found.displacement[1, out]).all()


@pytest.mark.parametrize(("name", "target"), [("pyvale", "pyvale-env"), ("al_dic", "al-dic-env")])
def test_an_engine_that_is_not_here_names_the_target_that_makes_it(name, target, monkeypatch, tmp_path):
    variable = {"pyvale": "HYPERNODE_PYVALE", "al_dic": "HYPERNODE_AL_DIC"}[name]
    monkeypatch.setenv(variable, str(tmp_path / "python"))
    with pytest.raises(EngineMissing, match=f"make {target}") as caught:
        correlate(np.zeros((2, 200, 200), np.uint8), np.ones((200, 200), bool), Correlation(engine=name))
    assert "\n" not in str(caught.value) and str(tmp_path) in str(caught.value)


def test_an_engine_that_fails_is_quoted(monkeypatch, tmp_path):
    fake = tmp_path / "python"
    fake.write_text("#!/bin/sh\necho 'no licence for this' >&2\nexit 3\n")
    fake.chmod(0o755)
    monkeypatch.setenv("HYPERNODE_PYVALE", str(fake))
    with pytest.raises(PictureError, match="code 3: no licence for this"):
        correlate(np.zeros((2, 200, 200), np.uint8), np.ones((200, 200), bool), Correlation())


@pytest.mark.parametrize(
    ("pictures", "mask", "said"),
    [
        (np.zeros((1, 200, 200), np.uint8), np.ones((200, 200), bool), "two or more"),
        (np.zeros((2, 200, 200)), np.ones((200, 200), bool), "float64"),
        (np.zeros((2, 200, 200), np.uint8), np.ones((200, 190), bool), "190"),
        (np.zeros((2, 100, 200), np.uint8), np.ones((100, 200), bool), "reach = 64"),
        (np.zeros((2, 200, 200), np.uint8), np.zeros((200, 200), bool), "no pixel"),
    ],
)
def test_pictures_that_cannot_be_compared_are_refused(pictures, mask, said, monkeypatch, tmp_path):
    (tmp_path / "python").touch()
    monkeypatch.setenv("HYPERNODE_PYVALE", str(tmp_path / "python"))
    with pytest.raises(PictureError, match=said):
        correlate(pictures, mask, Correlation())
