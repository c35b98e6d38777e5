"""Presets may be named without being defined, and a method says only what differs from another."""

import copy

import pytest

from hypernode.config.loading import ConfigError, check_config, load_config
from hypernode.config.methods import Method
from hypernode.config.presets import presets
from hypernode.material.node_material import NodeMaterial
from tests.config.test_config import BASE


def with_methods(methods, used=()):
    raw = copy.deepcopy(BASE)
    raw["methods"] |= methods
    raw["cases"]["a"]["methods"] = ["m", *methods, *used]
    return check_config(raw).methods


def test_every_preset_is_a_valid_method():
    assert {"hypernode", "paper", "paper_as_published", "homogeneous", "equilibrium_gap", "updating"} <= set(presets())
    for settings in presets().values():
        Method.model_validate(settings)


def test_a_preset_is_there_where_a_case_names_it_and_nowhere_else():
    methods = with_methods({}, used=["hypernode"])
    assert methods["hypernode"] == Method.model_validate(presets()["hypernode"])
    assert set(methods) == {"m", "hypernode"}


def test_a_case_without_methods_has_the_default_one():
    raw = copy.deepcopy(BASE)
    del raw["cases"]["a"]["methods"]
    raw["grid"] = [{"name": "g", "geometry": "disc", "inclusion": "stiff", "matrix": "soft", "loads": ["pull"]}]
    config = check_config(raw)
    assert config.cases["a"].methods == config.cases["g"].methods == ["hypernode"] and "hypernode" in config.methods


def test_a_method_that_extends_another_differs_in_what_it_says_and_in_nothing_else():
    mine = with_methods({"mine": {"extends": "hypernode", "seed": 2, "node": {"hidden": [8]}}})["mine"]
    hypernode = Method.model_validate(presets()["hypernode"])
    assert (mine.seed, mine.node.hidden) == (2, [8])
    assert mine.model_copy(update={"seed": 1, "node": hypernode.node}) == hypernode
    assert mine.node.model_copy(update={"hidden": [4, 4]}) == hypernode.node


def test_methods_of_a_file_extend_one_another_in_any_order():
    methods = with_methods({"third": {"extends": "second", "seed": 3}, "second": {"extends": "m", "prior_weight": 0.5}})
    assert (methods["third"].seed, methods["third"].prior_weight) == (3, 0.5)
    assert methods["third"].node == methods["m"].node


def test_null_takes_back_what_the_extended_method_says():
    methods = with_methods({"plain": {"extends": "paper", "interpolant": None, "pretraining": {"points": None}}})
    assert methods["plain"].interpolant is None
    assert methods["plain"].pretraining.points is None and methods["plain"].pretraining.iterations == 100


def test_a_preset_can_be_changed_under_its_own_name():
    methods = with_methods({"hypernode": {"extends": "hypernode", "seed": 7}, "more": {"extends": "hypernode"}})
    assert methods["hypernode"].seed == methods["more"].seed == 7


def test_the_paper_as_published_departs_in_nothing_that_a_key_names():
    """Its networks have the published sizes and parameter count, and nothing is added to its loss."""
    published = Method.model_validate(presets()["paper_as_published"])
    assert (published.interpolant.features, published.interpolant.widths) == (100, [40, 40])
    assert (published.hypernetwork.features, published.hypernetwork.widths) == (40, [40, 40])
    node = published.node
    material = NodeMaterial(
        terms=tuple(node.terms),
        hidden=tuple(node.hidden),
        steps=node.rk4_steps,
        invariant_scale=1.0,
        stress_scale=1.0,
        share=node.share,
        scaled=node.scaled,
    )
    assert material.size == 126 and (node.share, node.scaled) == (1.0, False)
    assert NodeMaterial(terms=("I1", "I2"), hidden=(4, 4), steps=2, invariant_scale=1.0, stress_scale=1.0).size == 50
    assert published.gradient == "finite_difference" and not published.normalised
    assert (published.homogenised.ridge, published.prior_weight, published.initialisation.from_bias) == (0, 0, False)
    loss = published.training
    assert (loss.equilibrium, loss.traction, loss.equilibrium_weight) == ("autodiff", "nodal", 1.0)
    assert (loss.variation_weight, loss.target_weight) == (0.0, 0.0)


WRONG = [
    (
        {"x": {"extends": "hypernod"}},
        r"c\.yaml:2: methods\.x\.extends = 'hypernod': no such .*did you mean 'hypernode'",
    ),
    (
        {"x": {"extends": "y"}, "y": {"extends": "x"}},
        r"c\.yaml:3: methods\.y\.extends = 'x': goes in a circle: x -> y -> x",
    ),
    ({"x": {"extends": "x"}}, r"methods\.x\.extends = 'x': goes in a circle"),
    ({"x": {"extends": [1]}}, r"methods\.x\.extends = \[1\]: no such"),
    ({"paper": {"seed": 2}}, r"c\.yaml:2: methods\.paper: a preset has this name: say 'extends: paper'"),
    ({"x": {"extends": "paper", "nodes": {}}}, r"methods\.x\.nodes: unknown key; did you mean 'node'"),
    ({"x": {"extend": "paper"}}, r"methods\.x\.extend: unknown key; did you mean 'extends'"),
    (
        {"x": {"extends": "paper", "training": {"traction": "nodal"}}},
        r"methods\.x: training\.traction 'nodal' goes with a residual at points, .* autodiff or",
    ),
    ({"x": {"extends": "paper", "node": None}}, r"c\.yaml:2: methods\.x: a method also needs node"),
]


@pytest.mark.parametrize(("methods", "message"), WRONG, ids=[str(m)[:40] for m, _ in WRONG])
def test_a_wrong_extension_is_named_with_its_line(tmp_path, methods, message):
    # One line each, so that the first method stands in line 2.
    lines = "".join(f"  {name}: {settings}\n" for name, settings in methods.items()).replace("None", "null")
    (tmp_path / "c.yaml").write_text("methods:\n" + lines)
    with pytest.raises(ConfigError) as found:
        load_config(tmp_path / "c.yaml")
    found.match(message)


def test_what_is_inherited_is_at_fault_once_and_where_it_is_written(tmp_path):
    text = (
        "methods:\n  a:\n    extends: hypernode\n    seed: -1\n  b: {extends: a}\n  c: {extends: b, prior_weight: -1}\n"
    )
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(ConfigError) as found:
        load_config(tmp_path / "c.yaml")
    lines = str(found.value).splitlines()
    assert [line.split(" = ")[0].split("/")[-1] for line in lines] == [
        "c.yaml:4: methods.a.seed",
        "c.yaml:6: methods.c.prior_weight",
    ]
