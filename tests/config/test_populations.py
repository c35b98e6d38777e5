"""A population is one product of lists, checked as such and expanded into sheets that differ in their seed as well."""

import copy

import pytest

from hypernode.config.loading import ConfigError, check_config
from hypernode.config.populations import group_of, population_config
from tests.config.test_config import BASE

POPULATION = {
    "name": "{geometry}_{matrix}_{noise}",
    "geometry": ["disc", "plain"],
    "inclusion": "stiff",
    "matrix": "soft",
    "noise": "low",
    "seeds": 3,
    "loads": ["pull"],
}


def config_with(**keys):
    raw = copy.deepcopy(BASE)
    raw["cases"] = {}
    raw["populations"] = {"many": POPULATION | keys}
    return raw


def test_every_sheet_has_a_seed_of_its_own_and_all_else_of_its_noise():
    whole = check_config(config_with())
    config = population_config(whole, "many")
    assert list(config.cases) == [f"{shape}_soft_low-{k:04d}" for shape in ("disc", "plain") for k in range(3)]
    assert [config.noise[case.noise].seed for case in config.cases.values()] == [0, 1, 2, 0, 1, 2]
    assert {each.sigma for each in config.noise.values()} == {whole.noise["low"].sigma}
    assert {group_of(case) for case in config.cases.values()} == {("disc", "stiff", "soft"), ("plain", "stiff", "soft")}
    assert whole.cases == {} and "field" in whole.methods


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"matrix": ["soft", "sofd"]}, "no such entry in materials"),
        ({"methods": ["m"]}, "no method of a constrained field alone"),
        ({"inclusion": None}, "need an inclusion"),
        ({"name": "{geometry}"}, "twice"),
        ({"name": "{geometry} {noise}"}, "no valid case name"),
        ({"batch": 0}, "greater than or equal to 1"),
    ],
)
def test_what_no_sheet_could_be_made_of_is_refused_with_its_key(keys, said):
    with pytest.raises(ConfigError, match=said) as refused:
        check_config(config_with(**keys))
    assert "populations.many" in str(refused.value)
