"""A camera that takes pictures: what may stand beside it, and what cannot be."""

import copy

import pytest

from hypernode.config.errors import ConfigError
from hypernode.config.loading import check_config
from hypernode.config.slices import pictures_for
from hypernode.pipeline.dag import present_cases, run_benchmarks, run_files
from hypernode.pipeline.resources import case_size
from hypernode.pipeline.shown import figure_inputs
from tests.config.test_config import BASE


def photographed(camera=None, noise=None, figures=None):
    raw = copy.deepcopy(BASE)
    raw["cases"]["a"]["camera"] = {"pictures": {"pixels": 300}} if camera is None else camera
    if noise:
        raw["noise"]["n"] = noise
        raw["cases"]["a"]["noise"] = "n"
    return check_config(raw | ({"figures": figures} if figures else {}))


BROKEN = [
    ({}, "a camera has either cells, of a grid at which it measures, or pictures"),
    ({"cells": [5, 5], "pictures": {}}, "a camera has either cells, of a grid at which it measures, or pictures"),
    ({"cells": [5, 5], "correlation": {}}, "correlation is of pictures"),
    ({"pictures": {}, "window": 0.1}, "the window of pictures is the subset of their correlation"),
    ({"pictures": {"pixels": 64}}, "hold less than 6 correlated points of subset 25 and step 8: take more pixels"),
    ({"pictures": {"bright": 30.0}}, "dark = 40 is not darker than bright = 30: no speckle is seen"),
    ({"pictures": {"pixels": 2000}}, "reach = 64: a corner of the sheet moves by 100 pixels: set reach to 100 or more"),
    ({"pictures": {"speckles": {}}}, "pictures.speckles: unknown key; did you mean 'speckle'"),
    ({"pictures": {}, "correlation": {"engine": "pyvalle"}}, "did you mean 'pyvale'"),
    ({"pictures": {}, "correlation": {"engine": "finite_elements", "step": 9}}, "step = 9 must be even"),
    ({"pictures": {}, "correlation": {"engine": "finite_elements", "shape": "quadratic"}}, "leave out incremental and"),
]


@pytest.mark.parametrize(("camera", "sentence"), BROKEN)
def test_a_camera_that_cannot_be_is_refused_with_one_sentence(camera, sentence):
    with pytest.raises(ConfigError) as found:
        photographed(camera)
    assert sentence in str(found.value)


def test_an_incremental_correlation_looks_for_no_more_than_each_picture_moves():
    camera = {"pictures": {"pixels": 2000}, "correlation": {"incremental": True}}
    assert photographed(camera).cases["a"].photographed


@pytest.mark.parametrize(
    ("noise", "sentence"),
    [
        ({"sigma": 1e-3}, "n has sigma = 0.001, and the displacements of a photographed sheet have the errors"),
        ({"outliers": 0.01}, "n has outliers = 0.01"),
        ({"repeats": 2}, "n has 2 repeats, and a photographed sheet is tested once"),
    ],
)
def test_errors_of_displacements_are_those_of_the_pictures_alone(noise, sentence):
    with pytest.raises(ConfigError, match=sentence):
        photographed(noise=noise)
    assert photographed(noise={"force": 0.01}).cases["a"].noise == "n"


def test_a_stage_sees_only_what_it_uses():
    config = photographed()
    grey = photographed({"pictures": {"pixels": 300, "noise": 5.0}})
    subset = photographed({"pictures": {"pixels": 300}, "correlation": {"subset": 31}})
    for stage, same_grey, same_subset in (
        ("speckle", True, True), ("photograph", False, True), ("correlate", True, False)
    ):  # fmt: skip
        one = pictures_for(config, "a", stage)
        assert (one == pictures_for(grey, "a", stage)) == same_grey
        assert (one == pictures_for(subset, "a", stage)) == same_subset


def test_a_photographed_run_leaves_its_pictures_and_points_and_is_as_large_as_its_grid():
    config = photographed()
    sheet = ("true_material", "forward", "speckle", "pictures", "correlated", "measurement")
    assert run_files(config, "a", "m")[:6] == [f"results/a/{stage}.nc" for stage in sheet]
    rules = ("true_material", "forward", "speckle", "photograph", "correlate", "photographed")
    assert run_benchmarks(config, "a", "m")[:6] == [f"results/benchmarks/a/{rule}.jsonl" for rule in rules]
    fine = photographed({"pictures": {"pixels": 600}, "correlation": {"step": 4}})
    assert case_size(fine, "a").cells == 143**2 and case_size(config, "a").cells == 50 * 50


def test_a_case_whose_engine_is_absent_is_left_out_with_the_way_to_it(monkeypatch, tmp_path):
    monkeypatch.setenv("HYPERNODE_PYVALE", str(tmp_path / "python"))
    present, absent = present_cases(photographed())
    assert present == [] and len(absent) == 1
    assert absent[0].startswith("Leaving out a: the correlation engine pyvale is not installed")
    assert "make pyvale-env" in absent[0]


def test_finite_elements_need_no_engine_and_reach_nearly_to_the_edge(monkeypatch, tmp_path):
    monkeypatch.setenv("HYPERNODE_PYVALE", str(tmp_path / "python"))
    config = photographed({"pictures": {"pixels": 500}, "correlation": {"engine": "finite_elements"}})
    assert present_cases(config) == (["a"], [])
    # All but three pixels at each side, in elements of eight.
    assert case_size(config, "a").cells == 61**2


def test_a_figure_of_pictures_needs_a_case_that_takes_some():
    figures = {"f": {"kind": "pictures", "case": "a"}}
    files = figure_inputs(photographed(figures=figures), "f")
    assert files == {key: f"results/a/{key}.nc" for key in ("pictures", "correlated", "measurement")}
    with pytest.raises(ConfigError, match=r"figures\.f\.case = 'a': its camera takes no pictures"):
        photographed({"cells": [5, 5]}, figures=figures)
    with pytest.raises(ConfigError, match="no such entry in cases"):
        photographed(figures={"f": {"kind": "pictures", "case": "b"}})
