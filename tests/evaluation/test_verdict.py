"""A verdict is the worst of its criteria, and each follows from the number it names."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from hypernode.data.believed_noise import BelievedNoise, NoiseSource
from hypernode.data.believed_window import BelievedWindow
from hypernode.evaluation.criteria import judge_run
from hypernode.evaluation.explained import beside_corners, unexplained_share
from hypernode.evaluation.polish import score_polish
from hypernode.evaluation.region import score_region
from hypernode.evaluation.thresholds import SETTINGS, Threshold
from hypernode.mechanics.loads import make_load
from hypernode.verdict import Criterion, Ending, Level, Verdict
from tests.sheets import believed, sheet, square

NOISE = 1e-3
#: Observed displacements of the sheet below.
COUNT = 252
GOOD = {
    "ending": Ending.CONVERGED,
    "displacement_misfit": 1.0,
    "edge_force_error_identified": 0.005,
    "unexplained_share": 0.0,
    "largest_local_misfit": 1.2,
    "equilibrium_gap_identified": 0.01,
    "network_error": 0.001,
    "spread": 0.3,
    "spread_of_materials": 0.02,
    "inclusion": "distinguishable",
    "contrast_seen": 0.2,
    "contrast_needed": 0.0123,
    "detectable_contrast": 0.03,
    "smallest_phase": 0.015,
    "compressed_share": 0.0,
    "phases_found": 2,
}


@pytest.fixture(scope="module")
def clean():
    """A measured sheet, without noise."""
    measurement, _, _ = sheet(8, square, make_load("biaxial", [[1.05, 1.04], [1.1, 1.06]]), terms=("I1_squared",))
    return measurement.assign_attrs(outliers=0)


@pytest.fixture(scope="module")
def measurement(clean):
    return believed(clean, NOISE)


def constrained(noisy=True, law=(0.002, 0.003), noise_deformation=0.1, sigma=NOISE, **left_out):
    attributes = {
        "displacement_sigma": sigma,
        "observed_displacements": COUNT,
        "noise_rules_displacements": json.dumps(noisy),
    }
    attributes["noise_deformation"] = noise_deformation
    predicted = (
        {"steps": [1], "observed": 1800, "directions": 18.0, "displacement": 1.01}
        | {"force": 1.2, "deformation": 0.02}
        | left_out
    )
    attributes["left_out"] = json.dumps(predicted)
    return xr.Dataset(attrs={**attributes, "homogeneous_force_misfit": json.dumps(list(law))})


def judged(measurement, field=None, **numbers):
    return judge_run(GOOD | numbers, measurement, constrained() if field is None else field)


def criterion(verdict, name) -> Criterion:
    (found,) = [each for each in verdict.criteria if each.name == name]
    return found


def level(verdict, name) -> Level:
    return criterion(verdict, name).level


def test_a_good_run_passes_and_says_so_in_one_word(measurement):
    verdict = judged(measurement)
    assert verdict.label == verdict.overall == "pass"
    unjudged = [each.name for each in verdict.criteria if each.level is Level.NOT_JUDGED]
    assert unjudged == ["refuted", "force record", "level", "other deformations", "volume", "contrast"]


@pytest.mark.parametrize(("error", "level"), [(0.1, Level.PASSED), (0.5, Level.WARNED)])
def test_a_window_that_a_field_had_to_find_is_said_and_a_warning_where_it_is_hardly_known(measurement, error, level):
    field = constrained().assign_attrs(BelievedWindow(2.4, error, 0.1).stored())
    found = criterion(judged(measurement.assign_attrs(units='{"length": "mm"}'), field), "window")
    assert found.level is level and f"2.4 +- {error} mm" in found.sentence
    assert "window" not in {each.name for each in judged(measurement).criteria}


def test_the_verdict_is_the_worst_criterion_and_names_what_is_to_blame(measurement):
    verdict = judged(measurement, ending="out of iterations", spread_of_materials=0.2)
    assert verdict.label == "warn: not converged, uncertainty"
    verdict = judged(measurement, ending="out of iterations", edge_force_error_identified=0.2)
    assert verdict.label == "fail: not converged, forces"


def test_what_is_not_judged_changes_no_verdict():
    unjudged, passed = (Criterion("a", each, ".") for each in (Level.NOT_JUDGED, Level.PASSED))
    assert Verdict((unjudged, passed)).overall is Level.PASSED
    assert Verdict((unjudged,)).overall is Level.NOT_JUDGED


def test_a_stored_verdict_reads_back_as_it_was(measurement):
    verdict = judged(measurement, ending="out of iterations", spread_of_materials=0.2)
    assert Verdict.of(json.loads(json.dumps(verdict.stored()))) == verdict


def test_that_a_run_did_not_converge_is_said_before_what_is_worse(measurement):
    verdict = judged(measurement, ending="out of iterations", edge_force_error_identified=0.2)
    assert "did not converge" in verdict.sentences[0] and verdict.sentences[1].startswith("Edge forces")


def test_a_run_that_did_not_converge_fails_only_where_it_does_not_explain_the_displacements(measurement):
    for ending in ("stagnated", "out of iterations"):
        for misfit, wanted in ((0.5, Level.WARNED), (1.0, Level.WARNED), (1.5, Level.FAILED), (3.0, Level.FAILED)):
            verdict = judged(measurement, ending=ending, displacement_misfit=misfit)
            assert level(verdict, "convergence") is wanted
            assert ending in criterion(verdict, "convergence").sentence


def test_cells_of_their_own_that_leave_more_than_noise_warn_although_elements_may_err_as_much(measurement, clean):
    coarse = constrained(noisy=False, sigma=15.0 * NOISE)
    missed = judged(measurement, coarse, displacement_misfit=0.2)
    assert level(missed, "displacements") is Level.WARNED
    assert "3 times their noise" in criterion(missed, "displacements").sentence
    for field, numbers in ((coarse, 0.05), (coarse.assign_attrs(materials=2), 0.2)):
        assert level(judged(measurement, field, displacement_misfit=numbers), "displacements") is Level.PASSED
    assert level(judged(clean, coarse, displacement_misfit=0.2), "displacements") is Level.PASSED
    louder = coarse.assign_attrs(BelievedNoise(factor=1.5).stored())
    assert (
        "1.5 times the assumed one"
        in criterion(judged(measurement, louder, displacement_misfit=0.05), "displacements").sentence
    )


def test_the_misfit_of_noise_may_exceed_one_by_chance_and_no_more(measurement):
    by_chance = 3.0 / np.sqrt(2.0 * COUNT)
    assert by_chance > SETTINGS.noise_known, "on so few displacements chance is the wider of the two"
    for misfit, wanted in (
        (0.79, Level.WARNED),
        (0.81, Level.PASSED),
        (1.0 + 0.99 * by_chance, Level.PASSED),
        (1.0 + 1.01 * by_chance, Level.WARNED),
        (2.01, Level.FAILED),
    ):
        assert level(judged(measurement, displacement_misfit=misfit), "displacements") is wanted


@pytest.mark.parametrize(
    ("noise", "said"),
    [
        (BelievedNoise(factor=0.3), "0.3 times the assumed one"),
        (BelievedNoise(NoiseSource.FRAMES), "the stated noise is wrong"),
    ],
)
def test_a_field_of_another_noise_than_was_believed_warns_though_it_explains_the_test(measurement, noise, said):
    field = constrained().assign_attrs(noise.stored())
    found = criterion(judged(measurement, field), "displacements")
    assert found.level is Level.WARNED and said in found.sentence
    assert level(judged(measurement, field, displacement_misfit=2.1), "displacements") is Level.FAILED


@pytest.mark.parametrize(("deformation", "wanted"), [(0.01, Level.PASSED), (0.1, Level.WARNED)])
def test_more_noise_than_assumed_counts_by_the_deformation_that_the_rest_amounts_to(measurement, deformation, wanted):
    louder = constrained(noise_deformation=deformation).assign_attrs(BelievedNoise(factor=1.5).stored())
    found = criterion(judged(measurement, louder), "displacements")
    assert found.level is wanted and f"{100.0 * deformation * np.sqrt(1.0 - 1.5**-2):.3g} % of" in found.sentence


@pytest.mark.parametrize("kind", [{"materials": 2}, {"materials": 0, "gradual": "true"}])
def test_a_field_of_few_numbers_cannot_fit_noise_so_that_less_of_it_is_no_warning(measurement, kind):
    for factor, wanted in ((0.5, Level.PASSED), (1.5, Level.WARNED)):
        field = constrained().assign_attrs(BelievedNoise(factor=factor).stored()).assign_attrs(kind)
        found = criterion(judged(measurement, field), "displacements")
        assert found.level is wanted and f"{factor} times the assumed one" in found.sentence
    found = criterion(judged(measurement, constrained().assign_attrs(kind), displacement_misfit=0.7), "displacements")
    assert found.level is Level.PASSED and "stated too large." in found.sentence


def test_steps_that_are_left_out_are_predicted_or_the_worse_of_displacements_and_forces_says_by_how_much_not(
    measurement,
):
    for left_out, wanted, told in (
        ({}, Level.PASSED, "displacements"),
        ({"force": None}, Level.PASSED, "displacements"),
        ({"displacement": 1.51, "deformation": 0.04}, Level.WARNED, "displacements of the largest load steps"),
        ({"displacement": 1.51}, Level.PASSED, "2 % of the deformation, within what an answer may be off"),
        ({"displacement": 1.51, "directions": 4.5}, Level.PASSED, "displacements"),
        ({"displacement": 1.51, "deformation": None}, Level.WARNED, "displacements of the largest load steps"),
        ({"displacement": 3.1, "deformation": 0.06, "force": 4.0}, Level.FAILED, "6 % of the deformation"),
        ({"displacement": 3.1, "deformation": None}, Level.FAILED, "displacements"),
        ({"displacement": float("nan")}, Level.FAILED, "displacements"),
        ({"force": 3.1}, Level.WARNED, "forces of the largest load steps"),
        ({"force": 10.5}, Level.FAILED, "forces"),
        ({"force": float("nan")}, Level.FAILED, "forces"),
    ):
        found = criterion(judged(measurement, constrained(**left_out)), "prediction")
        assert found.level is wanted and told in found.sentence
    alone = constrained()
    del alone.attrs["left_out"]
    assert level(judged(measurement, alone), "prediction") is Level.NOT_JUDGED


def test_what_is_missed_beyond_a_very_small_noise_counts_by_the_deformation_that_it_stands_for(measurement):
    precise = constrained(noise_deformation=0.002)
    for misfit, wanted in ((1.5, Level.PASSED), (3.0, Level.WARNED), (9.0, Level.FAILED)):
        found = criterion(judged(measurement, precise, displacement_misfit=misfit), "displacements")
        assert found.level is wanted and ("hardly changes the stress" in found.sentence) is (misfit < 9.0)


def test_places_count_where_what_is_missed_there_is_deformation_that_counts_and_no_corner(clean):
    grid = clean[["X", "cells", "corners"]]
    misfit, unexplained = np.full(64, 9.0), np.zeros(64, int)
    # One cell of the middle, one whose misfit is small, and one whose local mean contains a corner.
    unexplained[[27, 28, 9]] = 1
    misfit[28] = 2.0
    places = {"local_misfit": ("cell", misfit), "unexplained": ("cell", unexplained)}
    field = grid.assign(places).assign_attrs(noise_deformation=0.002, misfits=json.dumps({"displacement": 1.0}))
    assert unexplained_share(field, SETTINGS) == 1.0 / 64.0
    assert unexplained_share(field.assign_attrs(noise_deformation=0.1), SETTINGS) == 2.0 / 64.0


@pytest.mark.parametrize(("side", "left_out"), [(8, 16), (4, 0)])
def test_cells_beside_corners_are_left_out_where_others_remain(side, left_out):
    measurement, _, _ = sheet(side, square, make_load("biaxial", [[1.05, 1.04]]))
    assert beside_corners(measurement).sum() == left_out


def test_what_a_line_leaves_open_inside_a_cell_is_said_and_is_no_doubt_of_materials(measurement):
    found = criterion(judged(measurement), "uncertainty")
    assert found.level is Level.PASSED and found.value == 0.02
    assert "With that of cells that interfaces may cut it is 30 %." in found.sentence


def test_a_window_smaller_than_a_step_between_points_is_known_by_what_it_changes(measurement):
    step = float(np.diff(np.unique(measurement["X"].values[:, 0])).mean())
    for side, wanted in ((0.3, Level.PASSED), (2.0, Level.WARNED)):
        window = BelievedWindow(side * step, 0.3 * side * step, 0.1)
        field = constrained().assign_attrs(window.stored())
        given = measurement.assign_attrs(units='{"length": "mm"}')
        assert level(judged(given, field), "window") is wanted


def test_more_than_a_fiftieth_of_the_sheet_that_is_not_explained_warns_and_a_quarter_fails(measurement):
    for share, wanted in ((0.0, Level.PASSED), (0.019, Level.PASSED), (0.24, Level.WARNED), (0.26, Level.FAILED)):
        found = criterion(judged(measurement, unexplained_share=share, largest_local_misfit=1.7), "places")
        assert found.level is wanted and ("1.70 times" in found.sentence) is bool(share)


def test_the_misfit_of_drawn_noise_is_within_chance(measurement):
    draws = np.random.default_rng(0).normal(size=(200, COUNT))
    levels = [
        level(judged(measurement, displacement_misfit=misfit), "displacements")
        for misfit in np.sqrt(np.mean(draws**2, axis=1))
    ]
    assert levels.count(Level.PASSED) >= 198


def test_without_noise_a_small_misfit_is_well_and_a_large_one_is_not(clean):
    field = constrained(noisy=False)
    for misfit, wanted in ((0.02, Level.PASSED), (1.5, Level.WARNED), (7.6, Level.FAILED)):
        assert level(judged(clean, field, displacement_misfit=misfit), "displacements") is wanted


@pytest.mark.parametrize(
    ("name", "key", "threshold"),
    [
        ("forces", "edge_force_error_identified", Threshold(0.03, 0.10)),
        ("equilibrium", "equilibrium_gap_identified", SETTINGS.equilibrium),
        ("uncertainty", "spread_of_materials", SETTINGS.spread),
    ],
)
def test_a_relative_number_warns_and_fails_beyond_its_thresholds(measurement, name, key, threshold):
    for value, wanted, limit in (
        (0.9 * threshold.warn, Level.PASSED, threshold.warn),
        (1.1 * threshold.warn, Level.WARNED, threshold.warn),
        (1.1 * threshold.fail, Level.FAILED, threshold.fail),
    ):
        found = criterion(judged(measurement, **{key: value}), name)
        assert (found.level, found.value) == (wanted, value) and found.threshold == pytest.approx(limit)


def test_what_no_material_of_the_basis_follows_is_judged_by_the_worst_load_case(measurement):
    for law, wanted in (((0.01, 0.002), Level.PASSED), ((0.002, 0.05), Level.WARNED), ((0.3, 0.002), Level.FAILED)):
        assert level(judged(measurement, constrained(law=law)), "law") is wanted


def test_forces_are_judged_against_the_uncertainty_that_is_stated_for_them(measurement):
    uncertain = measurement.assign_attrs(force_uncertainty=0.02)
    for value, wanted in ((0.05, Level.PASSED), (0.07, Level.WARNED), (0.21, Level.FAILED)):
        assert level(judged(uncertain, edge_force_error_identified=value), "forces") is wanted


def test_more_points_that_were_mistaken_than_one_in_a_hundred_are_warned_of(measurement):
    points = measurement.sizes["load_step"] * measurement.sizes["node"]
    for share, wanted in ((0.005, Level.PASSED), (0.05, Level.WARNED), (0.2, Level.FAILED)):
        assert level(judged(measurement.assign_attrs(outliers=round(share * points))), "outliers") is wanted


def test_a_number_that_is_not_finite_fails_and_is_stored_as_none(measurement):
    for key, name in (
        ("equilibrium_gap_identified", "equilibrium"),
        ("displacement_misfit", "displacements"),
        ("edge_force_error_identified", "forces"),
    ):
        for value in (np.nan, np.inf):
            found = criterion(judged(measurement, **{key: value}), name)
            assert found.level is Level.FAILED and found.value is None
    assert level(judged(measurement, constrained(law=(0.001, np.nan))), "law") is Level.FAILED


def test_a_method_without_an_equilibrium_field_is_judged_by_forces_and_equilibrium(measurement):
    numbers = {key: GOOD[key] for key in ("edge_force_error_identified", "equilibrium_gap_identified")}
    verdict = judge_run(numbers, measurement)
    found = [each.name for each in verdict.criteria if each.level is not Level.NOT_JUDGED]
    assert verdict.label == "pass" and found == ["outliers", "forces", "equilibrium"]


def test_the_sides_of_a_cut_grid_carry_forces_so_that_its_equilibrium_is_not_judged(measurement):
    verdict = judged(measurement.assign_attrs(outline="cut"), equilibrium_gap_identified=0.9)
    assert level(verdict, "equilibrium") is Level.NOT_JUDGED


def test_that_there_is_no_inclusion_is_an_answer_and_no_failing(measurement):
    there = criterion(judged(measurement), "inclusion")
    assert there.level is Level.PASSED and (there.value, there.threshold) == (0.2, 0.0123)
    assert there.sentence == "Two phases are distinguishable: they explain 20 % of the stiffness, and noise 1.23 %."
    none = criterion(judged(measurement, inclusion="none distinguishable", contrast_seen=0.01), "inclusion")
    assert none.level is Level.PASSED and "contrasts above 3 % would have been seen of a fifth" in none.sentence
    assert "a phase twice as stiff from 1.5 % of it on" in none.sentence
    assert "and finite elements 1 %" in criterion(judged(measurement, contrast_needed=0.01), "inclusion").sentence
    unknown = criterion(judged(measurement, inclusion="not judged"), "inclusion")
    assert unknown.level is Level.NOT_JUDGED


def test_what_the_checks_of_a_force_record_found_is_a_warning_in_their_words(measurement):
    said = ["The force does not rise with the stretch."]
    verdict = judged(measurement.assign_attrs(force_findings=json.dumps(said)))
    assert verdict.label == "warn: force record" and said[0] in criterion(verdict, "force record").sentence
    assert judged(measurement.assign_attrs(force_findings="[]")).label == "pass"


def test_a_stored_verdict_is_strict_json_with_every_criterion(measurement):
    verdict = judged(measurement, equilibrium_gap_identified=np.nan)
    stored = json.loads(json.dumps(verdict.stored(), allow_nan=False))
    assert stored["overall"] == "fail" and len(stored["criteria"]) == len(verdict.criteria)
    assert all(each.keys() == {"name", "level", "value", "threshold", "sentence"} for each in stored["criteria"])


def test_thresholds_are_settings(measurement):
    strict = replace(SETTINGS, spread=Threshold(0.01, 0.015))
    assert judge_run(GOOD, measurement, constrained(), strict).label == "fail: uncertainty"


def polished(kept=True, ending="converged", **misfits):
    """A file of a polished material, with held-out misfits of displacements and forces before and after."""
    held_out = {"before": {"displacement": 1.4, "force": 5.0}, "after": {"displacement": 1.01, "force": 1.2}}
    found = {"kept": kept, "reason": "a reason", "ending": ending, "misfits": {"held_out": held_out | misfits}}
    return xr.Dataset(attrs={"polished": json.dumps(found)})


def test_polished_networks_are_judged_by_what_they_have_not_seen_and_not_by_the_field_that_they_left(measurement):
    summary = {**score_polish(polished()).summary, "network_error": 0.05}
    found = criterion(judged(measurement, **summary), "networks")
    assert found.level is Level.PASSED and "1.01" in found.sentence and "not 5" in found.sentence
    ended = {**score_polish(polished(ending="out of iterations")).summary, "network_error": 0.05}
    assert level(judged(measurement, **ended), "networks") is Level.WARNED


def test_a_polished_network_that_is_not_kept_leaves_the_judgement_of_the_one_before(measurement):
    summary = score_polish(polished(kept=False)).summary
    assert summary["held_out_force_misfit"] == summary["held_out_force_misfit_before"] == 5.0
    assert summary["polish"] == "not kept" and summary["polish_reason"] == "a reason"
    assert level(judged(measurement, **summary, network_error=0.05), "networks") is Level.WARNED
    assert score_polish(xr.Dataset()).summary == {}


def test_the_region_of_deformations_is_that_of_the_principal_stretches():
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    F = np.stack([turn @ np.diag(stretches) for stretches in ((1.3, 0.9), (1.1, 0.8), (1.0, 1.0))])[None]
    assert score_region(F).summary == pytest.approx({"smallest_stretch": 0.8, "largest_stretch": 1.3})


def test_forces_that_are_wrong_by_orders_of_magnitude_are_not_told_to_the_digit(measurement):
    found = criterion(judged(measurement, edge_force_error_identified=2.4e9), "forces")
    assert found.sentence == "Edge forces are missed by 1000 % and more, more than 10 %."


def test_few_materials_that_explain_a_sheet_follow_the_forces_where_no_single_one_does(measurement):
    """The mean force of unlike materials has a course of its own."""
    heterogeneous = constrained(law=(0.03,))
    assert level(judged(measurement, heterogeneous), "law") is Level.WARNED
    of_few = heterogeneous.assign_attrs(materials=2)
    assert level(judged(measurement, of_few), "law") is Level.PASSED
    gradual = heterogeneous.assign_attrs(materials=0, gradual="true")
    assert level(judged(measurement, gradual), "law") is Level.PASSED
    assert level(judged(measurement, of_few, edge_force_error_identified=0.025), "law") is Level.WARNED
    assert level(judged(measurement, of_few, displacement_misfit=1.4, unexplained_share=1.5), "law") is Level.WARNED


def test_no_law_is_blamed_for_less_than_forces_are_uncertain_by(clean):
    for uncertainty, missed, wanted in (
        (0.01, 0.02, Level.WARNED),
        (0.03, 0.02, Level.PASSED),
        (0.03, 0.12, Level.FAILED),
        (0.15, 0.12, Level.PASSED),
    ):
        uncertain = believed(clean, NOISE).assign_attrs(force_uncertainty=uncertainty)
        assert level(judged(uncertain, constrained(law=(missed, 0.003))), "law") is wanted
