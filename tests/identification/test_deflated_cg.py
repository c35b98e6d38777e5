"""Conjugate gradients that learn: the same answers in fewer iterations."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

from hypernode.identification import budgets
from hypernode.identification.deflated_cg import DeflatedCG

KEPT = 40


def systems(rng, count=3, n=400, outliers=10):
    """Matrices that share a few directions, of which a diagonal metric knows nothing, and differ a little."""
    directions = np.linalg.qr(rng.normal(size=(n, outliers)))[0]
    for _ in range(count):
        turned = directions + 0.01 * rng.normal(size=directions.shape) / np.sqrt(n)
        metric = scipy.sparse.diags(rng.uniform(1.0, 2.0, n)).tocsc()
        yield metric, metric.toarray() + 1e3 * turned @ np.diag(np.arange(1.0, outliers + 1)) @ turned.T


@pytest.fixture
def counted():
    """Solve a system with what is known; (solution, iterations, what is known then)."""

    def solve(metric, matrix, b, known=None):
        solution = DeflatedCG(lambda x: matrix @ x, metric, KEPT, known).solve(b, 1e-8, 500)
        assert solution.residual == pytest.approx(
            np.linalg.norm(b - matrix @ solution.x) / max(np.linalg.norm(b), 1e-300)
        )
        return solution.x, solution.iterations, solution.deflation

    return solve


def test_what_one_solve_learned_saves_the_next_ones_most_of_their_iterations(counted):
    rng, known = np.random.default_rng(0), None
    spent = []
    for metric, matrix in systems(rng):
        b = rng.normal(size=len(matrix))
        alone = counted(metric, matrix, b)[1]
        x, iterations, known = counted(metric, matrix, b, known)
        np.testing.assert_allclose(matrix @ x, b, atol=1e-6 * np.linalg.norm(b))
        spent.append((iterations, alone))
    assert spent[0][0] == spent[0][1]
    assert all(learned < 0.5 * alone for learned, alone in spent[1:])
    assert known.shape[1] <= KEPT


def test_the_kept_directions_span_those_that_the_preconditioner_misses(counted):
    rng = np.random.default_rng(1)
    metric, matrix = next(systems(rng, 1))
    known = counted(metric, matrix, rng.normal(size=len(matrix)))[2]
    values, vectors = scipy.linalg.eigh(matrix, metric.toarray())
    missed = np.linalg.qr(vectors[:, values > 100.0])[0]
    cosines = np.linalg.svd(np.linalg.qr(known)[0].T @ missed, compute_uv=False)
    assert missed.shape[1] == 10 and cosines.min() > 0.9999


def test_a_search_of_which_little_is_remembered_keeps_the_worst_directions_as_well(monkeypatch):
    monkeypatch.setattr(budgets, "REMEMBERED", 0)
    rng, kept = np.random.default_rng(2), 6
    matrix = next(systems(rng, 1, outliers=4))[1]
    metric = scipy.sparse.identity(len(matrix)).tocsc()
    solution = DeflatedCG(lambda x: matrix @ x, metric, kept).solve(rng.normal(size=len(matrix)), 1e-10, 500)
    assert solution.iterations > 3 * kept, "more than are remembered"
    values, vectors = scipy.linalg.eigh(matrix, metric.toarray())
    missed = np.linalg.qr(vectors[:, values > 100.0])[0]
    cosines = np.linalg.svd(np.linalg.qr(solution.deflation)[0].T @ missed, compute_uv=False)
    assert solution.deflation.shape[1] <= kept and missed.shape[1] == 4 and cosines.min() > 0.999


def test_a_right_hand_side_of_zero_has_the_solution_zero_and_teaches_nothing(counted):
    metric, matrix = next(systems(np.random.default_rng(2), 1))
    x, _, known = counted(metric, matrix, np.zeros(len(matrix)))
    assert not x.any() and known is None
