"""Sheets of a population are dealt out to jobs so that an addition changes few of them."""

import copy

from hypernode.config.loading import check_config
from hypernode.config.slices import from_slice
from hypernode.pipeline.populations import planned_populations, sheet_settings
from tests.config.test_populations import config_with


def plan(**keys):
    return planned_populations(check_config(config_with(**{"batch": 2} | keys)))["many"]


def settings(planned):
    return {batch: planned.settings(batch) for batch in planned.batches}


def test_a_job_has_sheets_of_one_group_and_every_sheet_has_one_job():
    planned = plan()
    sheets = [name for batch in planned.batches.values() for name in batch]
    assert sheets == list(planned.config.cases)
    assert [len(batch) for batch in planned.batches.values()] == [2, 1, 2, 1]
    assert [folder.rpartition("/")[2] for folder in planned.folders] == list(planned.batches)


def test_one_more_seed_changes_the_last_job_of_each_group_and_one_more_shape_changes_none():
    before = settings(plan())
    more_seeds = settings(plan(seeds=4))
    assert [batch for batch in before if before[batch] != more_seeds[batch]] == [
        b for b in before if b.endswith(".0001")
    ]
    fewer_shapes = settings(plan(geometry=["disc"]))
    assert fewer_shapes == {batch: before[batch] for batch in fewer_shapes}


def test_what_a_job_is_given_makes_each_sheet_as_the_whole_configuration_would():
    planned = plan()
    batch, names = next(iter(planned.batches.items()))
    given = from_slice(copy.deepcopy(planned.settings(batch)))
    assert list(given.cases) == names
    for name in names:
        alone = sheet_settings(given, name)
        assert alone == sheet_settings(planned.config, name)
        assert list(alone["noise"]) == [planned.config.cases[name].noise], "a record has no other sheet's noise"


def test_a_job_of_more_sheets_declares_more_time_and_no_more_memory():
    one, three = plan(batch=1, cells=[40, 40]), plan(batch=3, cells=[40, 40])
    first = next(iter(one.batches))
    assert three.runtime(first, 1) > one.runtime(first, 1) and three.memory(first, 1) == one.memory(first, 1)
    assert one.memory(first, 2) == 2 * one.memory(first, 1)


def test_twenty_sheets_declare_a_quarter_more_memory_and_twice_the_time_that_was_measured():
    raw = config_with(seeds=20, batch=20, cells=[24, 24])
    raw["loads"]["pull"]["stretches"] = [1.05, 1.1, 1.15]
    planned = planned_populations(check_config(raw))["many"]
    first = next(iter(planned.batches))
    assert planned.memory(first, 1) >= 1.25 * 680
    assert planned.runtime(first, 1) >= 2 * 518 / 60
