"""What a folder shows is found, what it does not show is asked for, and nothing is invented."""

import shutil

import numpy as np
import pytest

from hypernode.config.errors import ConfigError
from hypernode.dic.errors import DicError
from hypernode.inspection.folder import inspect, named_after
from tests.dic.exports import write
from tests.inspection.folders import COLUMNS, FIELDS, GIVEN, PIXEL, ROWS, SIZE, write_frames, write_record


@pytest.fixture
def folder(tmp_path):
    write_frames(tmp_path / "pull", FIELDS["clamped_y"])
    write_record(tmp_path / "pull")
    return tmp_path / "pull"


def keys(remarks):
    return [remark.key for remark in remarks]


def sentences(remarks):
    return " ".join(remark.sentence for remark in remarks)


def test_what_is_given_and_what_is_shown_are_enough(folder):
    seen = inspect(folder, GIVEN)
    assert not seen.known.missing and not seen.known.odd
    assert seen.known.guesses.keys() == {"load", "pixel_size"}
    assert seen.known.settings["load"] == "clamped_y"
    assert seen.sheet.cases[0].numbers.tolist() == [2, 3, 4]
    (course,) = seen.courses
    np.testing.assert_allclose(course.force[1:], seen.sheet.cases[0].force[1, 1])


def test_without_a_word_all_that_is_missing_is_asked_for_at_once(folder):
    seen = inspect(folder, {})
    assert keys(seen.known.missing) == ["width", "pixel_size", "frame_rate"]
    assert "width, height, thickness of the sheet in mm" in sentences(seen.known.missing)
    assert "1 to 4 fit into the 3 s of the record from 1 on" in sentences(seen.known.missing)
    assert seen.sheet is None


def test_the_pixel_is_guessed_from_the_field_across_the_pull(folder):
    seen = inspect(folder, {**GIVEN, "width": 1.02 * SIZE[0]})
    assert seen.known.settings["pixel_size"] == pytest.approx(1.02 * PIXEL)
    assert "along x" in seen.known.guesses["pixel_size"]
    along_x = inspect(folder, {**GIVEN, "width": 1.02 * SIZE[0], "load": "clamped_x"})
    assert along_x.known.settings["pixel_size"] == pytest.approx(PIXEL)


def test_a_pixel_that_differs_between_the_axes_is_asked_for(folder):
    seen = inspect(folder, {**GIVEN, "height": 1.06 * SIZE[1]})
    assert keys(seen.known.missing) == ["pixel_size"] and "0.05 and 0.053 mm a pixel" in sentences(seen.known.missing)


def test_points_beyond_the_sheet_are_odd(folder):
    seen = inspect(folder, {**GIVEN, "pixel_size": 1.2 * PIXEL})
    assert keys(seen.known.odd) == ["width"] and seen.sheet is not None


def test_another_load_than_it_looks_like_is_odd_and_used(folder):
    seen = inspect(folder, {**GIVEN, "load": "uniaxial_y"})
    assert seen.known.settings["load"] == "uniaxial_y" and "looks like clamped_y and not" in sentences(seen.known.odd)


def test_a_record_is_found_by_its_content_under_any_name(folder):
    (folder / "force_disp.csv").rename(folder / "machine 3.txt")
    (folder / "notes.txt").write_text("a sheet of rubber\n")
    seen = inspect(folder, GIVEN)
    assert seen.known.settings["force_file"] == "machine 3.txt" and seen.sheet is not None
    assert [path.name for path in seen.others] == ["notes.txt"]


def test_of_several_records_one_must_be_named(folder):
    shutil.copy(folder / "force_disp.csv", folder / "again.csv")
    seen = inspect(folder, GIVEN)
    assert keys(seen.known.missing) == ["force_file"]
    assert "again.csv of named_columns" in sentences(seen.known.missing)
    assert inspect(folder, {**GIVEN, "force_file": "again.csv"}).sheet is not None


def test_a_folder_without_forces_must_say_so(folder):
    (folder / "force_disp.csv").unlink()
    given = {key: value for key, value in GIVEN.items() if key != "frame_rate"}
    assert keys(inspect(folder, given).known.missing) == ["force_file"]
    seen = inspect(folder, {**given, "force_file": None})
    assert seen.sheet is not None and not seen.sheet.forces_known and seen.courses == ()


def test_a_record_that_is_none_is_refused_with_its_own_sentence(folder):
    (folder / "load.csv").write_text("Time,Weight\n(s),(N)\n0,1\n")
    seen = inspect(folder, {**GIVEN, "force_file": "load.csv"})
    assert "no known names of a force" in sentences(seen.known.missing)
    seen = inspect(folder, {**GIVEN, "force_file": "lod.csv"})
    assert "there is no file 'lod.csv'; the folder has force_disp.csv" in sentences(seen.known.missing)


def test_what_the_checks_of_forces_refuse_is_missing_and_still_shown(folder):
    write_record(folder, change=lambda force: -force)
    seen = inspect(folder, GIVEN)
    assert "the sign of the record or its channel is wrong" in sentences(seen.known.missing) and seen.sheet is None
    assert (seen.courses[0].force[1:] < 0.0).all()


def test_what_they_only_find_strange_is_odd(folder):
    write_record(folder, change=lambda force: force / 2500.0)
    seen = inspect(folder, GIVEN)
    assert "volts" in sentences(seen.known.odd) and seen.sheet is not None


def test_an_offset_of_the_clocks_is_told(folder):
    """A record without crosshead that begins two seconds after the frames."""
    sizes = np.linspace(0.0, 0.16, 17)
    write_frames(folder, FIELDS["clamped_y"], sizes)
    write_record(folder, sizes=(0.0, 0.0, 0.0, *sizes[1:]))
    seen = inspect(folder, GIVEN)
    assert seen.offsets[0].seconds == pytest.approx(2.0, abs=2 * seen.offsets[0].uncertainty)
    late = inspect(folder, {**GIVEN, "force_time_offset": "estimate"})
    assert late.courses[0].force[0] == pytest.approx(0.0, abs=0.1)
    as_it_is = inspect(folder, {**GIVEN, "force_time_offset": 0.0})
    assert late.courses[0].force[-1] > as_it_is.courses[0].force[-1]


def test_two_forces_of_a_biaxial_test_have_each_its_course(folder):
    write_frames(folder, FIELDS["biaxial"])
    write_record(folder, axes=(" x", " y"))
    seen = inspect(folder, GIVEN)
    assert seen.known.settings["load"] == "biaxial"
    assert [course.part for course in seen.courses] == [(0, 0), (1, 1)] and seen.sheet is not None


def test_a_biaxial_test_with_one_force_asks_which_it_is(folder):
    write_frames(folder, FIELDS["biaxial"])
    assert "force_channel: {x: ..., y: ...}" in sentences(inspect(folder, GIVEN).known.missing)


def test_frames_after_the_largest_stretch_are_odd(folder):
    write_frames(folder, FIELDS["clamped_y"], (0.0, 0.06, 0.12, 0.03))
    write_record(folder, sizes=(0.0, 0.06, 0.12, 0.03))
    assert "after frame 3 the mean stretch falls from 1.12 to 1.03" in sentences(inspect(folder, GIVEN).known.odd)


def test_frames_that_are_missing_in_between_are_listed(folder):
    (folder / "Pull0003.csv").unlink()
    write_frames(folder, FIELDS["clamped_y"], (0.12, 0.12), first=5)
    field = inspect(folder, GIVEN).field
    assert field.numbers == [1, 2, 4, 5, 6] and field.absent == [3] and field.every == 1


def test_lost_points_are_on_the_outline_or_inside(folder):
    def lose(number, rows):
        gone = {0, 1, 14, 5 * COLUMNS + 6} if number == 3 else set()
        return [row for k, row in enumerate(rows) if k not in gone]

    write_frames(folder, FIELDS["clamped_y"], change=lose)
    lost = inspect(folder, GIVEN).field.lost
    assert [(each.frame, each.outline, each.inside) for each in lost if each.points] == [(3, 3, 1)]


def test_an_outline_that_is_lost_asks_for_the_ring_that_drops_it(folder):
    def rim(number, rows):
        kept = range(2, ROWS - 2)
        return [row for k, row in enumerate(rows) if number == 1 or k // COLUMNS in kept]

    write_frames(folder, FIELDS["clamped_y"], change=rim)
    seen = inspect(folder, GIVEN)
    assert keys(seen.known.missing) == ["edge_ring"] and "edge_ring=2 leaves 9 x 8" in sentences(seen.known.missing)
    assert inspect(folder, {**GIVEN, "edge_ring": 2}).sheet is not None


def test_what_the_import_says_of_the_grid_is_noted(folder):
    def irregular(number, rows):
        rng = np.random.default_rng(7)
        cells = [row.split(";") for row in rows]
        moved = [[float(a) + d for a, d in zip(c[:2], rng.uniform(-4, 4, 2), strict=True)] + c[2:] for c in cells]
        return [";".join(map(str, each)) for each in moved]

    write_frames(folder, FIELDS["clamped_y"], change=irregular)
    notes = inspect(folder, GIVEN).field.notes
    assert len(notes) == 1 and "points lie off a grid" in notes[0]


def test_pictures_alone_must_be_correlated_first(tmp_path):
    for number in range(3):
        (tmp_path / f"picture{number}.tif").write_bytes(b"II*\0")
    record = ["SetName,Cycle,Time_S,XDisplacement_um,YDisplacement_um,XForce_mN,YForce_mN"]
    record += [f"A,{cycle},{t},{t},{t},{10 * t},{20 * t}" for cycle in ("1-Stretch", "1-Recover") for t in range(4)]
    (tmp_path / "Data.csv").write_text("\n".join(record) + "\n")
    seen = inspect(tmp_path, {})
    assert "3 pictures (picture0.tif to picture2.tif) and no displacement files" in sentences(seen.known.missing)
    (file,) = seen.files
    assert [(each.set_name, each.cycle) for each in file.cycles] == [("A", "1-Stretch"), ("A", "1-Recover")]
    np.testing.assert_allclose(file.cycles[0].record.force.max(axis=0), [0.03, 0.06])


def test_a_record_of_several_cycles_asks_which_is_the_test(folder):
    record = ["SetName,Cycle,Time_S,XDisplacement_um,YDisplacement_um,XForce_mN,YForce_mN"]
    rows = [(t, 10.0 * t) for t in np.linspace(0.0, 3.0, 31)]
    record += [f"A,{cycle},{t},0,0,{f},{f}" for cycle in ("1", "2") for t, f in rows]
    (folder / "force_disp.csv").write_text("\n".join(record) + "\n")
    seen = inspect(folder, GIVEN)
    assert keys(seen.known.missing) == ["force_cycle"] and "2 of the 2 cycles" in sentences(seen.known.missing)
    assert inspect(folder, {**GIVEN, "force_cycle": "2"}).cycle.cycle == "2"


def test_forces_in_the_frames_themselves_are_told_and_doubted(tmp_path):
    write(tmp_path, "gom_nodemap")
    seen = inspect(tmp_path, {"edge_ring": 0, "load": "uniaxial_y"})
    assert keys(seen.known.odd) == ["load", "force_file"] and "some of which say N and mean V" in sentences(
        seen.known.odd
    )
    assert seen.field.software == "GOM / ARAMIS (nodemap)" and seen.field.series.unit == "mm"
    assert "the field spans 2.5 x 2 mm" in sentences(seen.known.missing)
    np.testing.assert_allclose(seen.courses[0].force, 12.5)


def test_one_frame_is_no_test(folder):
    for number in (2, 3, 4):
        (folder / f"Pull000{number}.csv").unlink()
    assert "there is one frame" in sentences(inspect(folder, GIVEN).known.missing)


def test_a_broken_frame_is_refused_with_file_and_line(folder):
    (folder / "Pull0003.csv").write_text((folder / "Pull0002.csv").read_text().replace(";", ",", 40))
    seen = inspect(folder, GIVEN)
    assert "Pull0003.csv:" in sentences(seen.known.missing) and seen.field is None


def test_keys_and_values_are_checked_before_anything_is_read(folder):
    with pytest.raises(ConfigError, match=r"lod: unknown key; did you mean 'load'"):
        inspect(folder, {"lod": "clamped_y"})
    with pytest.raises(ConfigError, match="frame_rate = -1"):
        inspect(folder, {"frame_rate": -1.0})
    with pytest.raises(DicError, match="no such folder"):
        inspect(folder / "nowhere", {})


def test_the_name_of_a_specimen_is_that_of_its_folder_in_letters_of_names(tmp_path):
    assert named_after(tmp_path / "Probe 3 (weich)") == "Probe_3__weich_"
    assert named_after(tmp_path / "...") == "specimen"


def test_rings_that_leave_nothing_are_refused(folder):
    told = sentences(inspect(folder, {**GIVEN, "edge_ring": 6}).known.missing)
    assert "edge_ring = 6 leaves 1 x 0 of 13 x 12 points" in told and "set edge_ring to 4 at most" in told
