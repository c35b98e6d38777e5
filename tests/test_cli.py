"""One command: its entry point, its pages, and one sentence where something is missing."""

import importlib
import importlib.util
import json
import sys
import tomllib
from pathlib import Path

import pytest

from hypernode import cli
from hypernode.storage.schema import page

ROOT = Path(__file__).resolve().parents[1]


def test_the_console_command_is_the_one_of_the_package():
    entry = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]["hypernode"]
    module, _, name = entry.partition(":")
    assert getattr(importlib.import_module(module), name) is cli.main


@pytest.mark.parametrize("words", [["schema"], ["schema", "files"]])
def test_schema_is_the_page_of_files(words, capsys):
    assert cli.main(words) == 0
    assert capsys.readouterr().out == page()


def test_schema_config_prints_what_the_configuration_module_says(monkeypatch, capsys):
    module = type(sys)("hypernode.config.json_schema")
    module.text = lambda: '{"title": "Config"}\n'
    monkeypatch.setitem(sys.modules, module.__name__, module)
    assert cli.main(["schema", "config"]) == 0
    assert json.loads(capsys.readouterr().out) == {"title": "Config"}


def test_schema_config_says_in_one_sentence_where_it_is_absent(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "hypernode.config.json_schema", None)
    assert cli.main(["schema", "config"]) == 2
    assert capsys.readouterr().err == "error: this version of hypernode has no JSON Schema of its configuration\n"


def test_an_idle_folder_may_be_unlocked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["idle"]) == 0
