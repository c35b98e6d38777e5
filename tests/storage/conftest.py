"""A small results folder as a run leaves it: a measured case with one method, and the crate of it."""

import json
from pathlib import Path

import numpy as np
import pytest

from hypernode.pipeline.compiler import compiler_settings
from hypernode.storage import crate, records
from hypernode.storage.netcdf import SYNTHETIC_UNITS, write
from hypernode.storage.provenance import describe
from hypernode.storage.records import record_of, sha256


def stored(path, value, parents=(), rule="training", made_with=(), **settings):
    """A result of constant loss; ``made_with`` replaces what its job says of itself."""
    attributes = describe(rule, {"case": "c"}, {"seed": 3} | settings, "0" * 64) | dict(made_with)
    variables = {"loss": np.full(200, value), "loss_iteration": np.arange(200)}
    write(path, variables, "t", {**attributes, "units": SYNTHETIC_UNITS}, parents)


def rewritten(path, **keys):
    """Change keys of a record as the job of another machine would have written them."""
    content = json.loads(record_of(path).read_text()) | keys
    content["record"] = records._own_digest(content)
    record_of(path).write_text(records._text(content))


def crated(folder, *targets):
    """End a run: write the crate of its targets."""
    snakefile = folder.parent / "Snakefile"
    snakefile.write_text("rule all:\n")
    crate.write(folder, [str(folder / t) for t in targets], [str(snakefile)], describe("crate", {}, {}, "2" * 64))


@pytest.fixture
def raw(tmp_path) -> Path:
    place = tmp_path / "raw.csv"
    place.write_text("1;2\n")
    return place


@pytest.fixture
def results(tmp_path, raw, monkeypatch) -> Path:
    for variable, value in compiler_settings(float64=False).items():
        monkeypatch.setenv(variable, value)
    folder = tmp_path / "results"
    attributes = describe("import_dic", {}, {}, "1" * 64) | {"raw_inputs": {raw.name: sha256(raw)}}
    write(folder / "c/measurement.nc", {"t": np.arange(3.0)}, "t", {**attributes, "units": SYNTHETIC_UNITS})
    stored(folder / "c/m/gradient.nc", 1.0, [folder / "c/measurement.nc"], rule="gradient")
    stored(folder / "c/m/material.nc", 2.0, [folder / "c/m/gradient.nc"], weight=0.5)
    crated(folder, "c/m/material.nc")
    return folder
