"""A force that no sheet gives is refused with a sentence that says why; what a sheet may give passes."""

import json

import numpy as np
import pytest

from hypernode.dic.errors import DicError
from hypernode.dic.forces.checks import check_end, check_jumps, check_reach, check_rise, check_units
from hypernode.dic.forces.clock import agreed_offset, check_clock, estimate_offsets
from hypernode.dic.forces.magnitude import check_stiffness
from hypernode.stages import import_dic
from hypernode.storage.netcdf import read
from tests.dic.test_davis import config as specimen_config
from tests.dic.test_davis import write_frame

#: Pace of the pull [1/s] and length of the sheet [mm].
PACE, LENGTH = 0.01, 10.0
TIME = np.arange(0.0, 30.0, 0.05)
#: A pull that begins after two seconds and relaxes, as printed sheets do; the first frame is at rest.
STRETCH = 1.0 + PACE * np.clip(TIME - 2.0, 0.0, None)


def relaxing(stretch):
    elastic = stretch - stretch**-2
    return 60.0 * elastic * (1.0 + 0.6 * np.exp(-40.0 * (stretch - 1.0)))


def stiffening(stretch):
    return 0.05 * np.expm1(25.0 * (stretch - 1.0))


FORCE = relaxing(STRETCH)
FRAMES = np.arange(0.0, 18.0, 0.8)


def clock(shift=0.0, force=FORCE, displacement=True, begin=-np.inf):
    """What is told of a record whose clock is ahead by a shift."""
    time = TIME + shift
    keep = time >= begin
    moved = LENGTH * (STRETCH - 1.0)[keep] if displacement else None
    return estimate_offsets(FRAMES, np.interp(FRAMES, TIME, STRETCH), time[keep], force[keep], moved)


@pytest.mark.parametrize("displacement", [True, False])
@pytest.mark.parametrize("shift", [-2.0, 0.0, 2.0])
def test_the_offset_of_a_clock_is_found_within_its_uncertainty(shift, displacement):
    for offset in clock(shift, displacement=displacement):
        assert abs(offset.seconds - shift) < 2.0 * offset.uncertainty < 1.0
        assert bool(check_clock([offset], 0.2, accepted=False)) == (shift != 0.0)


def test_an_offset_that_the_configuration_gives_is_only_a_warning():
    assert all(finding.refused for finding in check_clock(clock(2.0), 0.2, accepted=False))
    assert not any(finding.refused for finding in check_clock(clock(2.0), 0.2, accepted=True))


def test_a_record_that_begins_under_way_is_told_by_its_force():
    """Its crosshead shows one pace only, so that it agrees with the pictures at no offset at all."""
    offsets = clock(-4.0, begin=0.0)
    assert [bool(check_clock([each], 0.2, accepted=False)) for each in offsets][-1]
    assert agreed_offset(offsets) is None


def test_the_toe_of_a_stiffening_sheet_is_no_offset():
    assert clock(0.0, stiffening(STRETCH), displacement=False) == []


def test_the_crosshead_of_another_test_is_warned_of():
    displacement = LENGTH * np.abs(np.sin(1.7 * TIME))
    offsets = estimate_offsets(FRAMES, np.interp(FRAMES, TIME, STRETCH), TIME, FORCE, displacement)
    findings = check_clock(offsets[:1], 0.2, accepted=False)
    assert [f.refused for f in findings] == [False] and "unlike the sheet" in findings[0].sentence


def test_a_record_that_pulls_at_other_times_than_the_frames_names_them():
    late = np.where(TIME < 15.0, 0.0, FORCE)
    (finding,) = check_reach(np.linspace(0.0, 4.0, 9), TIME, late)
    assert finding.refused and "from 0 to 4 s" in finding.sentence and "first_frame_time" in finding.sentence
    assert check_reach(FRAMES, TIME, FORCE) == check_reach(np.linspace(0.0, 4.0, 9), TIME, FORCE) == []


def test_a_force_that_grows_on_after_the_last_frame_is_warned_of():
    (finding,) = check_end(8.0, TIME, FORCE)
    assert not finding.refused and "a frame_rate that is too large" in finding.sentence
    assert check_end(28.0, TIME, FORCE) == check_end(30.0, TIME, FORCE) == []
    assert check_end(8.0, TIME, np.where(TIME < 8.0, FORCE, FORCE[-1] * 0.1)) == []


def test_a_crosshead_at_rest_while_the_frames_are_taken_tells_no_clock():
    displacement = LENGTH * np.clip(TIME - 15.0, 0.0, None)
    frames = np.linspace(0.0, 4.0, 9)
    assert estimate_offsets(frames, 1.0 + 0.02 * frames, TIME, 0.0 * TIME, displacement) == []


@pytest.mark.parametrize(
    ("force", "why"),
    [
        (-relaxing(np.linspace(1.0, 1.15, 9)), "the sign of the record or its channel is wrong"),
        (relaxing(np.linspace(1.0, 1.15, 9))[::-1], "the force falls"),
        (np.full(9, 5.0), "the force stays between 5 and 5 N"),
        (5.0 + 0.01 * np.arange(9), "force_offset"),
        (np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0]), "does not follow the stretch"),
    ],
)
def test_a_force_that_does_not_rise_with_the_stretch_is_refused(force, why):
    (finding,) = check_rise(np.linspace(1.0, 1.15, 9), force)
    assert finding.refused and why in finding.sentence


@pytest.mark.parametrize("law", [relaxing, stiffening])
def test_sheets_that_relax_or_stiffen_pass_every_check(law):
    rng = np.random.default_rng(0)
    force = law(STRETCH) + 0.005 * rng.standard_normal(len(TIME))
    frames = np.interp(FRAMES, TIME, force)
    stretch = np.interp(FRAMES, TIME, STRETCH)
    assert check_rise(stretch, frames) == check_units(TIME, force) == []
    assert check_stiffness(stretch[-8::2], frames[-8::2], 20.0, np.arange(4)) == []


@pytest.mark.parametrize("factor", [10.0, 1000.0])
@pytest.mark.parametrize("first", [True, False])
def test_a_unit_that_changes_within_a_record_is_refused(factor, first):
    half = len(TIME) // 2
    changed = FORCE * np.where((np.arange(len(TIME)) < half) == first, factor, 1.0)
    (finding,) = check_units(TIME, changed)
    assert finding.refused and f"a factor of {factor:g} between two samples" in finding.sentence


def test_a_sheet_that_breaks_is_no_change_of_unit():
    assert check_units(TIME, np.where(TIME < 20.0, FORCE, 0.003 * FORCE)) == []


def test_a_record_in_volts_is_warned_of_by_the_stiffness_it_gives():
    stretch = np.array([1.05, 1.08, 1.11])
    assert check_stiffness(stretch, relaxing(stretch), 80.0, np.arange(3)) == []
    (finding,) = check_stiffness(stretch, relaxing(stretch) / 250.0, 80.0, np.arange(3))
    assert not finding.refused and "volts" in finding.sentence


@pytest.mark.parametrize(("factor", "refused"), [(5.0, []), (50.0, [False]), (1000.0, [True])])
def test_how_much_a_sheet_stiffens_is_judged_beyond_the_first_step(factor, refused):
    stretch = np.array([1.02, 1.05, 1.10, 1.15])
    force = 80.0 * (stretch - 1.0) * np.array([1e-4, 1.0, 1.0, factor])
    assert [finding.refused for finding in check_stiffness(stretch, force, 80.0, np.arange(4))] == refused


# The whole way, from a folder to the file.


def folder_of(tmp_path, change=lambda time, moved, force: (time, moved, force)):
    """Frames of a pull, four a second, and its record after a change."""
    for number in range(1, 49):
        write_frame(tmp_path, number, float(np.interp((number - 1) / 4.0, TIME, STRETCH)))
    rows = zip(*change(TIME, LENGTH * (STRETCH - 1.0), FORCE), strict=True)
    text = "".join(f"{t!r},{d!r},{f!r}\n" for t, d, f in ((float(a), float(b), float(c)) for a, b, c in rows))
    (tmp_path / "force_disp.csv").write_text("Time,Displacement,Force\n(s),(mm),(N)\n" + text)
    return tmp_path


def imported(tmp_path, **changes):
    chosen = {"frames": None, "stretches": [1.04, 1.06, 1.08], "frame_rate": 4.0, "relaxation": False, **changes}
    settings = specimen_config(tmp_path, **chosen)
    import_dic.run(settings, "c", str(tmp_path / "out.nc"), {})
    return read(tmp_path / "out.nc")


def test_a_sound_record_has_no_finding(tmp_path):
    data = imported(folder_of(tmp_path))
    assert json.loads(data.attrs["force_findings"]) == []


CHANGES = {
    "reversed": (lambda t, d, f: (t, d, -f), "sign of the record"),
    "constant": (lambda t, d, f: (t, d, 0.0 * f + 5.0), "the force stays between"),
    "times 1000": (lambda t, d, f: (t, d, np.where(t > 9.0, 1000.0, 1.0) * f), "a factor of 1000 between two samples"),
    "two seconds late": (lambda t, d, f: (t + 2.0, d, f), "off that of the pictures by \\+2 s"),
    "two seconds early": (lambda t, d, f: (t - 2.0, d, f), "off that of the pictures by -2 s"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_record_that_cannot_be_is_refused_with_its_reason_and_leaves_no_file(tmp_path, name):
    change, why = CHANGES[name]
    with pytest.raises(DicError, match=why) as found:
        imported(folder_of(tmp_path, change))
    assert "force_disp.csv" in str(found.value) and not (tmp_path / "out.nc").exists()


#: A zero that is off by so much of the largest force.
OFF = 0.08 * FORCE.max()


@pytest.mark.parametrize("off", [OFF, -OFF])
def test_a_zero_that_is_off_is_asked_for(tmp_path, off):
    with pytest.raises(DicError, match=rf"is it the zero of the load cell, --set force_offset={off:.3g}"):
        imported(folder_of(tmp_path, lambda t, d, f: (t, d, f + off)))


def test_a_zero_that_is_given_wrongly_is_asked_for(tmp_path):
    """The curve of force and stretch does not go through the origin then."""
    force = 40.0 * (STRETCH - STRETCH**-2)
    off = 0.08 * float(np.interp(1.08, STRETCH, force))
    with pytest.raises(DicError, match="a zero of the load cell that is off looks the same, and force_offset takes it"):
        imported(folder_of(tmp_path, lambda t, d, f: (t, d, force)), force_offset=-off)


def test_a_record_in_volts_is_said_and_stored(tmp_path, capsys):
    data = imported(folder_of(tmp_path, lambda t, d, f: (t, d, f / 2500.0)))
    assert "volts" in json.loads(data.attrs["force_findings"])[0]
    assert "warning: force_disp.csv: a stiffness of" in capsys.readouterr().err


def test_an_estimated_offset_is_used_and_said_with_its_uncertainty(tmp_path):
    sound = imported(folder_of(tmp_path))["edge_force"].values
    (tmp_path / "out.nc").unlink()
    late = folder_of(tmp_path, CHANGES["two seconds late"][0])
    data = imported(late, force_time_offset="estimate")
    np.testing.assert_allclose(data["edge_force"].values[:, 3, 1], sound[:, 3, 1], rtol=0.05)
    assert "+2 s, uncertain by" in json.loads(data.attrs["force_findings"])[0]
    (tmp_path / "out.nc").unlink()
    np.testing.assert_array_equal(imported(late, force_time_offset=2.0)["edge_force"], sound)


def test_the_configuration_takes_seconds_or_estimate_only(tmp_path):
    keys = specimen_config(tmp_path, force_time_offset=2).specimens["s"]
    assert keys.force_time_offset == 2.0
    with pytest.raises(ValueError, match="force_time_offset"):
        specimen_config(tmp_path, force_time_offset="guess")


def ramp(change=lambda time, force: force):
    time = np.linspace(0.0, 10.0, 101)
    return time, change(time, 0.3 * np.maximum(time - 1.0, 0.0) ** 0.8)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t, f: f, False),
        (lambda t, f: np.round(f, 1), False),
        (lambda t, f: f[10 * (np.arange(101) // 10)], False),
        (lambda t, f: f + np.random.default_rng(1).normal(0.0, 0.05, 101), False),
        (lambda t, f: np.minimum(f, 1.2), False),
        (lambda t, f: np.where(np.arange(101) == 50, 4.0 * f, f), True),
        (lambda t, f: f - 0.3 * (t > 5.05), True),
    ],
    ids=["smooth", "coarse", "in steps", "noisy", "clipped", "a spike", "a zero set anew"],
)
def test_a_jump_that_stands_alone_is_said_and_no_noise_steps_or_limits(change, said):
    assert bool(check_jumps(*ramp(change))) == said


def test_what_a_force_grows_by_in_a_gap_is_no_jump():
    time, force = ramp()
    kept = (time < 4.0) | (time > 7.0)
    assert check_jumps(time[kept], force[kept]) == []
