"""Homogeneous deformations of a material have the stresses of the textbook, or none."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.evaluation.curves import curve_errors, curves, score_curves
from hypernode.evaluation.fibres import angle_between_axes, score_fibres
from hypernode.evaluation.probes import indicator, preferred_direction, sampled_indicator, uniaxial_stress
from hypernode.material.field import Material
from hypernode.material.files import material_of
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.evaluation.files import closed_form, square_mesh

MESH = square_mesh(2)
X = MESH.centres
MU = np.array([1.0, 2.0, 0.5, 3.0])
SOFT = material_of(closed_form(MESH, "neo_hookean", mu=MU))
STRETCHES = np.array([0.9, 1.0, 1.1, 1.6])
GOH = {"C10": 1.0, "k1": 2.0, "k2": 0.5, "kappa": 0.1}


def no_energy(F, params):
    raise NotImplementedError


def fibrous(degrees):
    return material_of(closed_form(MESH, "goh", **GOH, fibre_angle=np.deg2rad(degrees)))


@pytest.mark.parametrize("axis", [0, 1])
def test_uniaxial_stress_of_a_neo_hookean_sheet_is_the_closed_form(axis):
    found = uniaxial_stress(SOFT, X, STRETCHES, axis)
    wanted = MU * (STRETCHES - STRETCHES**-2.0)[:, None]
    np.testing.assert_allclose(found[..., axis], wanted, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(found[..., 1 - axis], 0.0, atol=1e-12)


def test_fibres_along_the_pull_leave_no_transverse_stress_either():
    found = uniaxial_stress(fibrous(0.0), X, STRETCHES, 0)
    np.testing.assert_allclose(found[..., 1], 0.0, atol=1e-6)
    assert (np.diff(found[..., 0], axis=0) > 0).all()


def test_a_point_without_a_uniaxial_state_has_no_stress_and_does_not_hide_the_others():
    def stress(F, pushed):
        # What is pushed across can be relieved by no transverse stretch.
        P = jnp.stack([jnp.stack([F[0, 0] - 1.0, 0.0 * F[0, 1]]), jnp.stack([0.0 * F[1, 0], F[1, 1] - 1.0])])
        return jnp.where(pushed, P.at[1, 1].set(1.0 + F[1, 1] ** 2), P)

    material = Material(lambda X: jnp.asarray([False, True, False, False]), stress, no_energy, SYNTHETIC_UNITS)
    found = uniaxial_stress(material, X, [1.2], 0)[0]
    assert np.isnan(found[1]).all()
    np.testing.assert_allclose(found[[0, 2, 3]], np.tile([0.2, 0.0], (3, 1)), atol=1e-12)


def test_a_sample_near_a_material_has_the_uniaxial_stress_of_its_own_to_first_order():
    errors = []
    for change in (0.2, 0.1):
        other, best = (
            material_of(closed_form(MESH, "goh", **GOH | {"k1": k1}, fibre_angle=0.3)) for k1 in (2.0 + change, 2.0)
        )
        found = sampled_indicator(best, other, X, 1, "uniaxial_x", 1.2)[0]
        errors.append(np.abs(found / indicator(other, X, "uniaxial_x", 1.2) - 1.0).max())
    assert errors[1] < 0.3 * errors[0] < 1e-3 and errors[1] > 1e-9


def test_a_sample_without_a_uniaxial_state_of_its_own_has_the_stress_of_first_order():
    def stress(F, pushed):
        P = jnp.stack([jnp.stack([F[0, 0] - 1.0, 0.0 * F[0, 1]]), jnp.stack([0.0 * F[1, 0], F[1, 1] - 1.0])])
        return P + jnp.where(pushed, 0.5 * (F[1, 1] - 3.0) ** 2, 0.0) * jnp.array([[0.0, 0.0], [0.0, 1.0]])[..., None]

    best, other = (
        Material(lambda X, pushed=pushed: jnp.full(len(X), pushed), stress, no_energy, SYNTHETIC_UNITS)
        for pushed in (False, True)
    )
    assert np.isnan(uniaxial_stress(other, X, [1.2], 0)).all()
    np.testing.assert_allclose(sampled_indicator(best, other, X, 1, "uniaxial_x", 1.2), 0.2, atol=1e-9)


def test_single_precision_finds_the_uniaxial_stress_of_a_network():
    node = NodeMaterial(terms=("I1", "I4v"), hidden=(3,), steps=1, invariant_scale=0.4, stress_scale=1.0)
    params = jnp.tile(node.initial_params(jax.random.key(3))[:, None], (1, len(X)))

    def found(dtype):
        weights = params.astype(dtype)

        def stress(F, p):
            return node_stress(node, F.astype(dtype), p)

        return uniaxial_stress(Material(lambda X: weights, stress, no_energy, SYNTHETIC_UNITS), X, [1.0, 1.3], 0)

    np.testing.assert_allclose(found(jnp.float32), found(jnp.float64), rtol=1e-5, atol=1e-5)


def test_the_indicator_is_the_stress_of_the_load_of_the_test():
    biaxial = 2.0 * MU * (1.1 - 1.1**-5)
    np.testing.assert_allclose(indicator(SOFT, X, "biaxial", 1.1), biaxial, rtol=1e-12)
    np.testing.assert_allclose(indicator(SOFT, X, "clamped_y", 1.1), MU * (1.1 - 1.1**-2), rtol=1e-12)


@pytest.mark.parametrize("degrees", [-60.0, 0.0, 25.0, 90.0])
def test_the_preferred_direction_of_a_fibrous_material_is_that_of_its_fibres(degrees):
    anisotropy, angle = preferred_direction(fibrous(degrees), X, 1.1)
    np.testing.assert_allclose(angle_between_axes(angle, np.full(4, degrees)), 0.0, atol=1e-9)
    assert (anisotropy > 0.05).all()


def test_fibres_turned_by_ten_degrees_are_ten_degrees_off_whichever_way_round():
    judged = score_fibres(fibrous(-86.0), fibrous(84.0), X, 1.1)
    assert judged.summary["fibre_angle_error"] == pytest.approx(10.0, abs=1e-9)
    assert judged.summary["anisotropy_error"] == pytest.approx(0.0, abs=1e-12)


def test_an_isotropic_truth_has_no_fibres_to_find():
    judged = score_fibres(fibrous(10.0), SOFT, X, 1.1)
    assert not judged.summary
    np.testing.assert_allclose(judged.variables["anisotropy_true"], 0.0, atol=1e-12)


def test_a_curve_off_by_a_share_of_its_range_has_that_error():
    true = np.linspace(0.0, 2.0, 21)[:, None] * [1.0, 1.0]
    nrmse, r2 = curve_errors(true + 0.1, true)
    assert nrmse == pytest.approx(0.05, rel=1e-12)
    assert r2 == pytest.approx(1.0 - 0.01 / np.var(true), rel=1e-12)


def test_curves_follow_the_load_of_the_test_and_the_true_material_has_no_error():
    places, stretches = X[:2], np.array([1.0, 1.2])
    along = curves(SOFT, places, stretches, "uniaxial_y")
    np.testing.assert_allclose(along[:, 1, 1], MU[:2] * (1.2 - 1.2**-2), rtol=1e-12)
    np.testing.assert_allclose(curves(SOFT, places, stretches, "shear")[:, 1, 1], MU[:2] * (1.2 - 1.2**-5), rtol=1e-12)
    summary = score_curves(SOFT, SOFT, places, 1.2, "equibiaxial").summary
    assert summary == {
        "curve_nrmse_matrix": 0,
        "curve_r2_matrix": 1,
        "curve_nrmse_inclusion": 0,
        "curve_r2_inclusion": 1,
    }
