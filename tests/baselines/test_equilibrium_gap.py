"""The baselines find what they can represent, and their scale follows the measured forces."""

import numpy as np
import pytest

from hypernode.baselines.equilibrium_gap import BaselineError, equilibrium_gap_moduli, homogeneous_modulus
from hypernode.data.loading import Loading
from hypernode.fem.gradient import deformation_gradient
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square


def seen(inclusion, noise=0.0):
    """(mesh, loading, F) of an equibiaxial test of a sheet."""
    data, mesh, params = sheet(16, inclusion, make_load("equibiaxial", [1.05, 1.1]), noise)
    F = np.moveaxis(deformation_gradient(mesh, data["u_measured"].values[0]), (2, 3), (0, 1))
    return mesh, Loading.of(data), F, np.exp(params[:, 0])


def test_a_record_that_relaxes_tells_the_same_stresses_as_an_elastic_one():
    data, _, _ = sheet(4, square, make_load("equibiaxial", [1.05, 1.1]))
    factor = np.array([1.3, 1.1])
    slow = data.assign(relaxation=("load_step", factor), edge_force=data["edge_force"] * factor[:, None, None])
    elastic, relaxing = Loading.of(data), Loading.of(slow)
    for field in ("resultant", "P_average", "scale"):
        np.testing.assert_allclose(getattr(relaxing, field), getattr(elastic, field), rtol=1e-14)


def test_a_homogeneous_sheet_gives_its_modulus():
    mesh, loading, F, level = seen(lambda X: np.zeros(len(X), bool))
    # The sheet stiffens a little with stretch, which a neo-Hookean one does not.
    assert homogeneous_modulus(mesh, loading, F) == pytest.approx(level[0], rel=0.03)


def test_the_equilibrium_gap_finds_an_inclusion_from_exact_displacements():
    mesh, loading, F, level = seen(square)
    moduli, _ = equilibrium_gap_moduli(mesh, loading, F, seed=0)
    inside = square(mesh.centres)
    ratio = np.median(moduli[inside]) / np.median(moduli[~inside])
    assert ratio == pytest.approx(2.0, rel=0.05)
    assert np.median(moduli / level) == pytest.approx(1.0, rel=0.05)


def test_twice_the_forces_are_twice_the_moduli():
    mesh, loading, F, _ = seen(square, noise=1e-4)
    moduli, _ = equilibrium_gap_moduli(mesh, loading, F, seed=0)
    for key in ("resultant", "P_average", "scale"):
        getattr(loading, key)[...] *= 2.0
    doubled, _ = equilibrium_gap_moduli(mesh, loading, F, seed=0)
    np.testing.assert_allclose(doubled, 2.0 * moduli, rtol=1e-8)


def test_forces_that_push_a_stretched_sheet_are_refused():
    mesh, loading, F, _ = seen(square)
    loading.P_average[...] *= -1.0
    with pytest.raises(BaselineError, match="do not pull"):
        homogeneous_modulus(mesh, loading, F)
