"""A sheet that nears the camera is asked about where held ends or frames at rest tell it, and a key takes it out."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.dic.camera_growth import without_growth
from hypernode.dic.errors import DicError
from hypernode.dic.series import Frame, Series
from hypernode.inspection.folder import inspect
from tests.dic.pulls import LINES, NOISE, STEP, fields, write
from tests.inspection.test_situations import SIZE, force_at, record, said_of

GIVEN = {**SIZE, "frame_rate": 1.0}
CENTRED = np.stack(np.meshgrid(LINES - 6.0, LINES - 6.0), axis=-1)
#: Frames at rest after the first, of a test that rests.
RESTS = 3


def nearer(frames, growth):
    """Frames whose picture is larger by a share of its own."""
    return [u + growth(k) * (CENTRED + u) for k, u in enumerate(frames)]


def free(count=12, rests=RESTS, across=-0.4, seed=7):
    """A pull whose ends are free across, after frames at rest."""
    rng = np.random.default_rng(seed)
    sizes = STEP * np.maximum(np.arange(count) - rests, 0)
    return [e * CENTRED * [across, 1.0] + (k > 0) * rng.normal(0.0, NOISE, CENTRED.shape) for k, e in enumerate(sizes)]


def recorded(folder, rests=0):
    record(
        folder,
        header="Time (s),Force (N)",
        row=lambda t, way, f: f"{t:.3f},{f:.6f}",
        time=np.round(np.arange(0.0, 11.05, 0.1), 9),
        elongation=lambda t: STEP * max(t - rests, 0.0),
    )
    return folder


def deformed_as(found, frames):
    """Displacements are those of the sheet, but for a shift and noise."""
    case = found.sheet.cases[0]
    cut = (13 - len(case.x)) // 2
    for number, u in zip(case.numbers, case.u, strict=True):
        off = u - frames[number][cut : 13 - cut, cut : 13 - cut]
        assert np.abs(off - off.mean(axis=(0, 1))).max() < 5.0 * NOISE


@pytest.mark.parametrize("growth", [lambda k: 0.003 * k, lambda k: 0.01 * (k > 0)], ids=["steadily", "at once"])
def test_held_ends_that_get_longer_are_asked_about_and_their_growth_is_taken_out(tmp_path, growth):
    folder = recorded(write(tmp_path / "pull", nearer(fields(11), growth)))
    assert "--set camera_growth=ends" in said_of(inspect(folder, GIVEN))
    found = inspect(folder, {**GIVEN, "camera_growth": "ends"})
    assert not said_of(found)
    deformed_as(found, fields(11))
    assert "camera_growth" not in said_of(inspect(folder, {**GIVEN, "camera_growth": 0.0}))


@pytest.mark.parametrize("across", [-0.4, 0.6], ids=["along y", "along both"])
def test_a_sheet_that_is_larger_at_rest_is_asked_about_and_its_growth_is_taken_out(tmp_path, across):
    sheet = free(across=across)
    folder = recorded(write(tmp_path / "pull", nearer(sheet, lambda k: 0.01 * (k > 0))), RESTS)
    given = {**GIVEN, **({"load": "general", "force_channel": {"y": "Force (N)"}} if across > 0.0 else {})}
    advised = re.search(r"--set camera_growth=([0-9.]+) takes", said_of(inspect(folder, given)))
    assert float(advised[1]) == pytest.approx(0.01, rel=0.05)
    found = inspect(folder, {**given, "camera_growth": 0.01})
    assert "camera_growth" not in said_of(found)
    deformed_as(found, sheet)


@pytest.mark.parametrize("seed", range(4))
def test_right_sheets_are_not_asked_about(tmp_path, seed):
    resting = recorded(write(tmp_path / "rest", free(seed=seed)), RESTS)
    held = recorded(write(tmp_path / "held", fields(11, seed=seed)))
    for folder in (resting, held):
        assert not said_of(inspect(folder, GIVEN))


def test_a_sheet_that_is_stretched_before_it_pulls_is_not_taken_for_a_nearer_one(tmp_path):
    slack = [u + (k > 0) * 0.01 * CENTRED * [0.0, 1.0] for k, u in enumerate(free())]
    folder = recorded(write(tmp_path / "slack", slack), RESTS)
    assert "camera_growth" not in said_of(inspect(folder, GIVEN))


def test_ends_that_are_free_tell_no_growth(tmp_path):
    folder = recorded(write(tmp_path / "pull", free(rests=0)))
    found = inspect(folder, {**GIVEN, "camera_growth": "ends"})
    assert found.sheet is None and "no ends that are held across" in said_of(found)


def test_a_frame_without_ends_is_named_where_they_tell_the_growth():
    frames = [Frame(k, u) for k, u in enumerate(fields(3))]
    frames[2].displacement[[0, -1]] = np.nan
    test = SimpleNamespace(camera_growth="ends", load="clamped_y", folder="pull")
    with pytest.raises(DicError, match="either end is measured in frame 2"):
        without_growth(test, Series(LINES, LINES, frames, unit="mm"))


def test_the_force_of_a_right_sheet_is_kept(tmp_path):
    folder = recorded(write(tmp_path / "pull", nearer(fields(11), lambda k: 0.003 * k)))
    case = inspect(folder, {**GIVEN, "camera_growth": "ends"}).sheet.cases[0]
    np.testing.assert_allclose(case.force[1, 1], force_at(STEP * case.numbers), rtol=5e-3)
    np.testing.assert_allclose(case.stretch, 1.0 + STEP * case.numbers, atol=1e-3)
