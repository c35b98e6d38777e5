import numpy as np

from hypernode.fem.mesh import rectilinear
from hypernode.training.interpolant import LEAST_VARIANCE, relative_variance


def test_f_is_most_uncertain_where_the_interpolant_misses_it():
    lines = np.linspace(0.0, 1.0, 11)
    mesh = rectilinear(lines, lines)
    misfit = np.full((3, len(mesh.cells), 2, 2), 1e-4)
    missed = np.argmin(np.linalg.norm(mesh.centres - [0.35, 0.65], axis=1))
    misfit[:, missed] = 0.05
    variance = relative_variance(mesh, misfit)
    assert variance.argmax() == missed
    np.testing.assert_allclose(variance.mean(), 1.0)
    far = np.linalg.norm(mesh.centres - mesh.centres[missed], axis=1) > 0.2
    np.testing.assert_allclose(variance[far], LEAST_VARIANCE / (1.0 + LEAST_VARIANCE), rtol=1e-2)


def test_an_interpolant_without_misfit_is_equally_certain_everywhere():
    lines = np.linspace(0.0, 1.0, 5)
    mesh = rectilinear(lines, lines)
    np.testing.assert_array_equal(relative_variance(mesh, np.zeros((1, len(mesh.cells), 2, 2))), 1.0)
