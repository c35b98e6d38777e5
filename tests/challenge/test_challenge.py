"""Files of the challenge: what is wrong with them is said, classes follow from stiffness, scores are its own."""

import json
from dataclasses import replace

import numpy as np
import pytest

from hypernode.challenge.classes import PairOfMaterials, in_two, mean_pairs, nearest_pair, pair_of_label
from hypernode.challenge.errors import ChallengeError
from hypernode.challenge.files import challenge_test
from hypernode.challenge.scoring import dice, turned
from hypernode.cli import main

SIDE, FRAMES = 9, 6


def arrays(**changed):
    """A test whose rows run downward, with a block of class 3 in class 9, and crosshead travel of its own."""
    line = np.linspace(0.0, 39.0, SIDE)
    X = np.stack(np.meshgrid(line, -line), axis=-1)
    t = np.linspace(0.0, 1.0, FRAMES)
    label = np.full((SIDE, SIDE), 9)
    label[1:4, 2:5] = 3
    held = {
        "DIC_X": X,
        "DIC_disp": t[:, None, None, None] * 0.1 * X * [0.0, 1.0],
        "instron_disp": 4.2 * t,
        "instron_force": 10.0 * t,
        "label": label,
    }
    return {name: value for name, value in (held | changed).items() if value is not None}


def test_the_score_is_the_mean_of_dice_over_classes_in_either_map():
    label, predicted = np.array([[8, 8, 0, 0]]), np.array([[8, 8, 8, 3]])
    # Class 8: 2 of (2 + 3); class 0: 0 of 2; class 3: 0 of 1.
    assert dice(label, predicted) == pytest.approx((2 * 2 / 5 + 0.0 + 0.0) / 3)
    assert dice(label, label) == 1.0


@pytest.mark.parametrize(
    "turn, name", [(0, "turned up-down"), (1, "turned left-right"), (None, "turned by half a turn")]
)
def test_a_label_that_is_turned_is_found_and_said(turn, name):
    label = arrays()["label"]
    assert turned(np.flip(label, turn), label, down=0) == name
    assert turned(label, label, down=0) == ""


def test_a_shape_that_is_nearly_its_own_mirror_image_is_still_seen_to_lie_upside_down():
    """A bar with a foot on one side: 12 of 400 points tell, which the score hardly shows."""
    label = np.zeros((20, 20), int)
    label[3:17, 8:12], label[3, 2:8], label[3, 12:18] = 1, 1, 1
    found = label.copy()
    found[3, 2:4] = 0
    assert dice(label, found) - dice(label[::-1], found) < 0.1
    assert turned(label[::-1], found, down=0) == "turned up-down"
    assert turned(label, found, down=0) == ""
    found[3, 2:8] = 0
    assert turned(label, found, down=0) == ""


def test_axes_of_arrays_follow_from_the_positions():
    assert challenge_test(arrays(), "a.npz").down == 0
    swapped = {k: np.swapaxes(v, *((1, 2) if k == "DIC_disp" else (0, 1))) for k, v in arrays().items() if v.ndim > 1}
    assert challenge_test(arrays(**swapped), "a.npz").down == 1


def test_millimetres_of_the_crosshead_are_found_and_become_those_of_the_sheet():
    assert not challenge_test(arrays(), "a.npz").remarks
    found = challenge_test(arrays(instron_disp=3.9 * np.linspace(0.0, 1.0, FRAMES)), "a.npz")
    assert "crosshead's way, 3.9 mm" in found.remarks[0]
    assert np.ptp(found.X[..., 0]) == pytest.approx(40.0)
    assert np.abs(found.u).max() == pytest.approx(3.9 * 40.0 / 39.0)


def test_a_lost_point_hides_no_scale():
    held = arrays(instron_disp=3.9 * np.linspace(0.0, 1.0, FRAMES))
    held["DIC_disp"][2, 4, 4] = np.nan
    assert "crosshead's way, 3.9 mm" in challenge_test(held, "a.npz").remarks[0]


def test_frames_after_the_sheet_has_torn_are_left_out():
    found = challenge_test(arrays(instron_force=np.array([0.0, 2.0, 4.0, 6.0, 3.0, 1.0])), "a.npz")
    assert len(found.u) == len(found.force) == 4 and "2 frames" in found.remarks[0]


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"DIC_X": None}, "no array DIC_X"),
        ({"DIC_X": np.zeros((81, 2))}, "3 axes are expected"),
        ({"instron_force": np.zeros(FRAMES + 1)}, r"instron_force has the shape \(7,\)"),
        ({"label": np.zeros((SIDE, SIDE - 1))}, "label has the shape"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_by_name(changed, reason):
    with pytest.raises(ChallengeError, match=reason):
        challenge_test(arrays(**changed), "a.npz")


def test_classes_are_those_of_the_pair_whose_stiffnesses_are_alike():
    pairs = [PairOfMaterials(8, 0, 0.1, 0.2), PairOfMaterials(9, 3, 0.1, 0.4), PairOfMaterials(8, 4, 0.1, 0.9)]
    assert nearest_pair(pairs, (0.11, 0.37)) == pairs[1]
    assert nearest_pair(pairs, (0.09, 0.8)) == pairs[2]


def test_a_labelled_sheet_tells_which_material_is_how_stiff_and_several_tell_their_mean():
    label = arrays()["label"]
    told = pair_of_label(label, (label == 3).astype(int), (0.1, 0.4), "a.npz")
    assert told == PairOfMaterials(9, 3, 0.1, 0.4)
    (mean,) = mean_pairs([told, replace(told, stiff_stress=0.1)])
    assert mean.stiff_stress == pytest.approx(0.2) and mean.soft_stress == pytest.approx(0.1)
    with pytest.raises(ChallengeError, match="mostly where the label is 9"):
        pair_of_label(np.full_like(label, 9), (label == 3).astype(int), (0.1, 0.4), "a.npz")


def test_several_materials_are_cut_in_two_by_stiffness():
    stiffer, (soft, stiff) = in_two(np.log([1.0, 1.1, 1.1, 1.2, 3.0, 3.0]))
    assert stiffer.tolist() == [0, 0, 0, 0, 1, 1]
    assert soft == pytest.approx(1.1) and stiff == pytest.approx(3.0)
    with pytest.raises(ChallengeError, match="equally stiff"):
        in_two(np.zeros(5))


@pytest.mark.parametrize(
    "options, reason",
    [
        (["a.npz", "b.npz", "--output", "c.npz"], "names one file"),
        (["a.npz", "--learn", "classes.json"], "is there already"),
        (["a.npz", "--classes", "classes.json"], "--learn writes"),
        (["b.npz"], "no array DIC_disp"),
    ],
)
def test_the_command_says_what_cannot_be(tmp_path, monkeypatch, capsys, options, reason):
    monkeypatch.chdir(tmp_path)
    np.savez("a.npz", **arrays())
    np.savez("b.npz", DIC_X=arrays()["DIC_X"])
    (tmp_path / "classes.json").write_text("{}")
    assert main(["challenge", *options]) == 2
    assert reason in capsys.readouterr().err


@pytest.mark.slow
def test_a_virtual_test_is_labelled_point_by_point_and_its_classes_are_told(tmp_path, monkeypatch, capsys):
    from benchmarks import challenge_sheets as sheets

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sheets, "POINTS", 21)
    sheets.make(200, (8, 4), False, tmp_path / "a.npz")
    assert main(["challenge", "a.npz", "--learn", "classes.json"]) == 0
    (pair,) = json.loads((tmp_path / "classes.json").read_text())["pairs"]
    assert (pair["soft"], pair["stiff"]) == (8, 4)
    assert pair["stiff_stress"] / pair["soft_stress"] == pytest.approx(5.0, rel=0.2)
    with np.load("a_predicted.npz") as written, np.load("a.npz") as test:
        assert dice(test["label"] == 4, written["predicted_label"] == 1) > 0.9
    assert "of the shape alone" in capsys.readouterr().out
