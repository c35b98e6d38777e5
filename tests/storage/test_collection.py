"""A collection holds what the files of its sheets hold, and gives single fields without reading the rest."""

import json

import numpy as np
import pytest
import xarray as xr

from hypernode.storage.audit import verify
from hypernode.storage.collection import write_collection
from hypernode.storage.netcdf import SYNTHETIC_UNITS, StorageError, read, sha256, write
from hypernode.storage.provenance import describe

CELLS = 4


def sheet(folder, name, level, seed, subcells=1, **scores):
    """A file of one sheet as a population keeps it."""
    settings = {
        "cases": {name: {"geometry": "disc", "inclusion": "stiff", "matrix": "soft", "noise": "n"}},
        "noise": {"n": {"seed": seed}},
    }
    attributes = describe("population_batch", {"case": name, "method": "field"}, settings, "0" * 64)
    attributes |= {"units": SYNTHETIC_UNITS, "summary": {"verdict": f"{level}: forces", **scores}}
    values = np.arange(subcells * CELLS, dtype=float).reshape(subcells, CELLS) + seed
    variables = {"corners": np.array([[0.0, 0], [1, 1]]), "trace_P": values[0]}
    variables |= {"shape": np.arange(CELLS), "basis.log_level": (("subcell", "cell"), values)}
    write(folder / f"{name}.nc", variables, "t", attributes)
    return folder / f"{name}.nc"


@pytest.fixture
def files(tmp_path):
    folder = tmp_path / "results/populations/many/batch"
    return [
        sheet(folder, "b", "warn", 2, dice=0.5),
        sheet(folder, "a", "pass", 1, subcells=4, dice=0.9, fibre_angle_error=3.0),
    ]


@pytest.fixture
def collection(files, tmp_path):
    path = tmp_path / "results/populations/many.nc"
    write_collection(str(path), files, describe("population", {"population": "many"}, {}, "1" * 64))
    return path


def test_sheets_stand_in_the_order_of_their_names_with_what_they_are_and_what_is_judged(collection, files):
    with xr.open_dataset(collection) as found:
        assert found["case"].values.tolist() == ["a", "b"]
        assert found["seed"].values.tolist() == [1, 2]
        assert found["level"].values.tolist() == ["pass", "warn"]
        assert found["digest"].values.tolist() == [sha256(files[1]), sha256(files[0])]
        np.testing.assert_array_equal(found["score.dice"], [0.9, 0.5])
        np.testing.assert_array_equal(found["score.fibre_angle_error"], [3.0, np.nan])
        np.testing.assert_array_equal(found["trace_P"], [[1, 2, 3, 4], [2, 3, 4, 5]])
        assert found["shape"].dtype.kind == "i"


def test_a_sheet_with_fewer_subcells_is_padded_with_no_number(collection):
    with xr.open_dataset(collection) as found:
        level = found["basis.log_level"].values
    assert level.shape == (2, 4, CELLS) and not np.isnan(level[0]).any()
    np.testing.assert_array_equal(level[1, 0], [2, 3, 4, 5])
    assert np.isnan(level[1, 1:]).all()


def test_opening_reads_no_field_and_selecting_reads_one(collection):
    with xr.open_dataset(collection) as found:
        assert not found["trace_P"].variable._in_memory and not found["basis.log_level"].variable._in_memory
        found["trace_P"].isel(sheet=1).load()
        assert not found["basis.log_level"].variable._in_memory


def test_every_sheet_has_a_record_with_its_own_settings_and_is_a_parent_of_the_collection(collection, files):
    records = [json.loads(file.with_name(file.name + ".json").read_text()) for file in files]
    assert [list(record["settings"]["cases"]) for record in records] == [["b"], ["a"]]
    parents = json.loads(read(collection).attrs["parents"])
    assert parents == {f"many/batch/{file.name}": sha256(file) for file in files}


def test_an_audit_finds_a_sheet_that_was_changed(collection, files):
    folder = collection.parents[1]
    (files[0].parent / ".snakemake_timestamp").touch()
    assert not [finding for finding in verify(folder) if finding.file in (str(collection), *map(str, files))]
    files[0].write_bytes(files[0].read_bytes() + b"0")
    assert {finding.file for finding in verify(folder)} >= {str(collection), str(files[0])}
    with pytest.raises(StorageError, match="damaged"):
        write_collection(str(collection), files, {})
