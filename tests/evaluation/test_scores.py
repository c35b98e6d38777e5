"""Errors of stress fields, weighted by area."""

import numpy as np
import pytest

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.noise import score_noise, signal_to_noise
from hypernode.evaluation.scores import contrast, relative_error

RNG = np.random.default_rng(0)
FIELD = RNG.normal(size=(3, 40, 2, 2))
AREAS = RNG.uniform(0.5, 2.0, 40)


def test_the_relative_error_of_a_scaled_field_is_the_scale():
    assert relative_error(1.07 * FIELD, FIELD, AREAS) == pytest.approx(0.07, rel=1e-12)
    assert relative_error(FIELD, FIELD, AREAS) == 0.0


def test_an_error_counts_by_the_area_of_its_cells():
    uniform = np.ones((2, 2, 2))
    wrong = uniform * np.array([1.0, 1.4])[:, None, None]
    assert relative_error(wrong, uniform, np.array([3.0, 1.0])) == pytest.approx(0.2, rel=1e-12)
    assert relative_error(wrong, uniform, np.array([1.0, 0.0])) == 0.0


def test_half_the_contrast_is_half_the_contrast_error_and_a_full_correlation():
    weight = (AREAS / AREAS.sum())[:, None, None]
    mean = np.sum(weight * FIELD, axis=-3, keepdims=True)
    error, correlation = contrast(mean + 0.5 * (FIELD - mean), FIELD, AREAS)
    assert error == pytest.approx(0.5, rel=1e-12) and correlation == pytest.approx(1.0, rel=1e-12)
    assert contrast(mean - (FIELD - mean), FIELD, AREAS) == pytest.approx((2.0, -1.0), rel=1e-12)


def test_a_uniform_truth_has_no_contrast_to_find():
    assert np.isnan(contrast(FIELD, np.ones_like(FIELD), AREAS)).all()


def test_an_error_of_a_tenth_is_twenty_decibels():
    F = np.eye(2) + 0.1 * FIELD
    assert signal_to_noise(1.1 * F, F) == pytest.approx(20.0, abs=1e-9)


def test_what_is_exact_has_no_noise_to_summarise():
    F = np.eye(2) + 0.1 * FIELD
    judged = score_noise({"measured": F, "used": 1.01 * F}, F)
    assert set(judged.variables) == {"snr_measured", "snr_used"}
    assert judged.summary == {"snr_used": pytest.approx(40.0, abs=1e-9)}


def test_two_parts_of_an_evaluation_may_not_give_one_number_twice():
    both = Judgement({"a": 1}, {"b": 2}) | Judgement({"c": 3}, {"d": 4})
    assert both == Judgement({"a": 1, "c": 3}, {"b": 2, "d": 4})
    with pytest.raises(ValueError, match="judged twice: b"):
        both | Judgement(summary={"b": 5})
