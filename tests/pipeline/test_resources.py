"""What jobs declare of a machine covers what they were measured to take, and grows with their sheet."""

import copy
import re
from pathlib import Path

import pytest

from hypernode.config.loading import check_config
from hypernode.pipeline.resources import NEEDS, Size, case_size, memory, runtime
from tests.config.test_config import BASE

ROOT = Path(__file__).resolve().parents[2]

#: (rule, cells, load steps, peak memory [MB], wall time [s]): the most that jobs on one core were seen to take.
MEASURED = [
    ("true_material", 14400, 4, 266, 14),
    ("forward", 14400, 4, 571, 24),
    ("forward", 160000, 1, 2940, 26),
    ("measurement", 2500, 15, 169, 5),
    ("constrained", 2500, 4, 800, 38),
    ("constrained", 1600, 5, 962, 55),
    ("constrained", 2500, 15, 1409, 167),
    ("constrained", 10000, 4, 2900, 212),
    ("constrained", 40000, 4, 10300, 1080),
    ("constrained", 14400, 4, 2986, 730),
    ("gradient", 10000, 4, 117, 2),
    ("interpolant", 10000, 4, 439, 66),
    ("homogenised", 2500, 4, 636, 62),
    ("initialisation", 10000, 4, 385, 35),
    ("pretraining", 2500, 4, 761, 55),
    ("baseline", 10000, 4, 406, 8),
    ("evaluation", 2500, 5, 501, 14),
    ("validation", 2500, 5, 566, 8),
    ("references", 1600, 5, 584, 23),
    ("training", 2500, 4, 670, 68),
    ("training", 10000, 5, 667, 101),
    ("training", 40000, 5, 1140, 467),
    ("import_dic", 1600, 5, 303, 8),
    ("speckle", 2401, 4, 106, 2),
    ("photograph", 2401, 4, 250, 13),
    ("correlate", 2401, 4, 530, 10),
    ("photographed", 2401, 4, 197, 3),
    ("figure", 0, 0, 476, 9),
    ("table", 0, 0, 84, 5),
    ("explorer", 2500, 5, 765, 17),
]


@pytest.mark.parametrize(("rule", "cells", "steps", "megabytes", "seconds"), MEASURED)
def test_a_job_declares_at_least_a_quarter_more_memory_and_twice_the_time_that_was_measured(
    rule, cells, steps, megabytes, seconds
):
    size = Size(cells, steps)
    assert NEEDS[rule].megabytes(size) >= 1.25 * megabytes
    assert NEEDS[rule].runtime(size) >= 2 * seconds / 60


@pytest.mark.parametrize("rule", NEEDS)
def test_needs_grow_with_cells_load_steps_and_attempts(rule):
    need = NEEDS[rule]
    for of in (need.megabytes, need.runtime):
        sizes = [Size(0, 0), Size(2500, 4), Size(2500, 15), Size(10000, 15), Size(40000, 15)]
        values = [of(size) for size in sizes]
        assert values == sorted(values) and values[0] > 0
        assert all(of(size, attempt=2) >= 1.9 * value for size, value in zip(sizes, values, strict=True))


def test_every_rule_has_its_needs_and_no_need_is_without_its_rule():
    rules = {
        rule for file in ROOT.glob("workflow/rules/*.smk") for rule in re.findall(r"(?m)^rule (\w+):", file.read_text())
    }
    assert rules == set(NEEDS)


def test_the_size_of_a_sheet_is_its_finest_grid_and_all_its_load_steps():
    raw = copy.deepcopy(BASE)
    raw["loads"]["more"] = {"kind": "uniaxial_x", "stretches": [1.1, 1.2]}
    raw["cases"]["a"] |= {"loads": ["pull", "more"], "cells": [20, 10], "camera": {"cells": [30, 20]}}
    assert case_size(check_config(raw), "a") == Size(600, 3)


def test_the_size_of_a_specimen_is_that_of_its_frames(tmp_path):
    specimen = {"folder": str(tmp_path), "width": 1, "height": 1, "thickness": 1, "pixel_size": 1, "frame_rate": 1}
    raw = copy.deepcopy(BASE)
    raw["specimens"] = {"s": specimen | {"frames": [2, 3]}}
    raw["cases"] = {"real": {"specimen": "s", "methods": ["m"]}}
    for number in (1, 2, 3):
        (tmp_path / f"B{number:04d}.csv").write_text("x,y,u,v\n" * 900)
    (tmp_path / "force_disp.csv").write_text("Time,Force\n0,0\n")
    assert case_size(check_config(raw), "real") == Size(900, 2)


def test_a_rule_declares_by_the_case_of_its_job_and_a_table_has_none():
    config = check_config(copy.deepcopy(BASE))
    job, table = {"case": "a", "method": "m"}, {"table": "summary"}
    size = case_size(config, "a")
    assert memory(config, "constrained")(job, attempt=1) == NEEDS["constrained"].megabytes(size)
    assert runtime(config, "constrained")(job, attempt=2) == NEEDS["constrained"].runtime(size, attempt=2)
    assert memory(config, "table")(table, attempt=1) == NEEDS["table"].megabytes(Size(0, 0))
