"""Faults of records as people bring them: each is read aright, named, or asked for, and none passes in silence."""

import re

import numpy as np
import pytest

from hypernode.inspection.folder import inspect
from hypernode.inspection.report import report
from tests.inspection.folders import FIELDS, GIVEN, write_frames

#: Elongation of every frame, a second apart, and of every sample.
SIZES = tuple(0.025 * k for k in range(9))
TIME = np.linspace(0.0, 8.0, 81)
#: Height of the sheet [mm].
HEIGHT = GIVEN["height"]


def force_at(elongation):
    stretch = 1.0 + np.asarray(elongation)
    return 3.0 * (stretch - stretch**-3.0)


def seen(folder, header, rows, sizes=SIZES, **given):
    write_frames(folder, FIELDS["clamped_y"], sizes, first=0)
    (folder / "force_disp.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return inspect(folder, {**GIVEN, **given})


def plain(folder, time=TIME, force=None, crosshead=True, sizes=SIZES, **given):
    elongation = np.interp(time, np.arange(len(sizes)), sizes)
    force = force_at(elongation) if force is None else force
    columns = [time, HEIGHT * elongation, force] if crosshead else [time, force]
    names = ["Time (s)", "Displacement (mm)", "Force (N)"] if crosshead else ["Time (s)", "Force (N)"]
    rows = [",".join(f"{each:.5f}" for each in row) for row in zip(*columns, strict=True)]
    return seen(folder, ",".join(names), rows, sizes, **given)


def steps(found, sizes=SIZES):
    """The frames used, once each has the force of its elongation."""
    assert found.sheet is not None, [each.sentence for each in found.known.missing]
    case = found.sheet.cases[0]
    np.testing.assert_allclose(case.force[1, 1], force_at(np.array(sizes)[case.numbers]), rtol=1e-3, atol=1e-4)
    return case.numbers.tolist()


def said(found):
    return "\n".join(each.sentence for each in (*found.known.odd, *found.known.missing))


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "pull"


def test_a_sound_record_is_read_without_a_word(folder):
    found = plain(folder)
    assert steps(found)[-1] == 8 and not said(found)


def test_frames_in_a_gap_are_named_and_not_used(folder):
    time = TIME[(TIME <= 2.05) | (TIME >= 5.95)]
    found = plain(folder, time, crosshead=False)
    assert not {3, 4, 5} & set(steps(found))
    assert "no sample from 2 to 6 s" in said(found) and "(3, 4, 5)" in said(found)


@pytest.mark.parametrize("crosshead", [True, False])
def test_a_load_cell_at_its_limit_is_named_and_not_used(folder, crosshead):
    force = force_at(0.025 * TIME)
    found = plain(folder, force=np.minimum(force, 0.8 * force[-1]), crosshead=crosshead)
    assert max(steps(found)) < 7
    assert "the load cell is at its limit" in said(found)


def test_a_value_that_stands_in_between_is_no_force(folder):
    force = force_at(0.025 * TIME)
    stuck = np.where((TIME > 2.05) & (TIME < 5.05), force[20], force)
    found = plain(folder, force=stuck)
    assert not {3, 4, 5} & set(steps(found))
    assert "the force stands at" in said(found)


def test_a_coarse_load_cell_stands_for_a_step_only(folder):
    found = plain(folder, force=np.round(force_at(0.025 * TIME), 2))
    assert found.sheet is not None and not said(found)


def test_a_record_that_ends_with_the_last_frame_is_enough(folder):
    found = plain(folder, TIME[:-1] * 8.0 / 7.9 - 1e-9)
    assert steps(found)[-1] == 8


def test_a_zero_that_is_not_zero_is_asked_for(folder):
    force = force_at(0.025 * TIME) + 0.1
    assert "--set force_offset=0.1" in said(plain(folder, force=force))
    assert steps(plain(folder, force=force, force_offset=0.1))[-1] == 8


@pytest.mark.parametrize(("factor", "told"), [(0.1, "(10)"), (0.01, "(100)"), (1.0 / 25.4, "(25.4)")])
def test_a_sheet_that_moves_a_tenth_of_its_machine_is_refused(folder, factor, told):
    force = force_at(0.025 * TIME)
    rows = [f"{t:.5f},{HEIGHT * 0.025 * t / factor:.5f},{f:.5f}" for t, f in zip(TIME, force, strict=True)]
    found = seen(folder, "Time (s),Displacement (mm),Force (N)", rows)
    assert found.sheet is None and told in said(found) and "--set crosshead=false" in said(found)
    assert inspect(folder, {**GIVEN, "crosshead": False}).sheet is not None


@pytest.mark.parametrize(("factor", "told"), [(1.0, ""), (1.0 / 9.80665, "kilograms"), (1e3, "(1000)"), (1.1, "")])
def test_a_force_in_another_unit_than_the_stress_beside_it_is_said(folder, factor, told):
    force, area = force_at(0.025 * TIME), GIVEN["width"] * GIVEN["thickness"]
    rows = [f"{t:.5f},{factor * f:.7f},{f / area:.7f}" for t, f in zip(TIME, force, strict=True)]
    found = seen(folder, "Time (s),Force (N),Stress (MPa)", rows)
    assert found.sheet is not None
    assert (told in said(found) and "divides its force" in said(found)) if told else not said(found)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_a_thousandth_and_a_thousandfold_of_the_force_are_of_no_known_sheet(folder, factor):
    force = factor * force_at(0.025 * TIME)
    rows = [f"{t:.5f},{f:.9f}" for t, f in zip(TIME, force, strict=True)]
    assert "is that of no sheet" in said(seen(folder, "Time (s),Force (N)", rows))


def test_every_report_says_the_stiffness_that_a_force_gives(folder):
    (line,) = [each for each in report(plain(folder)) if each.startswith("stiffness")]
    low, high = (float(each) for each in re.search(r"one: (\S+) to (\S+) MPa", line).groups())
    stretch = 1.0 + np.array(SIZES[1:])
    secant = force_at(stretch - 1.0) / (GIVEN["width"] * GIVEN["thickness"] * (stretch - 1.0))
    assert secant.min() * 0.9 < low <= high < secant.max() * 1.1


def test_of_several_loadings_the_last_is_used_or_that_which_is_named(folder):
    sizes = (*SIZES[::2], *SIZES[-3::-2], *SIZES[2::2])
    found = plain(folder, np.linspace(0.0, len(sizes) - 1.0, 121), sizes=sizes)
    assert min(steps(found, sizes)) > 8
    assert "the sheet is pulled 2 times" in said(found)
    assert max(steps(plain(folder, np.linspace(0.0, 12.0, 121), sizes=sizes, loading=1), sizes)) == 4
    assert "pulled 2 times" in said(plain(folder, np.linspace(0.0, 12.0, 121), sizes=sizes, loading=3))


#: Header of a table, and what it says of a sample: its number, time [s], crosshead [mm] and force [N].
TABLES = {
    "wavematrix": (
        '"Gesamtzeit (s)";"Gesamtzyklen";"Position des Aktuators(X:Position) (mm)";"Last(X:Kraft) (kN)";',
        lambda k, t, d, f: f"{t:.2f};1;{d - 24.64:.6f};{f / 1e3:.9f};".replace(".", ","),
    ),
    "univert": (
        "SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N",
        lambda k, t, d, f: f"Ramp,1-Stretch,{t:.2f},20,{d:.5f},{f:.5f}",
    ),
    "clock": (
        "Time (s),Displacement (mm),Force (N)",
        lambda k, t, d, f: (
            f"{(23 + (t >= 3)) % 24:02d}:{(59 + (t >= 3)) % 60:02d}:{(57 + t) % 60:05.2f},{d:.5f},{f:.5f}"
        ),
    ),
    "french": ("Temps [s];Traverse [mm];Effort [N]", lambda k, t, d, f: f"{t:.2f};{d:.5f};{f:.5f}"),
    "kilograms": ("Time [s],Load [kgf]", lambda k, t, d, f: f"{t:.2f},{f / 9.80665:.7f}"),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_of_other_machines_are_read(folder, name):
    header, row = TABLES[name]
    elongation = 0.025 * TIME
    rows = [row(k, t, HEIGHT * e, force_at(e)) for k, (t, e) in enumerate(zip(TIME, elongation, strict=True))]
    found = seen(folder, header, rows)
    assert steps(found)[-1] == 8 and not said(found)


def test_columns_of_any_names_are_named_by_keys(folder):
    rows = [f"{t:.2f},{force_at(0.025 * t):.5f}" for t in TIME]
    assert "--set time_channel=NAME" in said(seen(folder, "Instant [s],Pull [N]", rows, force_file="force_disp.csv"))
    given = {"force_file": "force_disp.csv", "time_channel": "Instant", "force_channel": "Pull"}
    assert steps(seen(folder, "Instant [s],Pull [N]", rows, **given))[-1] == 8


#: Times of the pictures, which no frame rate tells.
IRREGULAR = (0.0, 0.5, 1.7, 2.1, 4.6, 5.0, 6.9, 7.2, 8.0)


@pytest.mark.parametrize("counting", [False, True])
def test_a_column_of_pictures_tells_when_they_were_taken(folder, counting):
    """It names the picture of a sample, or counts pictures and stands until the next."""
    sizes, rows = [0.025 * t for t in IRREGULAR], []
    for t in TIME:
        taken = [n for n, at in enumerate(IRREGULAR) if abs(at - t) < 0.01]
        number = int(np.searchsorted(IRREGULAR, t + 0.01)) - 1 if counting else taken[0] if taken else ""
        rows.append(f"{t:.2f},{force_at(0.025 * t):.5f},{number}")
    found = seen(folder, "Time (s),Force (N),Image", rows, sizes)
    assert steps(found, sizes)[-1] == 8


def test_pictures_that_are_counted_from_one_are_those_of_frames_from_zero(folder):
    rows = [f"Image_{k + 1:04d}_0.tiff;{k:.3f};{force_at(e):.5f}" for k, e in enumerate(SIZES)]
    found = seen(folder, "File;TimeStamp;Force [N]", rows)
    assert steps(found)[-1] == 8 and "picture_shift=1" in said(found)
    found = seen(folder, "File;TimeStamp;Force [N]", rows[:-1])
    assert found.sheet is None and "--set picture_shift=N" in said(found)
    assert steps(seen(folder, "File;TimeStamp;Force [N]", rows[:-1], picture_shift=1, frames=[2, 4, 7]))[-1] == 7


def late(seconds):
    return np.where(seconds < TIME, force_at(0.025 * np.maximum(TIME - seconds, 0.0)), 0.0)


@pytest.mark.parametrize("seconds", [0.3, 1.0])
def test_a_force_that_is_late_against_its_crosshead_is_said_with_the_lag(folder, seconds):
    found = plain(folder, force=late(seconds))
    told = float(re.search(r"--set force_time_offset=([0-9.]+) takes", said(found))[1])
    assert told == pytest.approx(seconds, abs=0.06)
    assert steps(plain(folder, force=late(seconds), force_time_offset=seconds, frames=[2, 4, 6]))


@pytest.mark.parametrize("seconds", [0.3, 1.0, 2.2])
def test_a_record_that_stands_while_the_sheet_is_stretched_is_read_later(folder, seconds):
    found = plain(folder, force=late(seconds), crosshead=False)
    told = float(re.search(r"forces are read ([0-9.]+) s later", said(found))[1])
    assert told == pytest.approx(seconds, abs=0.06)
    case = found.sheet.cases[0]
    wrong = np.abs(case.force[1, 1] / force_at(np.array(SIZES)[case.numbers]) - 1.0)
    assert (wrong <= 2.0 * case.pairing).all() and (case.pairing < 0.05).all()
    # A configuration that is stored names every key.
    assert case.test.first_frame_time == 0.0
    assert "forces are read" in said(plain(folder, force=late(seconds), crosshead=False, first_frame_time=0.0))
    confirmed = float(re.search(r"--set force_time_offset=([0-9.]+) says", said(found))[1])
    for offset in (0, confirmed):
        assert "read" not in said(plain(folder, force=late(seconds), crosshead=False, force_time_offset=offset))


@pytest.mark.parametrize("elongation", [0.01, 0.03])
def test_a_sheet_that_is_stretched_in_its_first_picture_has_the_forces_of_one_from_rest(folder, elongation):
    preloaded = force_at(0.025 * TIME + elongation)
    case = plain(folder, force=preloaded, crosshead=False, force_offset=0).sheet.cases[0]
    true = force_at(np.array(SIZES)[case.numbers])
    as_recorded, wrong = preloaded[10 * case.numbers] / true - 1.0, np.abs(case.force[1, 1] / true - 1.0)
    assert (wrong < 0.2 * as_recorded).all() and (wrong <= 2.0 * case.pairing).all()
    assert case.preload == pytest.approx(elongation, rel=0.2)


@pytest.mark.parametrize("seconds", [0.0, 0.05, -0.05])
def test_uncertain_pairing_covers_what_a_small_lag_makes_of_the_force(folder, seconds):
    shifted = force_at(0.025 * np.maximum(TIME - seconds, 0.0))
    case = plain(folder, force=shifted, crosshead=False).sheet.cases[0]
    true = force_at(np.array(SIZES)[case.numbers])
    wrong = np.abs(case.force[1, 1] / true - 1.0)
    assert (wrong < 2.0 * case.pairing).all() and (case.pairing < 0.05).all()
    assert case.pairing[0] > case.pairing[-1] > 0.0


def test_a_pairing_that_nothing_tells_is_uncertain_by_a_frame(folder):
    sizes = SIZES[::3]
    case = plain(folder, np.linspace(0.0, 2.0, 41), sizes=sizes, crosshead=False).sheet.cases[0]
    slope = (force_at(sizes[2]) - force_at(sizes[1])) / force_at(sizes[2])
    assert case.pairing[-1] == pytest.approx(slope / np.sqrt(12.0), rel=0.05)


@pytest.mark.parametrize("law", [lambda e: np.expm1(20.0 * e), lambda e: e**2, lambda e: np.tanh(e / 0.02)])
@pytest.mark.parametrize("offset", [None, 0.0])
def test_a_sheet_that_stiffens_or_yields_at_once_is_no_lag_of_clocks(folder, law, offset):
    found = plain(folder, force=0.5 * law(0.025 * TIME), crosshead=False, force_offset=offset)
    assert "the force begins" not in said(found) and "forces are read" not in said(found)
