"""Tables, figures and explorers name all that they read, and a run names all that it leaves."""

from pathlib import Path

from hypernode.config.loading import check_config, load_config
from hypernode.pipeline.dag import run_benchmarks, run_files, run_stages
from hypernode.pipeline.shown import (
    explored_runs,
    explorer_inputs,
    figure_inputs,
    first_page_settings,
    table_inputs,
)
from tests.pipeline.test_dag import config_with


def test_a_run_leaves_the_files_of_its_stages_and_of_those_that_it_shares():
    config = config_with(longer={"training": {"iterations": 9}})
    files = run_files(config, "a", "longer")
    assert files[:3] == ["results/a/true_material.nc", "results/a/forward.nc", "results/a/measurement.nc"]
    assert files[-2:] == ["results/a/longer/material.nc", "results/a/longer/evaluation.nc"]
    assert "results/a/m/pretrained.nc" in files and "results/a/longer/pretrained.nc" not in files


def test_a_run_passes_no_stage_that_it_does_not_have():
    idle = {"iterations": 0}
    config = config_with(
        short={"training": idle, "initialisation": idle, "interpolant": None},
        plain={"baseline": "homogeneous"},
    )
    assert run_stages(config, "m") == [
        "gradient", "interpolant", "homogenised", "initialised", "pretrained", "material"
    ]  # fmt: skip
    assert run_stages(config, "short") == ["gradient", "homogenised", "material"]
    assert run_stages(config, "plain") == ["gradient", "material"]


def test_the_time_of_a_shared_stage_is_that_of_the_run_that_computed_it():
    config = config_with(longer={"training": {"iterations": 9}}, short={"training": {"iterations": 0}})
    folder = "results/benchmarks/a"
    sheet = [f"{folder}/{stage}.jsonl" for stage in ("true_material", "forward", "measurement")]
    assert run_benchmarks(config, "a", "longer") == [
        *sheet, f"{folder}/longer/training.jsonl", f"{folder}/longer/evaluation.jsonl"
    ]  # fmt: skip
    assert f"{folder}/m/initialisation.jsonl" in run_benchmarks(config, "a", "m")
    assert f"{folder}/short/pretraining.jsonl" in run_benchmarks(config, "a", "short")


def test_a_table_of_times_reads_the_benchmarks_of_its_runs_and_other_tables_none():
    raw = config_with(longer={"training": {"iterations": 9}}).model_dump()
    raw["tables"] = {"times": {"kind": "timing", "runs": ["a/longer"]}, "errors": {"runs": ["a/*"]}}
    config = check_config(raw)
    times = table_inputs(config, "times", ["a"])
    assert times["results"] == ["results/a/longer/evaluation.nc"]
    assert times["benchmarks"] == run_benchmarks(config, "a", "longer")
    assert table_inputs(config, "errors", ["a"]) == {
        "results": ["results/a/m/evaluation.nc", "results/a/longer/evaluation.nc"]
    }


def test_an_explorer_reads_its_run_the_one_beside_it_and_sheets_of_its_phases():
    raw = config_with(longer={"training": {"iterations": 9}}).model_dump()
    raw["explorers"] = [{"case": "a", "method": "longer", "beside": "m"}]
    config = check_config(raw)
    assert explored_runs(config, ["a"]) == {("a", "longer"): "m"}
    assert explored_runs(config, []) == {}
    own = {
        "measurement": "results/a/measurement.nc",
        "truth": "results/a/true_material.nc",
        "material": "results/a/longer/material.nc",
        "evaluation": "results/a/longer/evaluation.nc",
    }
    beside = {f"beside_{key}": file.replace("longer", "m") for key, file in own.items()}
    assert explorer_inputs(config, "a", "longer", ["a"]) == own | beside
    assert explorer_inputs(config, "a", "m", ["a"]) == {key.removeprefix("beside_"): f for key, f in beside.items()}


def test_a_figure_reads_the_homogenised_material_and_the_deformation_of_the_run_that_computed_them():
    raw = config_with(longer={"training": {"iterations": 9}}).model_dump()
    row = {"case": "a", "method": "longer", "label": "longer"}
    raw["figures"] = {
        "data": {"kind": "deformation", "runs": [row]},
        "breakdown": {"kind": "comparison", "stretches": [1.1], "runs": [row | {"stage": "homogenised"}]},
    }
    config = check_config(raw)
    assert figure_inputs(config, "data") == {
        "field0": "results/a/m/interpolant.nc",
        "measurement0": "results/a/measurement.nc",
        "evaluation0": "results/a/longer/evaluation.nc",
    }
    assert figure_inputs(config, "breakdown")["run0"] == "results/a/m/homogenised.nc"


def test_the_first_page_names_the_runs_whose_data_a_figure_of_pictures_shows():
    config = load_config(Path(__file__).resolve().parents[2] / "config/pictures.yaml")
    figures = first_page_settings(config, list(config.cases), [], {})["figures"]
    assert figures["X_pyvale_pictures"] == ("pictures", ["X_pyvale/hypernode"])
