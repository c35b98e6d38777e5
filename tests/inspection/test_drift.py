"""A zero of the load cell that drifts, and what looks like one."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.dic.forces.drift import drift_findings, drift_of
from tests.dic.pulls import STEP
from tests.inspection.test_situations import force_at

TIME = np.round(np.arange(0.0, 18.05, 0.1), 9)


def there_and_back(drift, way=True):
    """A record of a pull and its way back, whose zero drifts by a share of the largest force."""
    e = STEP * np.where(TIME <= 8.0, TIME, np.maximum(8.0 - 4.0 * (TIME - 8.0), 0.0))
    force = force_at(e)
    return 12.0 * e if way else None, force + drift * force.max() * np.minimum(TIME, 8.0) / 8.0


def said(force, moved=None, uncertainty=0.001, offset=None):
    test = SimpleNamespace(force_offset_uncertainty=uncertainty, force_offset=offset)
    pull = SimpleNamespace(time=np.arange(len(force)), force=force, displacement=moved)
    return " ".join(finding.sentence for finding in drift_findings(test, pull))


@pytest.mark.parametrize("drift", [-0.2, 0.04, 0.0567, 0.1, 0.1333])
def test_a_zero_that_drifts_is_said_and_the_number_that_is_advised_answers_it(drift):
    moved, force = there_and_back(drift)
    sentence = said(force, moved)
    assert "its zero seems to drift" in sentence
    advised = float(re.search(r"force_offset_uncertainty=([0-9.e-]+)", sentence)[1])
    assert advised == pytest.approx(abs(drift_of(force, moved)[0]), rel=0.1)
    assert not said(force, moved, advised)


@pytest.mark.parametrize("way", [True, False])
def test_a_zero_that_stays_is_not_said(way):
    moved, force = there_and_back(0.0, way)
    assert drift_of(force, moved)[0] == pytest.approx(0.0, abs=1e-3) and not said(force, moved)


def test_without_a_crosshead_a_standing_force_is_asked_about_and_no_uncertainty_is_advised():
    sentence = said(there_and_back(0.1, way=False)[1])
    assert "relaxed" in sentence and "?" in sentence and "force_offset_uncertainty" not in sentence


@pytest.mark.parametrize("rest", [0.05, 0.15, 0.25])
def test_a_tissue_that_is_held_and_relaxes_is_no_drift(rest):
    force = np.minimum(TIME, 4.0) / 4.0 * (rest + (1.0 - rest) * np.exp(-np.maximum(TIME - 4.0, 0.0)))
    assert not said(force)


def test_a_held_force_is_no_drift():
    time = np.arange(0.0, 20.0, 0.1)
    force = np.minimum(time, 10.0) * (1.0 - 0.02 * np.maximum(time - 10.0, 0.0) / 10.0)
    assert not said(force)


@pytest.mark.parametrize("stretch", [2.0, 3.0, 4.0])
def test_a_soft_sheet_that_is_pulled_far_pulls_near_its_beginning_without_a_drift(stretch):
    e = (stretch - 1.0) * np.interp(TIME, [0.0, 8.0, 15.9, 18.0], [0.0, 1.0, 0.019, 0.019])
    force = (1.0 + e) - (1.0 + e) ** -2
    assert np.median(force[e <= 0.02 * e.max()]) > 0.03 * force.max()
    assert not said(force, 12.0 * e)


@pytest.mark.parametrize("way", [True, False])
def test_a_declared_preload_that_is_released_is_no_drift(way):
    moved, force = there_and_back(0.0, way)
    preloaded = force + np.where(TIME <= 10.0, 0.2 * force.max(), 0.0)
    assert not said(preloaded, moved, offset=0.0)
    assert "drift" in said(preloaded, moved)
    assert "drift" in said(preloaded - np.where(TIME > 10.0, 0.2 * force.max(), 0.0), moved, offset=0.0)
