"""Magnitudes that make another plausible material are said, with the key that mends them; right ones are not.

A sheet of 12 x 12 mm whose narrowing is that of rubber, in files that the tests write themselves.
"""

import numpy as np
import pytest

from hypernode.dic.forces.growth import check_growth, check_pace
from hypernode.dic.narrowing import scale_of
from hypernode.inspection.folder import inspect
from hypernode.inspection.report import report
from tests.dic.pulls import LINES, NOISE, write

GIVEN = {"width": 12.0, "height": 12.0, "thickness": 1.0, "frame_rate": 1.0}
#: Elongation of a frame, one a second.
PACE = 0.025
FRAMES = 8
END = float(FRAMES)


def force_at(elongation):
    stretch = 1.0 + np.asarray(elongation)
    return 3.0 * (stretch - stretch**-2.0)


def narrowed(elongation, poisson=0.4):
    """Displacement (row, column, 2): along y the elongation, across it what a Hencky Poisson ratio makes."""
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    # Ends are held across.
    share = np.clip(4.0 * (y / 12.0) * (1.0 - y / 12.0), 0.0, 1.0) ** 0.25
    return np.stack([((1.0 + elongation) ** -poisson - 1.0) * share * (x - 6.0), elongation * y], axis=-1)


def pull(folder, factor=1.0, crosshead=False, pace=PACE, end=END, held=False, force=1.0):
    """Frames whose displacements are times a factor, and a record until its end, pulled on or held after the frames."""
    rng = np.random.default_rng(4)
    frames = [narrowed(pace * k) + (k > 0) * rng.normal(0.0, NOISE, (13, 13, 2)) for k in range(FRAMES + 1)]
    write(folder, [factor * each for each in frames])
    time = np.arange(0.0, end + 0.05, 0.1)
    elongation = pace * (np.minimum(time, END) if held else time)
    columns = (
        [time, 12.0 * elongation, force * force_at(elongation)] if crosshead else [time, force * force_at(elongation)]
    )
    names = "Time (s),Displacement (mm),Force (N)" if crosshead else "Time (s),Force (N)"
    rows = [",".join(f"{each:.7f}" for each in row) for row in zip(*columns, strict=True)]
    (folder / "force_disp.csv").write_text("\n".join([names, *rows]) + "\n")
    return folder


def said(found):
    return "\n".join(each.sentence for each in (*found.known.odd, *found.known.missing))


def right(found, pace=PACE):
    case = found.sheet.cases[0]
    np.testing.assert_allclose(case.force[1, 1], force_at(pace * case.numbers), rtol=2e-3)
    np.testing.assert_allclose(case.stretch, 1.0 + pace * case.numbers, atol=1e-3)
    return True


@pytest.mark.parametrize("crosshead", [True, False])
def test_a_right_sheet_passes_without_a_word(tmp_path, crosshead):
    found = inspect(pull(tmp_path / "pull", crosshead=crosshead), GIVEN)
    assert not said(found) and right(found)


@pytest.mark.parametrize(("factor", "mends", "pace"), [(0.1, 10.0, PACE), (10.0, 0.1, PACE), (0.01, 100.0, 0.1)])
def test_displacements_in_another_unit_are_told_by_how_the_sheet_narrows(tmp_path, factor, mends, pace):
    folder = pull(tmp_path / "pull", factor, pace=pace)
    assert f"--set displacement_factor={mends:g} multiplies them" in said(inspect(folder, GIVEN))
    found = inspect(folder, {**GIVEN, "displacement_factor": mends})
    assert not said(found) and right(found, pace)
    assert "displacement_factor" not in said(inspect(folder, {**GIVEN, "displacement_factor": 1.0}))


def test_a_crosshead_names_the_factor_that_mends_displacements(tmp_path):
    folder = pull(tmp_path / "pull", 0.1, crosshead=True)
    found = inspect(folder, GIVEN)
    assert found.sheet is None and "--set displacement_factor=10 where" in said(found)
    assert right(inspect(folder, {**GIVEN, "displacement_factor": 10.0}))


def test_displacements_of_a_thousandth_are_doubted_even_where_the_load_is_given(tmp_path):
    folder = pull(tmp_path / "pull", 1e-3)
    assert "another unit than positions, displacement_factor" in said(inspect(folder, {**GIVEN, "load": "clamped_y"}))


@pytest.mark.parametrize("poisson", [0.2, 0.35, 0.5])
@pytest.mark.parametrize("largest", [0.02, 0.2, 1.0, 3.0])
def test_no_sheet_of_a_constant_poisson_ratio_is_taken_for_another_unit(poisson, largest):
    rng = np.random.default_rng(1)
    e = np.linspace(0.0, largest, 12)
    scale = scale_of(e, 1.0 - (1.0 + e) ** -poisson + rng.normal(0.0, 1e-4, 12))
    assert scale is None or (not scale.wrong and scale.factor == pytest.approx(1.0, abs=4.0 * scale.uncertainty + 1e-6))


@pytest.mark.parametrize(
    "narrowing", [lambda e: 0.3 * e + 2.0 * e**2, lambda e: 0.5 * e - 0.5 * e**2, lambda e: 0.05 * e]
)
def test_fibres_that_turn_bonds_that_break_and_held_sides_are_no_other_unit(narrowing):
    e = np.linspace(0.0, 0.3, 12)
    scale = scale_of(e, narrowing(e))
    assert scale is None or not scale.wrong


def test_a_force_in_another_unit_is_multiplied_and_the_report_says_how(tmp_path):
    folder = pull(tmp_path / "pull", force=1.0 / 9.80665)
    assert "--set force_factor=9.80665" in " ".join("\n".join(report(inspect(folder, GIVEN))).split())
    assert right(inspect(folder, {**GIVEN, "force_factor": 9.80665}))


@pytest.mark.parametrize(("force", "mends"), [(1e3, "force_factor=0.001"), (1e-3, "force_factor=1000")])
def test_a_force_that_no_sheet_gives_names_the_factor(tmp_path, force, mends):
    assert mends in said(inspect(pull(tmp_path / "pull", force=force), GIVEN))


@pytest.mark.parametrize("crosshead", [True, False])
@pytest.mark.parametrize(("rate", "held"), [(3.0, False), (3.0, True), (1.0 / 3.0, True)])
def test_a_frame_rate_that_is_off_by_three_is_said(tmp_path, rate, held, crosshead):
    folder = pull(tmp_path / "pull", crosshead=crosshead, end=30.0 if held else END, held=held)
    assert "frame_rate" in said(inspect(folder, {**GIVEN, "frame_rate": rate}))


def test_a_machine_that_pulls_on_at_one_pace_shows_a_wrong_frame_rate_by_its_crosshead(tmp_path):
    folder = pull(tmp_path / "pull", crosshead=True, end=30.0)
    slower = inspect(folder, {**GIVEN, "frame_rate": 1.0 / 3.0})
    assert "frames may be taken at another pace, --frame-rate" in said(slower)
    assert not said(inspect(folder, GIVEN))


def test_a_field_within_a_longer_sheet_may_move_less_than_the_crosshead(tmp_path):
    folder = pull(tmp_path / "pull", crosshead=True)
    text = (folder / "force_disp.csv").read_text().splitlines()
    rows = [row.split(",") for row in text[1:]]
    moved = [",".join([t, f"{5.0 * float(way):.6f}", f]) for t, way, f in rows]
    (folder / "force_disp.csv").write_text("\n".join([text[0], *moved]) + "\n")
    assert "the crosshead moves" not in said(inspect(folder, {**GIVEN, "height": 24.0}))


def test_a_sheet_that_relaxes_at_first_is_no_early_force_where_the_crosshead_agrees(tmp_path):
    for crosshead in (True, False):
        folder = pull(tmp_path / f"pull{crosshead}", crosshead=crosshead)
        text = (folder / "force_disp.csv").read_text().splitlines()
        rows = [row.split(",") for row in text[1:]]
        early = [[*row[:-1], f"{float(row[-1]) + 0.2 * (1.0 - np.exp(-8.0 * float(row[0]))):.7f}"] for row in rows]
        (folder / "force_disp.csv").write_text("\n".join([text[0], *map(",".join, early)]) + "\n")
        assert ("frames earlier than the stretch" in said(inspect(folder, GIVEN))) == (not crosshead)


LAWS = {
    "rubber to thrice its length": (3.0, lambda s: s - s**-2.0),
    "one that relaxes": (1.2, lambda s: (s - s**-2.0) * (1.0 + 0.6 * np.exp(-40.0 * (s - 1.0)))),
    "skin": (1.2, lambda s: np.expm1(25.0 * (s - 1.0))),
    "one that loses half of its stiffness": (1.5, lambda s: (s - s**-2.0) * (1.0 - 0.5 * (s - 1.0))),
}


@pytest.mark.parametrize("name", LAWS)
def test_the_force_of_a_sheet_goes_on_to_the_end(name):
    largest, law = LAWS[name]
    stretch = np.linspace(1.0, largest, 13)
    assert check_growth(stretch, law(stretch)) == []


def test_a_force_that_stands_while_the_sheet_is_pulled_on_is_said():
    stretch = np.linspace(1.0, 1.2, 13)
    (finding,) = check_growth(stretch, np.minimum(stretch - 1.0, 0.12) + 1e-4 * np.sin(np.arange(13.0)))
    assert not finding.refused and "check frame_rate" in finding.sentence


@pytest.mark.parametrize("dropped", [1, 2, 5])
def test_pictures_that_the_camera_dropped_are_told_by_the_curve(dropped):
    taken = np.append(np.arange(6.0), np.arange(6.0, 12.0) + dropped)
    stretch = 1.0 + 0.01 * taken + np.random.default_rng(0).normal(0.0, 2e-5, 12)
    (finding,) = check_pace(stretch, force_at(0.01 * np.arange(12.0)), np.arange(12))
    assert "between frames 5 and 6" in finding.sentence and f"dropped {dropped} pictures" in finding.sentence


def test_one_reading_of_the_force_that_is_off_is_no_missing_picture():
    stretch = 1.0 + 0.01 * np.arange(25.0)
    for at in range(8, 24):
        force = force_at(0.01 * np.arange(25.0))
        force[at] -= 0.32 * (force[at] - force[at - 1])
        assert check_pace(stretch, force, np.arange(25)) == []


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_no_curve_of_a_sheet_skips_pictures(name, noise):
    largest, law = LAWS[name]
    stretch = np.linspace(1.0, largest, 13)
    force = law(stretch) + noise * law(largest) * np.random.default_rng(2).standard_normal(13)
    assert check_pace(stretch, force, np.arange(13)) == []
