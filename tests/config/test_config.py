"""A wrong configuration is refused with key, value, line and a way out; a right one is expanded."""

import copy
from pathlib import Path

import pytest
import yaml

from hypernode.config.loading import ConfigError, check_config, load_config
from hypernode.config.slices import from_slice, slice_for

ROOT = Path(__file__).resolve().parents[2]

OPTIMISER = {"iterations": 1}
NETWORK = {"features": 2, "frequency_scale": 1.0, "widths": [2]}
BASE = {
    "geometries": {"disc": {"shape": "disc", "radius": 0.2}, "plain": {"shape": "uniform"}},
    "materials": {"soft": {"model": "neo_hookean", "mu": 1.0}, "stiff": {"model": "neo_hookean", "mu": 2.0}},
    "loads": {"pull": {"kind": "equibiaxial", "stretches": [1.1]}},
    "noise": {"low": {"sigma": 1e-4}, "high": {"sigma": 1e-3}},
    "methods": {
        "m": {
            "interpolant": {**NETWORK, **OPTIMISER}, "node": {"terms": ["I1"], "hidden": [2]}, "hypernetwork": NETWORK,
            **{stage: OPTIMISER for stage in ("homogenised", "initialisation", "pretraining", "training")},
        }
    },
    "cases": {"a": {"geometry": "disc", "inclusion": "stiff", "matrix": "soft", "loads": ["pull"], "methods": ["m"]}},
}  # fmt: skip


def changed(path, value):
    config = copy.deepcopy(BASE)
    target = config
    for part in path[:-1]:
        target = target.setdefault(part, {})
    if value is None:
        del target[path[-1]]
    else:
        target[path[-1]] = value
    return config


def test_a_valid_configuration_passes():
    assert check_config(copy.deepcopy(BASE)).cases["a"].cells == (50, 50)


BROKEN = [
    (("geometrie",), {}, r"geometrie: unknown key; did you mean 'geometries'"),
    (("geometries", "disc", "radus"), 0.2, r"geometries\.disc\.radus: unknown key; did you mean 'radius'"),
    (("geometries", "disc", "radius"), -1, r"geometries\.disc\.radius = -1: input should be greater than 0"),
    (("geometries", "disc", "shape"), "disk", r"did you mean 'disc'"),
    (("geometries", "disc"), {"shape": "image", "path": "no.png"}, r"geometries\.disc\.path = 'no.png': no such file"),
    (("materials", "soft", "mu"), "hard", r"materials\.soft: 'mu' must be a number, not 'hard'"),
    (("materials", "soft", "nu"), 1.0, r"materials\.soft: 'nu' is not a parameter of neo_hookean \(mu\)"),
    (("materials", "soft", "mu"), -2.0, r"materials\.soft: 'mu' = -2.0 is outside"),
    (("materials", "soft", "model"), "neohookean", r"did you mean 'neo_hookean'"),
    (("loads", "pull", "kind"), "equibiaxal", r"did you mean 'equibiaxial'"),
    (("loads", "pull", "stretches"), [], r"loads\.pull\.stretches"),
    (("loads", "pull", "stretches"), [[1.1, 1.2]], r"stretches of a equibiaxial load are single numbers"),
    (("noise", "low", "sigma"), "small", r"noise\.low\.sigma = 'small'"),
    (("noise", "low", "repeats"), 0, r"noise\.low\.repeats = 0"),
    (("methods", "m", "node", "terms"), ["I1", "I3"], r"terms\.1 = 'I3': not allowed; did you mean 'I"),
    (("methods", "m", "node", "terms"), ["I4v"], r"terms need I1 or I2"),
    (("methods", "m", "training", "iteration"), 5, r"unknown key; did you mean 'iterations'"),
    (("methods", "m", "constrained", "draws"), 5, r"unknown key; it is called 'posterior_samples' now"),
    (("methods", "m", "constrained", "jump_weight"), 1.0, r"unknown key; it is called 'regulariser_weight' now"),
    (("cases", "a", "layers"), [], r"unknown key; it is called 'further_phases' now"),
    (("methods", "m", "seed"), -1, r"methods\.m\.seed = -1"),
    (("methods", "m", "node"), None, r"methods\.m: a method also needs node \(or name a baseline\)"),
    (("methods", "m", "baseline"), "homogeneous", r"a baseline has no networks: leave out node"),
    (("methods", "m"), {"baseline": "constrained"}, r"the section constrained goes with baseline 'constrained'"),
    (("methods", "m", "baseline"), "homogenous", r"did you mean 'homogeneous'"),
    (("methods", "m", "constrained"), {"terms": ["I3"]}, r"methods\.m\.constrained\.terms\.0 = 'I3'"),
    (("cases", "a", "hole"), "disk", r"cases\.a\.hole = 'disk': no such entry in geometries"),
    (
        ("cases", "a", "geometry"),
        "disk",
        r"cases\.a\.geometry = 'disk': no such entry in geometries; did you mean 'disc'",
    ),
    (("cases", "a", "methods"), [], r"cases\.a\.methods: list at least one"),
    (("cases", "a", "methods"), ["hypernod"], r"cases\.a\.methods\.0 = 'hypernod': .*did you mean 'hypernode'"),
    (("cases", "a", "loads"), ["push"], r"cases\.a\.loads\.0 = 'push'"),
    (("cases", "a", "inclusion"), None, r"the geometry 'disc' needs an inclusion"),
    (("cases", "a", "matrix"), None, r"a synthetic case also needs matrix"),
    (("cases", "../evil"), BASE["cases"]["a"], r"cases\.\.\./evil: names use letters"),
    (("cases",), {}, r"there is no case"),
    (("figures",), {"f": {"kind": "identification", "case": "b", "method": "m"}}, r"figures\.f\.case = 'b'"),
    (("explorers",), [{"case": "b", "method": "m"}], r"explorers\.0\.case = 'b': no such entry in cases"),
    (("explorers",), [{"case": "a", "method": "m", "beside": "n"}], r"explorers\.0\.beside = 'n'.*methods of its case"),
    (("explorers",), 2 * [{"case": "a", "method": "m"}], r"a/m is listed twice, and a run has one explorer"),
]


@pytest.mark.parametrize(("path", "value", "message"), BROKEN, ids=[".".join(p) + f"={v}"[:20] for p, v, _ in BROKEN])
def test_a_mistake_is_named_with_its_key_and_the_way_out(path, value, message):
    with pytest.raises(ConfigError, match=message):
        check_config(changed(path, value))


def test_errors_carry_file_and_line(tmp_path):
    file = tmp_path / "config.yaml"
    file.write_text(yaml.safe_dump(changed(("noise", "low", "sigma"), -1), sort_keys=False))
    line = 1 + file.read_text().splitlines().index("    sigma: -1")
    with pytest.raises(ConfigError, match=rf"config\.yaml:{line}: noise\.low\.sigma = -1"):
        load_config(file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [", r"yaml:\d+: not valid YAML"),
        ("- 1\n- 2", "must be a mapping"),
        ("a: 1\na: 2", r"yaml:2: .*written twice"),
        ("a: !!python/object/apply:os.system ['true']", "not valid YAML"),
        ("", "must be a mapping"),
    ],
)
def test_what_is_not_a_configuration_is_refused(tmp_path, text, message):
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(ConfigError, match=message):
        load_config(tmp_path / "c.yaml")


@pytest.mark.parametrize("written", ["4e5", "4E5", "4.0e5", "4.e+5", "0.4e6", ".4e6", "400000"])
def test_a_number_may_be_written_as_everywhere(tmp_path, written):
    file = tmp_path / "config.yaml"
    file.write_text(yaml.safe_dump(changed(("materials", "soft", "mu"), "MU")).replace("MU", written))
    assert load_config(file).materials["soft"].parameters == {"mu": 4e5}


def test_a_digit_is_a_glyph():
    assert check_config(changed(("geometries", "disc"), {"shape": "glyph", "text": 8})).geometries["disc"].text == "8"


def test_a_grid_makes_every_combination():
    config = copy.deepcopy(BASE)
    config["grid"] = [{
        "name": "{geometry}_{noise}", "geometry": "disc", "inclusion": "stiff", "matrix": "soft",
        "noise": ["low", "high"], "loads": ["pull"], "methods": ["m"],
    }]  # fmt: skip
    assert set(check_config(config).cases) == {"a", "disc_low", "disc_high"}
    config["grid"][0]["name"] = "{geometry}"
    with pytest.raises(ConfigError, match="gives 'disc' twice"):
        check_config(config)


def test_every_key_that_a_written_case_has_reaches_the_cases_of_a_grid():
    config = copy.deepcopy(BASE)
    shared = {"mesh": "finer", "thickness": 2.0, "cells": [12, 10], "size": [3.0, 2.0], "spacing": [1.5, 1.0]}
    swept = {"geometry": "disc", "inclusion": "stiff", "matrix": "soft", "loads": ["pull"], "methods": ["m"]}
    config["grid"] = [{"name": "{geometry}", **swept, **shared}]
    assert shared.items() <= check_config(config).cases["disc"].model_dump(mode="json").items()


def test_a_rule_sees_only_its_part_of_the_configuration():
    config = check_config(copy.deepcopy(BASE))
    part = slice_for(config, "a", ("geometries", "materials"), keys=("geometry", "inclusion", "matrix"))
    assert set(part) == {"cases", "geometries", "materials"} and "plain" not in part["geometries"]
    assert from_slice(part).materials["stiff"].parameters == {"mu": 2.0}


@pytest.mark.parametrize("name", ["config", "smoke", "robustness", "laws"])
def test_shipped_configurations_are_valid(name):
    assert load_config(ROOT / "config" / f"{name}.yaml").cases


@pytest.mark.parametrize(
    "change",
    [{"constrained": None}, {"pretraining": {**OPTIMISER, "iterations": 0}}, {"training": OPTIMISER}],
)
def test_only_a_network_that_learnt_an_equilibrium_field_last_is_polished(change):
    good = {"constrained": {"iterations": 3}, "training": {**OPTIMISER, "iterations": 0}, "polish": {"iterations": 2}}
    base = {**BASE["methods"]["m"], **good}
    assert check_config(changed(("methods", "m"), base)).methods["m"].polish.iterations == 2
    with pytest.raises(ConfigError, match="polish goes on from a network"):
        check_config(changed(("methods", "m"), {key: v for key, v in {**base, **change}.items() if v is not None}))


def test_an_exponent_that_an_energy_divides_by_is_not_zero():
    materials = {"model": "ogden", "mu": 1.0, "alpha": 0.0}
    with pytest.raises(ConfigError, match="'alpha' must not be zero"):
        check_config(changed(("materials", "stiff"), materials))


def test_a_merge_keeps_what_the_mapping_says_itself(tmp_path):
    text = yaml.safe_dump({key: BASE[key] for key in ("geometries", "materials", "noise", "methods", "cases")})
    text += """
loads:
  pull: &pull {kind: uniaxial_x, stretches: [1.1]}
  further: {<<: *pull, stretches: [1.2]}
"""
    (tmp_path / "c.yaml").write_text(text)
    loads = load_config(tmp_path / "c.yaml").loads
    assert (loads["further"].kind, loads["further"].stretches) == ("uniaxial_x", [1.2])


def test_an_error_in_what_is_merged_in_leads_to_where_it_is_written(tmp_path):
    text = "loads:\n  pull: &pull\n    kind: up\n    stretches: [1.1]\n  further: {<<: *pull, stretches: [1.2]}\n"
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(ConfigError) as found:
        load_config(tmp_path / "c.yaml")
    assert str(found.value).count("c.yaml:3: ") == 2 and "loads.further.kind = 'up'" in str(found.value)


def test_an_anchor_that_holds_itself_is_refused(tmp_path):
    (tmp_path / "c.yaml").write_text("methods:\n  a: &a {extends: hypernode, node: &n {node: *n}}\n")
    with pytest.raises(ConfigError, match=r"c\.yaml: an anchor holds itself"):
        load_config(tmp_path / "c.yaml")


def test_networks_train_on_the_cpu_unless_the_configuration_names_another_platform():
    assert check_config(BASE).platform == "cpu"
    assert check_config(BASE | {"platform": "cuda"}).platform == "cuda"
    with pytest.raises(ConfigError, match="platform"):
        check_config(BASE | {"platform": "gpu"})


def test_a_camera_does_not_measure_at_the_nodes_of_finite_elements():
    seen = {**BASE["cases"]["a"], "camera": {"cells": [20, 20]}}
    check_config({**BASE, "cases": {"a": seen}})
    with pytest.raises(ConfigError, match="leave out mesh or camera"):
        check_config({**BASE, "cases": {"a": {**seen, "mesh": "measured_grid"}}})
