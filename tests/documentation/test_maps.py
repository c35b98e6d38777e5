"""What README and CONTRIBUTING say is at a place is there, and the README stays short."""

import re
import subprocess

import pytest

from tests.documentation.copy import ROOT

PATH = re.compile(
    r"`((?:src|tests|workflow|docs|config|benchmarks|profiles|requirements|resources)(?:/[\w./-]*|\.txt)|"
    r"(?:Snakefile|Makefile|LICENSE|[\w]+\.(?:md|toml|cff)))`"
)
#: Entries at the top that do not begin with a dot.
MOST_ENTRIES = 16
#: What a question of CONTRIBUTING takes at most.
MOST_FILES = 3


def rows():
    """(files to look at, tests that hold them) of every question of docs/CONTRIBUTING.md."""
    text = (ROOT / "docs/CONTRIBUTING.md").read_text().split("\n## ")[1]
    table = [line.split("|")[1:-1] for line in text.splitlines() if line.startswith("| ")]
    return {what.strip(): (PATH.findall(files), PATH.findall(tests)) for what, files, tests in table[1:]}


def test_every_entry_at_the_top_is_explained_in_the_readme():
    found = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if found.returncode:
        pytest.skip("what belongs to the project is known to git alone")
    entries = {line.split("/")[0] for line in found.stdout.splitlines() if not line.startswith(".")}
    page = (ROOT / "README.md").read_text().split("## The top level")[1]
    explained = {name.split("/")[0] for name in PATH.findall(page)} | {"README.md"}
    assert entries == explained and len(entries) <= MOST_ENTRIES


def test_every_file_of_the_configuration_is_explained_beside_it():
    table = (ROOT / "config/README.md").read_text().split("\n## ")[0]
    explained = re.findall(r"^\| `([\w.]+)` \|", table, flags=re.MULTILINE)
    assert {path.name for path in (ROOT / "config").iterdir()} == {*explained, "README.md"}


@pytest.mark.parametrize("page", ["README.md", "docs/CONTRIBUTING.md"])
def test_every_place_of_the_map_is_there(page):
    named = PATH.findall((ROOT / page).read_text())
    assert len(named) >= 10
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_each_question_of_a_maintainer_is_answered_within_three_files():
    assert len(rows()) >= 10
    assert {what: files for what, (files, _) in rows().items() if not 1 <= len(files) <= MOST_FILES} == {}


@pytest.mark.parametrize("what", [what for what, (_, tests) in rows().items() if any(".py" in each for each in tests)])
def test_the_tests_of_a_place_import_it(what):
    files, tests = rows()[what]
    text = "\n".join((ROOT / each).read_text() for each in tests)
    modules = [each.removeprefix("src/").removesuffix(".py").replace("/", ".") for each in files]
    assert any(module in text for module in modules)


def test_the_readme_is_read_in_one_sitting():
    assert len((ROOT / "README.md").read_text().split()) <= 900
