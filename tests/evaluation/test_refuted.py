"""The law is refuted where something grows with the test, and nowhere by noise or by an error of the reference."""

import numpy as np
import pytest

from hypernode.evaluation.refuted import Refuted, growth, judge_refuted
from hypernode.evaluation.thresholds import SETTINGS
from hypernode.verdict import Level
from tests.evaluation.files import square_mesh

MESH, STEPS, SHEETS = square_mesh(16), 5, 200
DEFORMATION = 0.05 * np.arange(1, STEPS + 1)
SHAPE = (STEPS, len(MESH.nodes), 2)
HERE = (np.linalg.norm(MESH.centres - [0.3, 0.6], axis=1) < 0.15, np.linalg.norm(MESH.nodes - [0.3, 0.6], axis=1) < 0.2)


def noise(seed):
    return np.random.default_rng(seed).normal(size=SHAPE)


def test_noise_refutes_no_law():
    assert sum(growth(MESH, noise(seed), DEFORMATION)[1].any() for seed in range(SHEETS)) <= 2


def test_an_error_of_the_reference_refutes_no_law():
    reference = 3.0 * np.random.default_rng(5).normal(size=SHAPE[1:])
    assert not any(growth(MESH, noise(seed) + reference, DEFORMATION)[1].any() for seed in range(20, 40))


def test_what_grows_in_a_place_is_found_there_at_its_size():
    part = 3.0 * HERE[1][:, None] * np.ones(2) * (DEFORMATION / DEFORMATION.max())[:, None, None]
    sizes = []
    for seed in range(20, 40):
        size, cells = growth(MESH, noise(seed) + part, DEFORMATION)
        assert cells[HERE[0]].mean() > 0.8
        assert not cells[np.linalg.norm(MESH.centres - [0.3, 0.6], axis=1) > 0.4].any()
        sizes.append(np.median(size[np.linalg.norm(MESH.centres - [0.3, 0.6], axis=1) < 0.08]))
    assert np.mean(sizes) == pytest.approx(3.0, rel=0.1), "the size is that at the largest step"


def test_lost_points_say_nothing():
    residual = noise(3)
    residual[:, HERE[1]] = np.nan
    residual[0, 0] = np.nan
    size, cells = growth(MESH, residual, DEFORMATION)
    assert np.isfinite(size).all() and not cells.any()


@pytest.mark.parametrize(("share", "missed", "level"), [(0.1, 0.02, "warn"), (0.1, 0.005, "pass"), (0.4, 0.02, "fail")])
def test_only_deformation_that_counts_is_held_against_a_law(share, missed, level):
    cells = np.arange(100) < 100 * share
    found = Refuted(cells * 3.0, cells, cells * missed)
    assert judge_refuted(found, SETTINGS).level == level
    assert judge_refuted(None, SETTINGS).level is Level.NOT_JUDGED
