"""Records and audits: every change of a result is found, every number leads back to its inputs."""

import json

import numpy as np
import pytest

from hypernode.__main__ import main
from hypernode.storage.audit import compare, lineage, problems_of, result_files, verify
from hypernode.storage.netcdf import SYNTHETIC_UNITS, read, write
from hypernode.storage.records import StorageError, read_record, record_of, sha256


def stored(path, value, parents=(), **settings):
    attributes = {"units": SYNTHETIC_UNITS, "rule": "r", "run": {"case": "c"}, "code": "0" * 64}
    attributes |= {"settings": json.dumps({"seed": 3} | settings), "versions": {"numpy": "1"}}
    write(path, {"loss": np.full(200, value), "loss_iteration": np.arange(200)}, "t", attributes, parents)


@pytest.fixture
def results(tmp_path):
    raw = tmp_path / "raw.csv"
    raw.write_text("1;2\n")
    folder = tmp_path / "results"
    attributes = {"units": SYNTHETIC_UNITS, "raw_inputs": {str(raw): sha256(raw)}, "rule": "import_dic"}
    attributes |= {"code": "1" * 64, "settings": "{}", "versions": {}}
    write(folder / "c/measurement.nc", {"t": np.arange(3.0)}, "t", attributes)
    stored(folder / "c/m/gradient.nc", 1.0, [folder / "c/measurement.nc"])
    stored(folder / "c/m/material.nc", 2.0, [folder / "c/m/gradient.nc"], weight=0.5)
    return folder


def test_an_untouched_run_has_no_problem(results, capsys):
    assert verify(results) == []
    assert main(["audit", "verify", str(results)]) == 0
    assert "3 files" in capsys.readouterr().out


def test_two_hundred_flipped_bits_are_found_and_none_is_read(results):
    rng = np.random.default_rng(0)
    files = sorted(p for p in results.rglob("*") if p.is_file())
    for _ in range(200):
        path = files[rng.integers(len(files))]
        original = path.read_bytes()
        damaged = bytearray(original)
        damaged[rng.integers(len(damaged))] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        owner = path if path.suffix == ".nc" else path.with_suffix("")
        assert problems_of(owner), path
        with pytest.raises(StorageError, match=owner.name):
            read(owner)
        path.write_bytes(original)
    assert verify(results) == []


def test_a_replaced_parent_a_lost_record_and_changed_raw_data_are_named(results, tmp_path, capsys):
    stored(results / "c/m/gradient.nc", 9.0, [results / "c/measurement.nc"])
    record_of(results / "c/measurement.nc").unlink()
    (tmp_path / "raw.csv").write_text("3;4\n")
    problems = "\n".join(verify(results))
    assert "material.nc: its parent gradient.nc is not the file" in problems
    assert "its record measurement.nc.json is missing" in problems
    assert main(["audit", "verify", str(results), "--json"]) == 1
    assert len(json.loads(capsys.readouterr().out)["problems"]) == 2
    stored(results / "c/measurement.nc", 1.0)
    record_of(results / "c/x.nc").write_text("{}")
    assert any("a record without its file" in line for line in verify(results))


def test_a_record_that_a_run_has_left_behind_is_not_a_result(results):
    (results / "c/measurement.nc").unlink()
    (results / "Snakefile.json").write_text("{}")
    assert {path.name for path in result_files(results)} == {"gradient.nc", "material.nc"}


def test_explain_reaches_seeds_versions_code_and_raw_input_of_every_ancestor(results, tmp_path, capsys):
    assert main(["audit", "explain", str(results / "c/m/material.nc")]) == 0
    text = capsys.readouterr().out
    for wanted in ("gradient.nc", "measurement.nc", "raw.csv", "seed = 3", "numpy 1", "weight", "code 000000000000"):
        assert wanted in text
    node = lineage(results / "c/m/material.nc")
    assert node["parents"][0]["parents"][0]["raw_inputs"] == {str(tmp_path / "raw.csv"): sha256(tmp_path / "raw.csv")}
    assert main(["audit", "explain", str(results / "nothing.nc")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_diff_names_the_first_stage_that_differs_and_by_how_much(results, tmp_path, capsys):
    other = tmp_path / "other"
    for path in result_files(results):
        (other / path.relative_to(results)).parent.mkdir(parents=True, exist_ok=True)
        for each in (path, record_of(path)):
            (other / each.relative_to(results)).write_bytes(each.read_bytes())
    assert compare(results, other) == [] and main(["audit", "diff", str(results), str(other)]) == 0
    stored(other / "c/m/gradient.nc", 1.5, [other / "c/measurement.nc"], weight=0.1)
    stored(other / "c/m/material.nc", 2.0, [other / "c/m/gradient.nc"], weight=0.5)
    entries = compare(results, other)
    assert [entry["file"] for entry in entries] == ["c/m/gradient.nc", "c/m/material.nc"]
    assert "configuration: weight = None against 0.1" in entries[0]["differences"]
    assert any("loss: largest difference 0.5, 0.5 of" in line for line in entries[0]["differences"])
    assert "input gradient.nc differs" in entries[1]["differences"]
    assert main(["audit", "diff", str(results), str(other)]) == 1
    assert "gradient.nc" in capsys.readouterr().out


def test_a_record_holds_the_time_and_the_file_does_not(results, tmp_path):
    record = read_record(results / "c/m/gradient.nc")
    assert record["written"].startswith("20") and record["host"]
    first = (results / "c/m/gradient.nc").read_bytes()
    stored(results / "c/m/gradient.nc", 1.0, [results / "c/measurement.nc"])
    assert (results / "c/m/gradient.nc").read_bytes() == first


def test_nothing_to_audit_is_an_error(tmp_path, capsys):
    assert main(["audit", "verify", str(tmp_path / "none")]) == 2
    assert "no results there" in capsys.readouterr().err
