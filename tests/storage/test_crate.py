"""The crate holds what the last run made, with the code that made it; the report belongs to it."""

import json
import zipfile

import pytest

from hypernode.cli import main
from hypernode.storage.audit import verify
from hypernode.storage.membership import described
from hypernode.storage.records import CRATE, StorageError, read_record
from hypernode.storage.report import file_report
from tests.storage.conftest import crated, stored


def report_of(folder, *names):
    place = folder.parent / "report.zip"
    with zipfile.ZipFile(place, "w") as archive:
        archive.writestr("report/report.html", "<html></html>")
        for name in names:
            archive.write(folder / name, f"report/data/{name}")
    return place


def test_a_crate_holds_targets_and_ancestors_and_nothing_else_that_lies_in_the_folder(results):
    stored(results / "gone/m/material.nc", 2.0)
    crated(results, "c/m/gradient.nc")
    assert set(described(results)) == {"c/measurement.nc", "c/m/gradient.nc", "definition/Snakefile"}


def test_every_action_names_the_code_that_made_its_file(results):
    other = {"code": "f" * 64}
    stored(results / "c/n/material.nc", 2.0, [results / "c/m/gradient.nc"], made_with=other)
    crated(results, "c/m/material.nc", "c/n/material.nc")
    entities = {each["@id"]: each for each in json.loads((results / CRATE).read_text())["@graph"]}
    actions = [each for each in entities.values() if each["@id"].startswith("#made-")]
    assert len(actions) == len(described(results))
    for action in actions:
        code = read_record(results / action["result"]["@id"])["code"]
        assert entities[action["instrument"]["@id"]]["softwareVersion"] == code
        assert json.loads(action["description"])["code"] == code


def test_a_report_is_filed_with_the_results_it_shows_as_parents_and_passes_the_audit(results, capsys):
    assert main(["audit", "report", str(report_of(results, "c/m/material.nc")), str(results)]) == 0
    assert capsys.readouterr().out.strip() == str(results / "report.zip")
    assert list(read_record(results / "report.zip")["parents"]) == ["c/m/material.nc"]
    assert verify(results) == []
    stored(results / "c/m/material.nc", 7.0, [results / "c/m/gradient.nc"])
    crated(results, "c/m/material.nc")
    (outdated,) = verify(results)
    assert outdated.file.endswith("report.zip") and "its parent c/m/material.nc is not the file" in outdated.message
    assert "make the report again" in outdated.message


def test_a_report_of_other_results_or_none_is_refused(results):
    with pytest.raises(StorageError, match="shows no result"):
        file_report(report_of(results), results)
    (results.parent / "text.zip").write_text("no archive")
    with pytest.raises(StorageError, match="cannot be read as a report"):
        file_report(results.parent / "text.zip", results)
