"""The schema that editors read is that of the code, and knows what the code knows."""

import json
from pathlib import Path

import pytest
import yaml
from jsonschema import Draft202012Validator

from hypernode.config.json_schema import schema, text
from tests.config.test_config import BASE, changed

CONFIG = Path(__file__).resolve().parents[2] / "config"


def problems(raw):
    return [error.message for error in Draft202012Validator(json.loads(text())).iter_errors(raw)]


def test_the_shipped_schema_is_that_of_the_code():
    assert (CONFIG / "schema.json").read_text() == text()
    Draft202012Validator.check_schema(schema())


@pytest.mark.parametrize("name", ["config", "smoke", "robustness", "pictures", "laws"])
def test_shipped_configurations_follow_it_and_name_it(name):
    written = (CONFIG / f"{name}.yaml").read_text()
    assert written.startswith("# yaml-language-server: $schema=schema.json\n")
    assert problems(yaml.safe_load(written)) == []


def test_every_key_says_what_it_means():
    def undescribed(node, at=""):
        if not isinstance(node, dict):
            return []
        properties = node.get("properties", {})
        found = [f"{at}.{key}" for key, field in properties.items() if not field.get("description")]
        return found + [name for key, inner in node.items() for name in undescribed(inner, f"{at}.{key}")]

    assert undescribed({key: value for key, value in schema().items() if key != "$defs"}) == []
    assert [name for key, section in schema()["$defs"].items() for name in undescribed(section, key)] == []


def test_a_method_needs_all_of_it_or_what_it_extends():
    assert (
        problems(changed(("methods", "x"), {"extends": "hypernode", "node": {"hidden": [8]}, "training": None})) == []
    )
    assert problems(changed(("methods", "x"), {"node": {"hidden": [8]}}))
    assert problems(changed(("methods", "x"), {"extends": "hypernode", "nodes": {}}))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("geometries", "disc", "radus"), 0.2),
        (("materials", "soft"), {"model": "neo_hookean"}),
        (("materials", "soft", "C10"), 1.0),
        (("loads", "pull", "kind"), "up"),
        (("cases", "a", "cells"), [0, 5]),
        (("cases", "../evil"), BASE["cases"]["a"]),
    ],
)
def test_a_mistake_is_marked_in_the_editor(path, value):
    assert problems(BASE) == [] and problems(changed(path, value))


def test_a_digit_may_be_a_glyph():
    assert problems(changed(("geometries", "disc"), {"shape": "glyph", "text": 8})) == []
