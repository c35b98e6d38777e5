"""The configuration that is written is the folder's: it loads, imports to the same steps, and says what is a guess."""

import numpy as np
import pytest

from hypernode.config.loading import ConfigError, load_config
from hypernode.dic.errors import DicError
from hypernode.dic.load_case import import_load_case
from hypernode.inspection.draft import write_draft
from hypernode.inspection.folder import inspect
from tests.inspection.folders import FIELDS, GIVEN, write_frames, write_record


@pytest.fixture
def folder(tmp_path):
    write_frames(tmp_path / "pull 1", FIELDS["clamped_y"])
    write_record(tmp_path / "pull 1")
    return tmp_path / "pull 1"


@pytest.mark.parametrize(
    "more",
    [{}, {"frames": [2, 4]}, {"force_file": None}, {"stretches": [1.05, 1.1], "edge_ring": 2, "force_offset": 0.5}],
)
def test_what_is_written_imports_to_the_same_load_steps(folder, tmp_path, more):
    seen = inspect(folder, {**GIVEN, **more})
    write_draft(seen, tmp_path / "out" / "pull.yaml")
    specimen = load_config(tmp_path / "out" / "pull.yaml").specimens["pull_1"]
    case, expected = import_load_case(specimen, specimen), seen.sheet.cases[0]
    assert case.numbers.tolist() == expected.numbers.tolist()
    np.testing.assert_array_equal(case.stretch, expected.stretch)
    np.testing.assert_array_equal(case.u, expected.u)
    assert case.force.keys() == expected.force.keys()
    for part, force in case.force.items():
        np.testing.assert_array_equal(force, expected.force[part])


def test_it_is_small_and_says_of_guesses_that_they_are_guesses(folder, tmp_path):
    write_draft(inspect(folder, GIVEN), tmp_path / "pull.yaml")
    lines = (tmp_path / "pull.yaml").read_text().splitlines()
    keys = [line.strip() for line in lines if not line.strip().startswith("#")]
    assert keys == [
        "specimens:",
        "pull_1:",
        f'folder: "{folder}"',
        "width: 12",
        "height: 11",
        "thickness: 1",
        "pixel_size: 0.05",
        "frame_rate: 1",
        "load: clamped_y",
    ]
    for key in ("pixel_size", "load"):
        at = next(k for k, line in enumerate(lines) if line.strip().startswith(key))
        above = " ".join(line.strip() for line in lines[:at][::-1][:2][::-1])
        assert "A guess: " in above
    assert sum("A guess" in line for line in lines) == 2


def test_what_is_missing_is_said_and_nothing_is_written(folder, tmp_path):
    given = {key: value for key, value in GIVEN.items() if key != "frame_rate"}
    with pytest.raises(DicError, match="number of frames in a second"):
        write_draft(inspect(folder, given), tmp_path / "pull.yaml")
    assert not (tmp_path / "pull.yaml").exists()


def test_a_file_that_says_something_else_stays(folder, tmp_path):
    file = tmp_path / "pull.yaml"
    write_draft(inspect(folder, GIVEN), file)
    text = file.read_text()
    write_draft(inspect(folder, GIVEN), file)
    with pytest.raises(DicError, match="says something else"):
        write_draft(inspect(folder, {**GIVEN, "thickness": 2.0}), file)
    assert file.read_text() == text


def test_a_method_is_checked_with_the_files_that_are_laid_over(folder, tmp_path):
    seen, file, over = inspect(folder, GIVEN), tmp_path / "pull.yaml", tmp_path / "more.yaml"
    over.write_text("methods:\n  mine: {extends: homogeneous, seed: 2}\n")
    with pytest.raises(ConfigError, match=r"^\S*pull\.yaml:\d+: cases\.pull_1\.methods\.0 = 'mine'"):
        write_draft(seen, file, "mine")
    assert not file.exists()
    config = write_draft(seen, file, "mine", [over])
    assert config.cases["pull_1"].methods == ["mine"] and config.methods["mine"].seed == 2
