"""One command: its entry point, its pages, and one sentence where something is missing."""

import importlib
import importlib.util
import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from hypernode import cli
from hypernode.storage.netcdf import write
from hypernode.storage.schema_page import page
from hypernode.tables.verdicts import tally

ROOT = Path(__file__).resolve().parents[1]


def test_the_console_command_is_the_one_of_the_package():
    entry = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]["hypernode"]
    module, _, name = entry.partition(":")
    assert getattr(importlib.import_module(module), name) is cli.main


@pytest.mark.parametrize("words", [["schema"], ["schema", "files"]])
def test_schema_is_the_page_of_files(words, capsys):
    assert cli.main(words) == 0
    assert capsys.readouterr().out == page()


def test_schema_config_prints_the_schema_that_stands_beside_the_configurations(capsys):
    assert cli.main(["schema", "config"]) == 0
    assert capsys.readouterr().out == (ROOT / "config/schema.json").read_text(encoding="utf-8")


def test_an_idle_folder_may_be_unlocked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["idle"]) == 0


@pytest.fixture
def judged(tmp_path, monkeypatch):
    """A results folder with one evaluation of each given level."""
    monkeypatch.chdir(tmp_path)

    def make(**levels):
        for method, level in levels.items():
            forces = {
                "name": "forces",
                "level": level,
                "value": 0.1,
                "threshold": 0.03,
                "sentence": f"Forces: {level}.",
            }
            attributes = {"units": {"length": "1"}, "run": {"case": "disc", "method": method}}
            if level:
                attributes["verdict"] = {"overall": level, "criteria": [forces]}
            path = f"results/disc/{method}/evaluation.nc"
            write(path, {"stretch": np.array([1.1])}, "evaluation of disc", attributes)

    return make


def test_verdict_prints_a_line_a_run_the_worst_first_and_fails_with_them(judged, capsys):
    judged(a="pass", b="warn")
    assert cli.main(["verdict"]) == 0
    judged(c="fail")
    capsys.readouterr()
    assert cli.main(["verdict", "results"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["fail  disc/c  Forces: fail.", "warn  disc/b  Forces: warn.", "pass  disc/a"]
    assert cli.main(["verdict", "--json"]) == 1
    assert [each["overall"] for each in json.loads(capsys.readouterr().out)] == ["fail", "warn", "pass"]


def test_verdict_says_where_there_is_none(judged, capsys):
    assert cli.main(["verdict"]) == 2
    assert "results: holds no <case>/<method>/evaluation.nc" in capsys.readouterr().err
    judged(old=None)
    assert cli.main(["verdict"]) == 2
    assert "results/disc/old/evaluation.nc: holds no verdict" in capsys.readouterr().err


def test_a_workflow_ends_with_a_count_of_the_verdicts_that_it_has(judged):
    judged(a="pass", b="warn", c="pass")
    files = [f"results/disc/{method}/evaluation.nc" for method in "abcd"]
    assert tally(files).startswith("verdicts: 2 pass, 1 warn; 'hypernode verdict'")
    judged(d=None)
    assert tally(files).startswith("verdicts cannot be counted: results/disc/d/evaluation.nc: holds no verdict")


def test_the_first_choices_in_the_help_are_the_commands_from_which_the_reference_is_made():
    top = cli.parser().format_help()
    named = re.search(r"\{([\w,-]+)\}", top)[1].split(",")
    assert len(named) == len(cli.COMMANDS) and named[0] == "practice"
