"""Laws that every material obeys, closed-form and neural alike."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.optimize

from hypernode.fem.solver import closed_form_stress
from hypernode.material.laws import node_energy, node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.closed_forms import MODELS, energy_density
from hypernode.mechanics.kinematics import REFERENCE, invariants
from hypernode.mechanics.parameters import PARAMETERS
from hypernode.networks.terms import TERMS

VALUES = {
    "mu": 1.3, "C10": 0.5, "C01": 0.2, "C20": 0.1, "C30": 0.02, "k1": 0.8, "k1w": 0.3, "k2": 0.4,
    "kappa": 0.1, "fibre_angle": 0.6, "K": 2.1,
    "alpha": -3.0, "Jm": 3.0, "b": 1.5, "c": 0.9, "a_v": 2.0, "a_w": 1.0, "a_vw": 0.5, "a_s": 0.7,
}  # fmt: skip
NODES = {
    "node": NodeMaterial(
        terms=tuple(term for term in TERMS if term != "J"),
        hidden=(4, 4),
        steps=4,
        invariant_scale=0.4,
        stress_scale=1.5,
    ),
    "compressible node": NodeMaterial(
        terms=tuple(term for term in TERMS if "I2" not in term),
        hidden=(4, 4),
        steps=4,
        invariant_scale=0.4,
        stress_scale=1.5,
    ),
}
F_SAMPLES = np.eye(2) + np.random.default_rng(3).uniform(-0.15, 0.25, (8, 2, 2))


def closed_form(name):
    params = {"model": jnp.zeros(()), **{k: jnp.asarray(VALUES[k]) for k in MODELS[name].parameters}}
    return lambda F: closed_form_stress((name,))(F, params)


def neural(name):
    node, params = NODES[name], initial(name).copy()
    params[-1] = 0.7
    return lambda F: node_stress(node, F[..., None], params[:, None])[..., 0]


@functools.cache
def initial(name):
    return np.array(jax.jit(NODES[name].initial_params)(jax.random.key(0)), float)


@functools.cache
def law(name):
    """The stress of a material, compiled as a whole for all that ask for it."""
    return jax.jit(closed_form(name) if name in MODELS else neural(name))


@functools.cache
def of_values(name):
    """The stress of a closed form as a function of its parameters too."""
    return jax.jit(closed_form_stress((name,)))


@functools.cache
def slope_of(name):
    """Its derivative along a direction."""
    return jax.jit(lambda F, params, direction: jax.jvp(lambda F: of_values(name)(F, params), (F,), (direction,))[1])


@pytest.mark.parametrize("name", [*MODELS, *NODES])
def test_stress_vanishes_at_identity(name):
    assert np.abs(law(name)(np.eye(2))).max() < 1e-12


@pytest.mark.parametrize("name", [*MODELS, *NODES])
def test_stress_is_frame_indifferent(name):
    c, s = np.cos(0.8), np.sin(0.8)
    Q, stress = np.array([[c, -s], [s, c]]), law(name)
    for F in F_SAMPLES:
        np.testing.assert_allclose(stress(Q @ F), Q @ np.asarray(stress(F)), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("name", [*MODELS, *NODES])
def test_moment_balance_P_Ft_is_symmetric(name):
    for F in F_SAMPLES:
        tau = np.asarray(law(name)(F)) @ F.T
        np.testing.assert_allclose(tau, tau.T, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("name", MODELS)
def test_energy_derivative_equals_stress(name):
    params = {"model": jnp.zeros(()), **{k: jnp.asarray(VALUES[k]) for k in MODELS[name].parameters}}
    angle = params.get("fibre_angle", 0.0)
    gradient = jax.jit(jax.grad(lambda F: energy_density((name,), invariants(F, angle), params)))
    for F in F_SAMPLES:
        np.testing.assert_allclose(law(name)(F), gradient(F), rtol=1e-9, atol=1e-12)


def test_schema_lists_the_parameters_that_models_use():
    assert {name: tuple(p) for name, p in PARAMETERS.items()} == {n: m.parameters for n, m in MODELS.items()}


def test_reduces_to_incompressible_linear_elasticity():
    mu, e = 1.3, 1e-6
    strain = np.array([[1.0, 0.4], [0.4, -0.3]])
    P = np.asarray(law("neo_hookean")(np.eye(2) + e * strain)) / e
    np.testing.assert_allclose(P, 2 * mu * (strain + np.trace(strain) * np.eye(2)), rtol=1e-4)


def test_neo_hookean_equibiaxial_stress_is_the_textbook_one():
    for stretch in (0.9, 1.1, 1.3):
        P = law("neo_hookean")(np.diag([stretch, stretch]))
        np.testing.assert_allclose(P[0, 0], 1.3 * (stretch - stretch**-5), rtol=1e-12)


def test_invariants_of_the_undeformed_state():
    np.testing.assert_allclose(invariants(jnp.eye(2), 0.3), REFERENCE, rtol=1e-14)


@pytest.mark.parametrize("stretch", [0.8, 1.0, 1.3])
def test_a_compressible_sheet_has_the_thickness_that_no_stress_acts_on(stretch):
    mu, K = VALUES["mu"], VALUES["K"]
    F = np.array([[stretch, 0.1], [0.0, 1.1]])

    def energy(F, t):
        J = t * jnp.linalg.det(F)
        return mu / 2 * (jnp.sum(F**2) + t**2 - 3 - 2 * jnp.log(J)) + K / 2 * (J - 1) ** 2

    by_stretch, by_thickness = (jax.jit(jax.grad(energy, argnums=k)) for k in (0, 1))
    t = scipy.optimize.brentq(lambda t: float(by_thickness(F, t)), 0.1, 5.0, xtol=1e-14)
    params = {"model": np.zeros(()), "mu": mu, "K": K}
    found = jax.jit(lambda F: energy_density(("compressible_neo_hookean",), invariants(F, 0.0), params))(F)
    np.testing.assert_allclose(found, jax.jit(energy)(F, t), rtol=1e-12)
    np.testing.assert_allclose(law("compressible_neo_hookean")(F), by_stretch(F, t), rtol=1e-11)


def test_a_compressible_sheet_that_hardly_changes_volume_is_the_incompressible_one():
    params, stress = {"model": np.zeros(()), "mu": 1.3, "K": 1e6}, of_values("compressible_neo_hookean")
    for F in F_SAMPLES:
        np.testing.assert_allclose(stress(F, params), law("neo_hookean")(F), rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("alpha", [2.0, -2.0, 5.0, -3.0, 1.3])
@pytest.mark.parametrize("stretches", [(1.3, 0.9), (1.2, 1.2), (1.2, 1.2001), (1.0, 1.0)])
def test_ogden_stress_is_the_textbook_one_of_principal_stretches_equal_or_not(alpha, stretches):
    """P_a = 2 mu/alpha (l_a^alpha - l3^alpha) / l_a; its tangent is that of differences, also where two are equal."""
    stress = of_values("ogden")
    params = {"model": np.zeros(()), "mu": 1.3, "alpha": alpha}
    a, b = stretches
    expected = [2.6 / alpha * (each**alpha - (a * b) ** -alpha) / each for each in stretches]
    F = np.diag(stretches)
    np.testing.assert_allclose(stress(F, params), np.diag(expected), rtol=1e-9, atol=1e-9)
    direction, h = np.array([[0.3, 1.0], [-0.4, 0.2]]), 1e-5
    ahead, behind = (np.asarray(stress(F + step * direction, params)) for step in (h, -h))
    np.testing.assert_allclose(
        slope_of("ogden")(F, params, direction), (ahead - behind) / (2 * h), rtol=1e-6, atol=1e-7
    )


def test_ogden_of_two_is_neo_hookean_and_a_slight_gent_or_demiray_sheet_nearly():
    models = {"ogden": {"alpha": 2.0}, "gent": {"Jm": 1e6}, "demiray": {"b": 1e-6}}
    for F in F_SAMPLES:
        for name, values in models.items():
            P = of_values(name)(F, {"model": np.zeros(()), "mu": 1.3, **values})
            np.testing.assert_allclose(P, law("neo_hookean")(F), rtol=1e-5, atol=1e-5)


def test_fung_stress_is_F_times_the_derivative_by_the_green_strain():
    c, a_v, a_w, a_vw, a_s = (VALUES[key] for key in ("c", "a_v", "a_w", "a_vw", "a_s"))
    angle = VALUES["fibre_angle"]
    R = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    for F in F_SAMPLES:
        E = R @ (0.5 * (F.T @ F - np.eye(2))) @ R.T
        along, across, shear = E[0, 0], E[1, 1], E[0, 1]
        Q = a_v * along**2 + a_w * across**2 + 2 * a_vw * along * across + 4 * a_s * shear**2
        # Half the derivative of Q, as the energy has c/2.
        S = np.array([[a_v * along + a_vw * across, 2 * a_s * shear], [2 * a_s * shear, a_w * across + a_vw * along]])
        expected = c * np.exp(Q) * F @ R.T @ S @ R
        np.testing.assert_allclose(law("fung")(F), expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("name", NODES)
def test_node_stress_is_the_derivative_of_the_energy_that_is_integrated_from_it(name):
    node, F = NODES[name], jnp.moveaxis(jnp.asarray(F_SAMPLES), 0, -1)
    params = np.tile(initial(name)[:, None], (1, F.shape[-1]))
    stress, gradient = jax.jit(
        lambda F: (node_stress(node, F, params), jax.grad(lambda F: jnp.sum(node_energy(node, F, params)))(F))
    )(F)
    np.testing.assert_allclose(stress, gradient, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", NODES)
def test_node_energy_is_elliptic_along_rank_one_lines(name):
    stress = neural(name)
    slope = jax.jit(lambda F, direction: jax.jvp(stress, (F,), (direction,))[1])
    rng = np.random.default_rng(1)
    for F in F_SAMPLES:
        a, b = rng.normal(size=(2, 2))
        direction = np.outer(a, b) / np.linalg.norm(np.outer(a, b))
        second = slope(jnp.asarray(F), jnp.asarray(direction))
        assert float(np.sum(second * direction)) > 0.0
