"""The convex basis: what it contains, and that it is convex, consistent and stress-free at rest."""

import jax
import numpy as np
import pytest
import scipy.optimize

from hypernode.mechanics.closed_forms import compressible_neo_hookean, demiray, goh, hgo, mooney_rivlin, neo_hookean
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, RIGID, ConvexBasis
from hypernode.mechanics.kinematics import Invariants, invariants
from hypernode.mechanics.parameters import BASIS_TERMS
from tests.sheets import SCALE

#: All terms of an incompressible sheet, and of a compressible one.
BASES = [tuple(term for term in BASIS_TERMS if term not in others) for others in (("J",), ("I2", "ogden"))]


def stress_of(energy, F, params, angle=0.0):
    return jax.grad(lambda F: energy(invariants(F, angle), params))(F)


def test_the_basis_contains_mooney_rivlin_and_stiffening_fibres():
    F = np.array([[1.15, 0.08], [-0.03, 1.05]])
    basis = ConvexBasis(("I2",), SCALE)
    found = basis.stress(F, np.array([np.log(0.3), np.log(1.0 + 0.1 / 0.3)]))
    wanted = stress_of(mooney_rivlin, F, {"C10": 0.3, "C01": 0.1})
    np.testing.assert_allclose(found, wanted, rtol=1e-4)
    basis, strength, angle, kappa = ConvexBasis(("fibre",), SCALE), 4.0, 0.4, 0.1
    # kappa (I1 - 3) + (1 - 3 kappa)(I4 - 1) = (1 - 2 kappa) E with b = kappa / (1 - 2 kappa); k2 small: <E>^2.
    b = kappa / (1.0 - 2.0 * kappa)
    params = np.array([np.log(0.5), strength * np.cos(2 * angle), strength * np.sin(2 * angle), np.log(b / (1 - b))])
    k1 = 0.5 * (strength - 0.02) / SCALE / (1.0 - 2.0 * kappa) ** 2
    wanted = stress_of(goh, F, {"C10": 0.5, "k1": k1, "k2": 1e-9, "kappa": kappa}, angle)
    np.testing.assert_allclose(basis.stress(F, params), wanted, rtol=2e-3)


@pytest.mark.parametrize(
    ("name", "exponent"), [("log1p_ogden_6", 6.0), ("log1p_ogden_4", 4.0), ("log1p_ogden_minus_4", -4.0)]
)
def test_the_basis_contains_powers_of_the_principal_stretches_as_stiff_as_the_others_for_small_strains(name, exponent):
    """c / 2 (4 / a^2) sum l^a beside c / 2 (I1 - 3): both have half of the shear modulus 2 c."""
    basis, F = ConvexBasis(("ogden",), SCALE), np.array([[1.15, 0.08], [-0.03, 1.05]])
    params = {key: 0.0 for key in basis.names} | {name: np.log(2.0)}

    def energy(F):
        squared = jax.numpy.linalg.eigvalsh(F.T @ F)
        stretches = jax.numpy.concatenate([squared, 1.0 / jax.numpy.prod(squared, keepdims=True)])
        powers = 4.0 / exponent**2 * jax.numpy.sum(stretches ** (exponent / 2.0))
        return 0.5 * (jax.numpy.sum(stretches) + powers)

    # The other powers vanish but for half a hundredth of c.
    found, wanted = basis.stress(F, np.array(list(params.values()))), jax.grad(energy)(F)
    np.testing.assert_allclose(found, wanted, atol=0.01 * np.linalg.norm(wanted))


@pytest.mark.parametrize("k2", [0.5, 20.0])
def test_the_basis_contains_fibres_whose_stress_rises_exponentially(k2):
    F = np.array([[1.15, 0.08], [-0.03, 1.1]])
    basis, k1, angle, kappa = ConvexBasis(("fibre", "stiffening"), SCALE), 0.8, 0.4, 0.1
    b, h = kappa / (1.0 - 2.0 * kappa), k2 * SCALE**2 * (1.0 - 2.0 * kappa) ** 2
    strength = k1 * SCALE * (1.0 - 2.0 * kappa) ** 2 / 0.5 * np.exp(h / 2.0)
    length = np.sqrt((strength + 0.02) ** 2 - 0.02**2)
    fibre = length * np.array([np.cos(2 * angle), np.sin(2 * angle)])
    params = np.array([np.log(0.5), *fibre, np.log(b / (1 - b)), np.log1p(h)])
    wanted = stress_of(goh, F, {"C10": 0.5, "k1": k1, "k2": k2, "kappa": kappa}, angle)
    np.testing.assert_allclose(basis.stress(F, params), wanted, rtol=3e-3)


@pytest.mark.parametrize("b", [0.5, 6.0])
def test_the_basis_contains_sheets_whose_stress_rises_exponentially_without_fibres(b):
    F = np.array([[1.2, 0.08], [-0.03, 1.1]])
    basis, h = ConvexBasis(("I1_squared", "I1_stiffening"), SCALE), b * SCALE
    found = basis.stress(F, np.array([np.log(0.5), np.log1p(h * np.exp(h / 8.0**0.5)), np.log1p(h)]))
    np.testing.assert_allclose(found, stress_of(demiray, F, {"mu": 1.0, "b": b}), rtol=1e-3)


def test_the_basis_contains_two_families_of_fibres():
    F, angle, k1 = np.array([[1.15, 0.08], [-0.03, 1.1]]), 0.4, 0.5
    basis, strength, share = ConvexBasis(("fibre", "across"), SCALE), 0.5 * SCALE / 0.5, 0.6
    fibre = (strength + 0.02) * np.array([np.cos(2 * angle), np.sin(2 * angle)])
    params = np.array([np.log(0.5), *fibre, -40.0, np.log1p(share)])
    wanted = stress_of(hgo, F, {"C10": 0.5, "k1": k1, "k1w": share * k1, "k2": 1e-9}, angle)
    # The direction of fibres is rounded by a share (0.02 / |z|)^2 / 2.
    np.testing.assert_allclose(basis.stress(F, params), wanted, rtol=3e-3)


def test_the_compressible_basis_contains_the_incompressible_sheet_and_comes_close_to_any_other():
    F = np.array([[1.15, 0.08], [-0.03, 1.05]])
    basis = ConvexBasis(("J",), SCALE)
    found = basis.stress(F, np.array([np.log(0.5), -40.0, np.log(2.0)]))
    wanted = stress_of(neo_hookean, F, {"mu": 1.0})
    # Coefficients that vanish do so gradually.
    np.testing.assert_allclose(found, wanted, rtol=1e-4, atol=1e-4)
    modes = [np.diag([s, s]) for s in (1.05, 1.1, 1.2)] + [np.diag([s, 0.93]) for s in (1.1, 1.2)]
    for K in (0.3, 1.0, 5.0):
        wanted = np.array([stress_of(compressible_neo_hookean, F, {"mu": 1.0, "K": K}) for F in modes])
        fit = scipy.optimize.least_squares(
            lambda p, wanted=wanted: (np.array([basis.stress(F, p) for F in modes]) - wanted).ravel(), basis.start
        )
        assert np.linalg.norm(fit.fun) < 0.01 * np.linalg.norm(wanted)


@pytest.mark.parametrize("terms", BASES)
def test_the_stress_of_the_basis_is_the_derivative_of_its_energy(terms):
    rng = np.random.default_rng(7)
    basis = ConvexBasis(terms, SCALE)
    for _ in range(10):
        F, params = np.eye(2) + rng.normal(0.0, 0.15, (2, 2)), rng.normal(0.0, 1.0, len(basis.names))
        np.testing.assert_allclose(
            basis.stress(F, params), jax.grad(lambda F, p=params: basis.energy(F, p))(F), rtol=1e-10, atol=1e-12
        )


@pytest.mark.parametrize("terms", BASES)
def test_the_basis_is_convex_along_rank_one_lines(terms):
    rng = np.random.default_rng(1)
    basis = ConvexBasis(terms, SCALE)
    energy = jax.jit(basis.energy)
    for _ in range(40):
        params = rng.normal(0.0, 1.5, len(basis.names))
        F, h = np.eye(2) + rng.normal(0.0, 0.15, (2, 2)), 1e-3
        line = h * np.outer(*rng.normal(size=(2, 2)))
        curvature = energy(F + line, params) - 2.0 * energy(F, params) + energy(F - line, params)
        assert curvature >= -1e-11


@pytest.mark.parametrize("terms", BASES)
def test_the_basis_is_stress_free_and_isotropic_without_fibres(terms):
    basis = ConvexBasis(terms, SCALE)
    assert np.abs(basis.stress(np.eye(2), basis.start)).max() < 1e-14
    params = basis.start
    params[[basis.names.index(name) for name in FIBRE_VECTOR]] = 0.0
    c, s = np.cos(0.7), np.sin(0.7)
    R, F = np.array([[c, -s], [s, c]]), np.array([[1.2, 0.1], [0.0, 0.95]])
    np.testing.assert_allclose(basis.stress(F @ R, params), basis.stress(F, params) @ R, atol=1e-12)
    assert Invariants(*invariants(np.eye(2), 0.0)) == (3.0, 3.0, 1.0, 1.0, 1.0)


def test_coefficients_end_where_a_material_is_rigid_beside_its_own_level():
    basis = ConvexBasis(("I1_squared", "fibre"), 0.4)
    bounded = dict(zip(basis.names, basis.highest, strict=True))
    assert bounded["log1p_I1_squared"] == pytest.approx(np.log1p(RIGID))
    assert np.isinf([bounded["log_level"], bounded["fibre_x"], bounded["logit_dispersion"]]).all()
