"""Errors that residuals share: the small systems of Woodbury's identity are the large covariance."""

import numpy as np
import pytest

from hypernode.identification.errors import EdgeAnswers, SharedErrors

RANDOM = np.random.default_rng(0)
STEPS, SIGMA = 2, 0.7
U = [RANDOM.normal(size=(9, 4)) for _ in range(STEPS)]
OF_FORCES = [RANDOM.normal(size=(2, 4)) for _ in range(STEPS)]
LOADS = [RANDOM.normal(size=(2, 3)) for _ in range(STEPS)]
ERRORS = SharedErrors([EdgeAnswers(u, f, u.T @ u) for u, f in zip(U, OF_FORCES, strict=True)], LOADS, SIGMA)
RESIDUALS = [RANDOM.normal(size=11) for _ in range(STEPS)]
JACOBIANS = [RANDOM.normal(size=(11, 3)) for _ in range(STEPS)]


def of_edges(step):
    A = np.concatenate([U[step] / SIGMA, OF_FORCES[step]])
    return np.eye(11) + A @ A.T


@pytest.fixture(scope="module")
def covariance():
    C = np.zeros((22, 22))
    for k in range(STEPS):
        C[11 * k : 11 * k + 11, 11 * k : 11 * k + 11] = of_edges(k)
    E = np.concatenate([np.concatenate([np.zeros((9, 3)), load]) for load in LOADS])
    return C + E @ E.T


def test_the_squared_misfit_is_that_of_the_covariance(covariance):
    r = np.concatenate(RESIDUALS)
    assert ERRORS.squared(RESIDUALS) == pytest.approx(r @ np.linalg.solve(covariance, r), rel=1e-12)
    assert ERRORS.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-12)


def test_the_normal_equations_are_those_of_the_covariance(covariance):
    r, J = np.concatenate(RESIDUALS), np.concatenate(JACOBIANS)
    curvature, gradient = ERRORS.normal(JACOBIANS, RESIDUALS)
    np.testing.assert_allclose(curvature, J.T @ np.linalg.solve(covariance, J), atol=1e-12)
    np.testing.assert_allclose(gradient, J.T @ np.linalg.solve(covariance, r), atol=1e-12)


def test_white_residuals_have_the_squared_misfit_that_edges_leave():
    for k, (white, r) in enumerate(zip(ERRORS.white(RESIDUALS), RESIDUALS, strict=True)):
        assert white @ white == pytest.approx(r @ np.linalg.solve(of_edges(k), r), rel=1e-12)


def test_weighed_columns_are_those_of_the_inverse_covariance(covariance):
    wanted = np.linalg.solve(covariance, np.concatenate(JACOBIANS))
    np.testing.assert_allclose(np.concatenate(ERRORS.weighed(JACOBIANS)), wanted, atol=1e-12)
