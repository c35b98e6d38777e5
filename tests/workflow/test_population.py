"""Sheets of a population, run by jobs of several, are those that the stages one by one would have made."""

import copy
import json

import numpy as np
import pytest
import xarray as xr
import yaml

from hypernode.storage.audit import verify
from tests.workflow.running import snakemake
from tests.workflow.test_cluster import CONFIG

pytestmark = pytest.mark.slow
NOISE = {"sigma": 1e-3, "force": 0.005, "seed": 5}


@pytest.fixture(scope="module")
def ran(request, tmp_path_factory):
    if not request.config.getoption("--smoke"):
        pytest.skip("the whole DAG runs with --smoke")
    folder = tmp_path_factory.mktemp("population")
    config = copy.deepcopy(CONFIG)
    sheet = config["cases"].pop("disc")
    config["noise"] = {"camera": NOISE, "second": {**NOISE, "seed": 6}}
    config["cases"] = {"alone": {**sheet, "noise": "second"}}
    config["populations"] = {"many": {**sheet, "name": "{noise}", "noise": "camera", "seeds": 3, "batch": 2}}
    (folder / "config.yaml").write_text(yaml.safe_dump(config))
    done = snakemake(folder, config=folder / "config.yaml")
    assert done.returncode == 0, done.stderr[-4000:]
    return folder / "results"


def test_the_collection_has_every_sheet_and_its_fields_are_those_of_a_case_run_stage_by_stage(ran):
    with xr.open_dataset(ran / "populations/many.nc") as found, xr.open_dataset(ran / "alone/few/material.nc") as alone:
        assert found["case"].values.tolist() == ["camera-0005", "camera-0006", "camera-0007"]
        assert found["seed"].values.tolist() == [5, 6, 7]
        np.testing.assert_allclose(found["basis.log_level"][1], alone["basis.log_level"], rtol=1e-9)
        assert not np.allclose(found["basis.log_level"][0], found["basis.log_level"][1], rtol=1e-3)


def test_every_sheet_has_its_own_record_and_the_whole_folder_is_intact(ran):
    records = sorted((ran / "populations/many").glob("*/*.nc.json"))
    assert [json.loads(record.read_text())["run"]["case"] for record in records] == [
        f"camera-{k:04d}" for k in range(5, 8)
    ]
    assert verify(ran) == []


def test_the_table_counts_every_sheet(ran):
    assert "| disc | stiff | soft | 3 | median |" in (ran / "populations/many.md").read_text()
