"""Real exports of each software are read as what they are. They may not be copied, so a folder of them is named."""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from hypernode.dic.folder import find_series
from hypernode.dic.points import read_points
from hypernode.dic.reading import read_series

SAMPLES = os.environ.get("HYPERNODE_SAMPLES")
pytestmark = pytest.mark.skipif(SAMPLES is None, reason="HYPERNODE_SAMPLES names no folder of real exports")
#: Folder -> dialect, unit, whether y points upward, points of each file, rows that are no point.
FACTS = {
    "davis_stereo_mm": ("davis_stereo", "mm", True, [4053, 3855], [0, 0]),
    "matchid_2023": ("matchid_2023", "mm", False, [4064, 4064], [0, 0]),
    "matchid_2024": ("matchid_2024", "mm", False, [886, 886], [0, 0]),
    "vic3d": ("vic3d", "mm", True, [3192], [1407]),
    "dice": ("dice", "pixel", False, [230, 230, 230], [0, 0, 0]),
}


def folder_of(name, tmp_path):
    """The files of a sample that are frames; beside those of DICe lies one of another series."""
    for path in (Path(SAMPLES) / name).iterdir():
        if not path.name.startswith("by_subset"):
            shutil.copyfile(path, tmp_path / path.name)
    return tmp_path


@pytest.mark.parametrize("name", FACTS)
def test_points_units_and_directions_of_real_files(tmp_path, name):
    dialect, unit, y_up, measured, left_out = FACTS[name]
    found = find_series(folder_of(name, tmp_path))
    assert (found.dialect.name, found.dialect.y_up) == (dialect, y_up)
    for path, count, others in zip(found.files.values(), measured, left_out, strict=True):
        points = read_points(path, found.dialect)
        rows = len([line for line in path.read_text("cp1252").splitlines() if line and not line.startswith("***")]) - 1
        assert (points.unit, np.isfinite(points.displacement).all(axis=1).sum()) == (unit, count)
        assert rows - count == others


@pytest.mark.parametrize("name", FACTS)
def test_real_files_become_a_series_at_rest_in_its_first_frame(tmp_path, name):
    series = read_series(folder_of(name, tmp_path))
    at_rest = series.frames[0].displacement
    assert np.nanmax(np.abs(at_rest)) < 1e-9
    assert 0.85 * FACTS[name][3][0] < np.isfinite(at_rest[..., 0]).sum() <= FACTS[name][3][0]
    assert series.out_of_plane < 0.05


def test_positions_in_the_deformed_sheet_come_back_to_the_reference():
    for name, digits in (("matchid_2023", 2e-5), ("matchid_2024", 2e-5)):
        found = find_series(Path(SAMPLES) / name)
        first, last = (read_points(path, found.dialect).position for path in found.files.values())
        distance = np.linalg.norm(first[:, None, :2] - last[None, :50, :2], axis=-1).min(axis=0)
        assert np.median(distance) < digits
