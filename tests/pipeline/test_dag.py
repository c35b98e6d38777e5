"""Methods that differ only in later stages share the files of the earlier ones."""

import copy

from hypernode.config.loading import check_config
from hypernode.pipeline.dag import (
    field_inputs,
    only_pretrained,
    previous_input,
    run_benchmarks,
    run_stages,
    stage_file,
)
from tests.config.test_config import BASE


def config_with(**others):
    """The base configuration whose case also has methods that change the first one."""
    raw = copy.deepcopy(BASE)
    for name, change in others.items():
        raw["methods"][name] = {**raw["methods"]["m"], **change} if "baseline" not in change else change
    raw["cases"]["a"]["methods"] = ["m", *others]
    return check_config(raw)


def test_a_stage_is_shared_until_the_first_setting_that_differs():
    config = config_with(longer={"training": {"iterations": 9}}, wider={"node": {"terms": ["I1"], "hidden": [5]}})
    assert stage_file(config, "a", "longer", "pretrained") == "results/a/m/pretrained.nc"
    assert stage_file(config, "a", "longer", "material") == "results/a/longer/material.nc"
    assert stage_file(config, "a", "wider", "interpolant") == "results/a/m/interpolant.nc"
    assert stage_file(config, "a", "wider", "homogenised") == "results/a/wider/homogenised.nc"


def test_a_stage_without_iterations_is_left_out():
    idle = {"iterations": 0}
    config = config_with(short={"training": idle}, shorter={"training": idle, "initialisation": idle})
    assert only_pretrained(config, "short") and not only_pretrained(config, "m")
    assert previous_input(config, "a", "m", "material") == {"previous": "results/a/m/pretrained.nc"}
    assert previous_input(config, "a", "short", "pretrained") == {"previous": "results/a/m/initialised.nc"}
    assert previous_input(config, "a", "shorter", "pretrained") == {}
    assert stage_file(config, "a", "shorter", "pretrained") == "results/a/shorter/material.nc"
    config = config_with(untaught={"pretraining": idle})
    assert previous_input(config, "a", "untaught", "material") == {"previous": "results/a/m/initialised.nc"}


def test_a_polished_network_goes_on_from_the_pretrained_one_that_other_methods_share():
    idle = {"iterations": 0}
    taught = {"constrained": {"iterations": 3}, "training": idle}
    config = config_with(taught=taught, polished={**taught, "polish": {"iterations": 3}})
    assert only_pretrained(config, "taught") and not only_pretrained(config, "polished")
    assert previous_input(config, "a", "polished", "material") == {"previous": "results/a/taught/material.nc"}
    alone = config_with(polished={**taught, "polish": {"iterations": 3}})
    assert previous_input(alone, "a", "polished", "material") == {"previous": "results/a/polished/pretrained.nc"}
    assert run_stages(alone, "polished")[-2:] == ["pretrained", "material"]
    assert run_benchmarks(alone, "a", "polished")[-2].endswith("polished/polish.jsonl")


def test_another_seed_or_another_equilibrium_field_shares_nothing_that_depends_on_it():
    config = config_with(other={"seed": 5}, constrained={"constrained": {"iterations": 3}})
    assert stage_file(config, "a", "other", "gradient") == "results/a/m/gradient.nc"
    assert stage_file(config, "a", "other", "interpolant") == "results/a/other/interpolant.nc"
    assert stage_file(config, "a", "constrained", "gradient") == "results/a/constrained/gradient.nc"


def test_a_baseline_reads_the_gradient_of_the_measurement():
    config = config_with(plain={"baseline": "homogeneous"})
    files = field_inputs(config, "a", "plain", "measurement", "field", "constrained")
    assert files == {"measurement": "results/a/measurement.nc", "field": "results/a/m/gradient.nc"}
