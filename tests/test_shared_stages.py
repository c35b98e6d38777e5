"""Methods that differ only in later stages share the files of the earlier ones."""

import copy

from hypernode.config_loader import check_config
from hypernode.workflow import field_inputs, stage_file
from tests.test_config import BASE


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


def test_another_seed_or_another_equilibrium_field_shares_nothing_that_depends_on_it():
    config = config_with(other={"seed": 5}, constrained={"constrained": {"iterations": 3}})
    assert stage_file(config, "a", "other", "gradient") == "results/a/m/gradient.nc"
    assert stage_file(config, "a", "other", "interpolant") == "results/a/other/interpolant.nc"
    assert stage_file(config, "a", "constrained", "gradient") == "results/a/constrained/gradient.nc"


def test_a_baseline_reads_the_gradient_of_the_measurement():
    config = config_with(plain={"baseline": "homogeneous"})
    files = field_inputs(config, "a", "plain", "measurement", "field", "constrained")
    assert files == {"measurement": "results/a/measurement.nc", "field": "results/a/m/gradient.nc"}
