"""Sparse factors: exact for any symmetric matrix, one vector or several."""

import numpy as np
import pytest
import scipy.sparse

from hypernode.fem import factors as module
from hypernode.fem.factors import AT_ONCE, MANY, MOST_OF_BLOCKS, CholeskyFactors, factorise


def stiffness(n):
    """A random sparse symmetric positive definite matrix."""
    random = scipy.sparse.random(n, n, 0.1, random_state=3, format="csc")
    return (random @ random.T + scipy.sparse.identity(n)).tocsc()


@pytest.mark.parametrize("shift", [0.0, -2.0])
def test_factors_solve_definite_and_indefinite_systems_of_one_vector_and_of_several(shift):
    A = stiffness(40) + shift * scipy.sparse.identity(40)
    assert (np.linalg.eigvalsh(A.toarray()).min() > 0) == (shift == 0.0)
    factors = factorise(A)
    assert isinstance(factors, CholeskyFactors) == (shift == 0.0)
    b = np.random.default_rng(1).normal(size=(40, 3))
    np.testing.assert_allclose(A @ factors.solve(b), b, atol=1e-10)
    np.testing.assert_allclose(factors.solve(b[:, 1]), factors.solve(b)[:, 1], rtol=1e-12)


@pytest.mark.parametrize("memory", [MOST_OF_BLOCKS, 0])
def test_many_columns_have_the_solutions_that_each_has_alone_whatever_memory_blocks_may_take(memory, monkeypatch):
    monkeypatch.setattr(module, "MOST_OF_BLOCKS", memory)
    A = stiffness(40)
    b = np.random.default_rng(2).normal(size=(40, AT_ONCE + MANY))
    factors = factorise(A)
    together = factors.solve(b)
    np.testing.assert_allclose(together, np.stack([factors.solve(column) for column in b.T], axis=1), atol=1e-10)


def test_a_matrix_without_an_inverse_is_an_error():
    with pytest.raises(RuntimeError, match="singular"):
        factorise(scipy.sparse.csc_matrix(np.diag([1.0, 0.0])))
