"""What README and CONTRIBUTING say is at a place is there, and the README stays short."""

import re

import pytest

from tests.documentation.copy import ROOT

PATH = re.compile(r"`((?:src|tests|workflow|docs|config|benchmarks|examples|profiles|requirements)[\w./-]*|Snakefile)`")


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_every_place_of_the_map_is_there(page):
    named = PATH.findall((ROOT / page).read_text())
    assert len(named) >= 10
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_each_question_of_a_maintainer_is_answered_within_three_files():
    rows = [line for line in (ROOT / "CONTRIBUTING.md").read_text().splitlines() if line.startswith("| ")]
    assert max(len(PATH.findall(row)) for row in rows) <= 3


def test_the_readme_is_read_in_one_sitting():
    assert len((ROOT / "README.md").read_text().split()) <= 900
