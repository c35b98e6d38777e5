"""What archives and catalogues read of the project agrees with what it says of itself."""

import json
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text())
ARCHIVE = json.loads((ROOT / ".zenodo.json").read_text())


@pytest.mark.parametrize(("said", "by"), [(CITATION, "CITATION.cff"), (ARCHIVE, ".zenodo.json")])
def test_version_licence_and_keywords_are_those_of_the_package(said, by):
    assert [str(said[key]) for key in ("version", "license")] == [PROJECT["version"], PROJECT["license"]], by
    assert said["keywords"] == PROJECT["keywords"], by


def test_the_archive_has_title_abstract_and_authors_of_the_citation():
    assert ARCHIVE["title"] == CITATION["title"]
    assert ARCHIVE["description"] == CITATION["abstract"]
    assert [each["name"] for each in ARCHIVE["creators"]] == [each["name"] for each in CITATION["authors"]]
    assert [each["name"] for each in PROJECT["authors"]] == [each["name"] for each in CITATION["authors"]]


def test_the_archive_names_the_papers_that_the_citation_names():
    (preprint,) = CITATION["preferred-citation"]["identifiers"]
    cited = {preprint["value"], *(each["doi"] for each in CITATION["references"])}
    assert {each["identifier"] for each in ARCHIVE["related_identifiers"]} == cited


def test_the_catalogue_promises_a_report_that_the_workflow_can_write():
    usage = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())["usage"]
    assert usage["report"] and sorted((ROOT / "workflow/report").glob("*.rst"))
    assert set(usage["software-stack-deployment"].values()) == {False}
    assert not list((ROOT / "workflow").rglob("*env*.y*ml")), "environments of rules would have to be promised"


def test_a_wheel_brings_every_file_of_the_workflow_and_of_its_profiles():
    data = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["data-files"]
    brought = {
        f"{folder.removeprefix('share/hypernode').lstrip('/')}/{path.name}".lstrip("/"): str(path.relative_to(ROOT))
        for folder, patterns in data.items()
        for pattern in patterns
        for path in ROOT.glob(pattern)
    }
    files = [path for part in ("workflow", "profiles") for path in (ROOT / part).rglob("*") if path.is_file()]
    needed = {str(path.relative_to(ROOT)) for path in files if "__pycache__" not in path.parts}
    assert all(place == origin for place, origin in brought.items())
    assert needed - set(brought) == set()


def test_a_host_runs_what_everybody_runs():
    """The file of a host has no steps of its own besides those that fetch the project and what it needs."""
    jobs = yaml.safe_load((ROOT / ".github/workflows/checks.yml").read_text())["jobs"]
    (job,) = jobs.values()
    commands = [step["run"].split() for step in job["steps"] if "run" in step]
    assert commands == [[".ci/run"]]
    (python,) = [step["with"]["python-version"] for step in job["steps"] if "python" in step.get("uses", "")]
    assert f"Programming Language :: Python :: {python}" in PROJECT["classifiers"]
