"""What `make` hands to the programs that it starts."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def project(tmp_path):
    """The Makefile beside an environment that counts as built, whose snakemake writes down what reaches it."""
    shutil.copy(ROOT / "Makefile", tmp_path)
    (tmp_path / "requirements").mkdir()
    for name in ("pyproject.toml", "requirements.txt", "requirements/constraints.txt"):
        (tmp_path / name).touch()
    program = tmp_path / ".venv/bin/snakemake"
    program.parent.mkdir(parents=True)
    program.write_text(
        '#!/bin/sh\necho "${PYTHONPATH-none}" > seen\necho "${PYTHONDONTWRITEBYTECODE-none}" > unwritten\n'
    )
    program.chmod(0o755)
    (tmp_path / ".venv/run").touch()
    return tmp_path


@pytest.mark.parametrize(
    ("given", "seen"),
    [
        ({"PYTHONPATH": "/module/of/another/python"}, "none"),
        ({"PYTHONPATH": "/module/of/another/python", "HYPERNODE_SOURCE": "/copy/src"}, "/copy/src"),
        ({}, "none"),
    ],
)
def test_the_packages_of_another_python_do_not_reach_a_program_but_a_source_that_is_named_does(project, given, seen):
    own = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "HYPERNODE_SOURCE")}
    subprocess.run(["make", "--silent"], cwd=project, env=own | given, check=True)
    assert (project / "seen").read_text().strip() == seen


def test_what_is_compiled_of_the_project_is_kept_where_a_container_forbids_it(project):
    subprocess.run(["make", "--silent"], cwd=project, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}, check=True)
    assert (project / "unwritten").read_text().strip() == "none"


def test_help_has_every_target_that_a_comment_explains_under_a_heading():
    blocks = [block.splitlines() for block in (ROOT / "Makefile").read_text().split("\n\n")]
    explained = {
        (line.split(":")[0], lines[0].removeprefix("# "))
        for lines in blocks
        for line in lines[1:]
        if lines[0].startswith("# ") and re.match(r"[a-z-]+:(?! \w+ \?=)", line)
    }
    told = subprocess.run(["make", "--silent", "help"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    groups = [group.splitlines() for group in told.split("\n\n")]
    assert all(len(group) > 1 and not group[0].startswith(" ") for group in groups)
    assert {tuple(line.split(maxsplit=2)[1:]) for group in groups for line in group[1:]} == explained
    assert len(explained) > 20
