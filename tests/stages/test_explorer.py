"""An explorer is written from the files of a run, wherever they lie, or one sentence says why not."""

import json

import pytest

from hypernode import cli
from hypernode.stages import explorer
from hypernode.storage.netcdf import write
from hypernode.storage.provenance import describe
from hypernode.storage.records import read_record
from tests.explorer.decoding import page_parts
from tests.explorer.files import run_files


def store(path, dataset, parents=()):
    variables = {name: (v.dims, v.values) if "." in name else v.values for name, v in dataset.variables.items()}
    write(path, variables, "a test", {**dataset.attrs, "units": json.loads(dataset.attrs["units"])}, parents)


@pytest.fixture
def results(tmp_path, monkeypatch):
    """A results folder whose run shares its equilibrium field with another method of its case."""
    monkeypatch.chdir(tmp_path)
    files = run_files(3)
    case = tmp_path / "results/half"
    store(case / "measurement.nc", files["measurement"])
    store(case / "true_material.nc", files["truth"])
    for method in ("m", "other"):
        store(case / method / "material.nc", files["truth"])
        parents = [case / "measurement.nc", case / "true_material.nc", case / method / "material.nc"]
        judged = run_files(3, method=method)["evaluation"]
        store(case / method / "evaluation.nc", judged, parents)
    return tmp_path / "results"


def test_the_command_writes_one_file_here_and_says_so(results, capsys):
    assert cli.main(["explore", "results/half/m"]) == 0
    assert capsys.readouterr().out.startswith("explore_half_m.html  0.")
    (run,) = page_parts((results.parent / "explore_half_m.html").read_text()).data["runs"]
    assert run["name"] == "half/m" and run["truth"] is not None and run["posterior"] is None


def test_a_second_folder_stands_beside_the_first(results):
    assert cli.main(["explore", "results/half/m", "results/half/other", "--output", "two.html"]) == 0
    runs = page_parts((results.parent / "two.html").read_text()).data["runs"]
    assert [run["name"] for run in runs] == ["half/m", "half/other"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["results/half"], "holds no evaluation.nc; name results/CASE/METHOD"),
        (["results/half/m", "--output", "page.pdf"], "name a file that ends in .html"),
    ],
)
def test_a_mistake_is_answered_in_a_sentence_and_nothing_is_written(results, capsys, words, sentence):
    assert cli.main(["explore", *words]) == 2
    assert sentence in capsys.readouterr().err
    assert [path for path in results.parent.iterdir() if path != results] == []


def test_a_file_that_is_gone_is_named(results, capsys):
    (results / "half/measurement.nc").unlink()
    assert cli.main(["explore", "results/half/m"]) == 2
    assert "measurement.nc: no such file" in capsys.readouterr().err


def test_the_rule_leaves_a_record_with_everything_that_was_read(results):
    output = results / "half/m/explorer.html"
    files = explorer.files_of(results / "half/m")
    explorer.run(files, {}, str(output), describe("explorer", {}, {}, "code"))
    record = read_record(output)
    assert record["rule"] == "explorer"
    assert set(record["parents"]) == {"../measurement.nc", "../true_material.nc", "material.nc", "evaluation.nc"}
