"""What resultants say of the mean stress, whatever the load."""

import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.baselines.equilibrium_gap import homogeneous_modulus
from hypernode.config.methods import Constrained
from hypernode.data.loading import Loading
from hypernode.fem.equilibrium_gap import relative_gap
from hypernode.fem.gradient import deformation_gradient, mean_gradient
from hypernode.identification.problem import field_problem
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import CONSTRAINED, make_load
from tests.sheets import SCALE, sheet, square

# What a general test does to a sheet, no kind of load says.
KINDS = sorted(set(CONSTRAINED) - {"biaxial", "general"})
#: Relative error of the mean stress that resultants tell. Clamps all round carry shear along the sides, which no
#: machine records: there the mean stress is known as well as that shear is small.
EXACT, CLAMPED_ALL_ROUND = 0.01, 0.03


def nowhere(X):
    return np.zeros(len(X), bool)


def pulled(kind, inclusion=square, cells=12):
    """(loading, mesh, F[i, J, step, cell], P of the same shape) of a sheet without noise."""
    data, mesh, params = sheet(cells, inclusion, make_load(kind, [1.05, 1.1]))
    F = np.moveaxis(deformation_gradient(mesh, data["u_measured"].values[0]), (2, 3), (0, 1))
    P = ConvexBasis(("I1_squared",), SCALE).stress(jnp.asarray(F), jnp.asarray(params.T)[:, None])
    return Loading.of(data), mesh, F, np.asarray(P)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mean_stress_that_resultants_tell_is_the_mean_of_the_stress(kind):
    loading, mesh, _, P = pulled(kind)
    mean = np.moveaxis(mean_gradient(mesh, P)[..., 0], -1, 0)
    assert loading.measured.any(axis=(1, 2)).all()
    unit = np.linalg.norm(mean, axis=(1, 2))[:, None, None]
    bound = CLAMPED_ALL_ROUND if kind == "biaxial_clamped" else EXACT
    assert np.abs((loading.P_average - mean) / unit)[loading.measured].max() < bound


@pytest.mark.parametrize("kind", KINDS)
def test_every_force_of_a_held_edge_is_known_to_balance(kind):
    """The stress of the solution is in equilibrium with the edge that each component is tied to."""
    loading, mesh, _, P = pulled(kind)
    stress = np.moveaxis(P, (0, 1), (2, 3))
    gap = relative_gap(mesh, loading.constrained[0], loading.known[0], stress, loading.resultant, loading.scale)
    turned = relative_gap(mesh, loading.constrained[0], loading.known[0], stress, -loading.resultant, loading.scale)
    assert gap.max() < 0.1 * turned.min()


def test_shear_alone_tells_a_modulus():
    loading, mesh, F, P = pulled("shear", nowhere)
    modulus = homogeneous_modulus(mesh, loading, F)
    # The stiffness of a neo-Hookean sheet in pure shear, 2 c, from the stress in the middle of this one.
    middle = np.argmin(np.sum((mesh.centres - 0.5) ** 2, axis=1))
    stiffness = P[0, 1, 0, middle] / (F[0, 1, 0, middle] + F[1, 0, 0, middle])
    assert 2.0 * modulus == pytest.approx(stiffness, rel=0.1)


@pytest.mark.parametrize("kind", ["shear", "clamped_x"])
def test_a_homogeneous_sheet_that_clamps_bend_is_begun_as_what_it_is(kind):
    data, _, params = sheet(10, nowhere, make_load(kind, [1.05, 1.1, 1.15]))
    problem = field_problem(data, Constrained(terms=["I1_squared", "I2"]))
    basis, own = problem.basis, ConvexBasis(("I1_squared",), SCALE)
    F = np.moveaxis([np.diag([1.1, 1.0]), np.diag([1.1, 1.1]), [[1.0, 0.1], [0.0, 1.0]]], 0, -1)
    found = np.asarray(basis.stress(F, jnp.asarray(problem.homogeneous.params)[:, None]))
    true = np.asarray(own.stress(F, jnp.asarray(params[0])[:, None]))
    assert np.linalg.norm(found - true) < 0.03 * np.linalg.norm(true)
    assert problem.homogeneous.force_misfit.max() < 1e-3
