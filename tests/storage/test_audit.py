"""Audits: every change of a result, of what it came from and of how it was made is found, with its file."""

import json

import numpy as np
import pytest

from hypernode.cli import main
from hypernode.storage.audit import verify
from hypernode.storage.environment import versions
from hypernode.storage.integrity import damages
from hypernode.storage.netcdf import read
from hypernode.storage.records import CRATE, StorageError, read_record, record_of, result_files
from tests.storage.conftest import crated, rewritten, stored


def said(folder, now={}.get):
    """(file name, message) of every problem, and of every notice."""
    found = verify(folder, now)
    return [[(f.file.rsplit("/", 1)[-1], f.message) for f in found if f.notice is kind] for kind in (False, True)]


def problems_of(path, directory):
    try:
        return damages(path, read_record(path), directory)
    except StorageError as error:
        return [error]


def test_an_untouched_run_has_no_problem(results, capsys):
    assert verify(results) == []
    assert main(["audit", "verify", str(results)]) == 0
    assert "5 files" in capsys.readouterr().out


def test_two_hundred_flipped_bits_are_found_and_none_is_read(results):
    rng = np.random.default_rng(0)
    files = sorted(p for p in (results / "c").rglob("*") if p.is_file())
    for _ in range(200):
        path = files[rng.integers(len(files))]
        original = path.read_bytes()
        damaged = bytearray(original)
        damaged[rng.integers(len(damaged))] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        owner = path if path.suffix == ".nc" else path.with_suffix("")
        assert problems_of(owner, results.parent), path
        with pytest.raises(StorageError, match=owner.name):
            read(owner)
        path.write_bytes(original)
    assert verify(results) == []


def test_package_upgraded_between_two_jobs_is_named_with_file_and_versions(results):
    old = versions() | {"numpy": "1.0"}
    stored(results / "c/m/material.nc", 2.0, [results / "c/m/gradient.nc"], made_with={"versions": old})
    crated(results, "c/m/material.nc")
    ((file, message),), notices = said(results)
    assert file == "material.nc" and notices == []
    assert f"numpy 1.0, most others with {versions()['numpy']}, installed is {versions()['numpy']}" in message


def test_package_upgraded_after_the_whole_run_is_named_for_every_file(results, monkeypatch):
    monkeypatch.setattr("hypernode.storage.consistency.versions", lambda: versions() | {"jaxlib": "9.9"})
    problems, _ = said(results)
    assert sorted(file for file, _ in problems) == sorted(path.name for path in result_files(results))
    assert all("jaxlib" in message and "installed is 9.9" in message for _, message in problems)


@pytest.mark.parametrize("changed", [{"XLA_FLAGS": "--xla_other=true"}, {"JAX_ENABLE_X64": "1"}])
def test_flag_changed_among_jobs_of_a_rule_is_named(results, changed):
    usual = {"XLA_FLAGS": "--xla_one=true", "JAX_ENABLE_X64": "0"}
    for name, settings in (("a", usual), ("b", usual), ("odd", usual | changed)):
        stored(results / f"c/{name}/material.nc", 2.0, made_with={"compiler": settings}, rule="pretraining")
    crated(results, "c/m/material.nc", *(f"c/{name}/material.nc" for name in ("a", "b", "odd")))
    (found,) = verify(results)
    (variable,) = changed
    assert "c/odd/material.nc" in found.file and not found.notice
    assert f"{variable}='{changed[variable]}', most other jobs of the rule pretraining with '{usual[variable]}'" in str(
        found
    )


def test_flag_changed_since_the_run_is_named(results):
    made = {"compiler": {"XLA_FLAGS": "--xla_old=true"}}
    stored(results / "c/m/material.nc", 2.0, [results / "c/m/gradient.nc"], made_with=made)
    crated(results, "c/m/material.nc")
    assert verify(results, {"training": made["compiler"]}.get) == []
    ((file, message),), _ = said(results, {"training": {"XLA_FLAGS": "--xla_new=true"}}.get)
    assert file == "material.nc" and "its rule would now set '--xla_new=true'" in message


def test_raw_input_moved_or_changed_is_named(results, raw):
    raw.rename(raw.with_name("elsewhere.csv"))
    ((file, message),), _ = said(results)
    assert file == "measurement.nc" and "the raw input raw.csv cannot be found" in message
    raw.write_text("3;4\n")
    ((file, message),), _ = said(results)
    assert file == "measurement.nc" and "the raw input raw.csv has changed" in message


def test_raw_input_is_looked_for_where_the_run_was_and_not_where_the_audit_is(results, tmp_path, monkeypatch):
    (tmp_path / "other").mkdir()
    (tmp_path / "other/raw.csv").write_text("9\n")
    monkeypatch.chdir(tmp_path / "other")
    assert verify(results) == []


def test_raw_input_is_found_where_results_are_a_link_to_another_disk(results, tmp_path):
    (tmp_path / "disk").mkdir()
    results.rename(tmp_path / "disk/results")
    results.symlink_to(tmp_path / "disk/results")
    assert verify(results) == []


def test_stale_case_in_results_is_told_from_the_last_run(results):
    stored(results / "gone/m/material.nc", 2.0)
    crated(results, "c/m/material.nc")
    ((file, message),), _ = said(results)
    assert file == "material.nc" and "not part of the last run" in message
    assert "gone/m" in next(f.file for f in verify(results))


def test_record_deleted_is_named_and_so_is_a_result_deleted_with_its_record(results):
    record_of(results / "c/m/material.nc").unlink()
    ((file, message),), _ = said(results)
    assert file == "material.nc" and "its record material.nc.json is missing" in message
    (results / "c/m/material.nc").unlink()
    ((file, message),), _ = said(results)
    assert file == "material.nc" and "gone with its record" in message


def test_a_result_made_anew_since_the_run_ended_is_named(results):
    stored(results / "c/m/material.nc", 5.0, [results / "c/m/gradient.nc"])
    ((file, message),), _ = said(results)
    assert file == "material.nc" and "made anew since" in message


def test_without_a_crate_a_notice_says_that_stale_files_are_not_told(results):
    for place in (results / CRATE, record_of(results / CRATE)):
        place.unlink()
    problems, ((file, message),) = said(results)
    assert problems == [] and file == CRATE and "no readable crate" in message


def test_mixed_processors_are_a_notice_and_no_problem(results, capsys):
    record = read_record(results / "c/m/material.nc")
    rewritten(results / "c/m/material.nc", processor=record["processor"] | {"model": "Other CPU"})
    problems, ((file, message),) = said(results)
    assert problems == [] and file == "material.nc" and "Other CPU" in message
    assert main(["audit", "verify", str(results)]) == 0
    assert "notice: " in capsys.readouterr().out


def test_a_replaced_parent_and_a_record_without_file_are_named(results):
    stored(results / "c/m/gradient.nc", 9.0, [results / "c/measurement.nc"], rule="gradient")
    record_of(results / "c/x.nc").write_text("{}")
    problems = dict(said(results)[0])
    assert "its parent gradient.nc is not the file" in problems["material.nc"]
    assert "a record without its file" in problems["x.nc.json"]


def test_problems_for_machines_have_file_and_message_and_exit_code_1(results, raw, capsys):
    raw.unlink()
    assert main(["audit", "verify", str(results), "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    (problem,) = answer["problems"]
    assert problem["file"].endswith("measurement.nc") and "raw.csv" in problem["message"] and answer["notices"] == []


def test_a_record_that_a_run_has_left_behind_is_not_a_result(results):
    (results / "c/measurement.nc").unlink()
    (results / "Snakefile.json").write_text("{}")
    assert {path.name for path in result_files(results)} == {"gradient.nc", "material.nc", "Snakefile", CRATE}


def test_a_record_holds_time_and_processor_and_the_file_does_not(results):
    record = read_record(results / "c/m/gradient.nc")
    assert record["written"].startswith("20") and record["host"] and record["processor"]["architecture"]
    assert {"versions", "compiler"} <= set(read(results / "c/m/gradient.nc").attrs)
    assert not {"processor", "host", "python", "written"} & set(read(results / "c/m/gradient.nc").attrs)
    first = (results / "c/m/gradient.nc").read_bytes()
    stored(results / "c/m/gradient.nc", 1.0, [results / "c/measurement.nc"], rule="gradient")
    assert (results / "c/m/gradient.nc").read_bytes() == first


def test_nothing_to_audit_is_an_error(tmp_path, capsys):
    assert main(["audit", "verify", str(tmp_path / "none")]) == 2
    assert "no results there" in capsys.readouterr().err
