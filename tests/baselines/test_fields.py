"""Each classical method finds on a known neo-Hookean sheet what its literature says that it finds."""

from functools import cache

import numpy as np
import pytest

from hypernode.baselines.constitutive_gap import constitutive_gap_moduli, equilibrated_stress
from hypernode.baselines.equilibrium_gap import BaselineError, equilibrium_gap_moduli, homogeneous_modulus, unit_stress
from hypernode.baselines.reciprocity_gap import locate, outline_work, reciprocity_gap_moduli, states, strain_of
from hypernode.baselines.regions import two_regions
from hypernode.baselines.updating import Sheet, updated_moduli
from hypernode.baselines.updating_cells import updated_field
from hypernode.baselines.virtual_fields import virtual_fields_moduli
from hypernode.config.methods import Method
from hypernode.config.presets import presets
from hypernode.data.loading import Loading
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.nodal_forces import nodal_force_matrices
from hypernode.mechanics.loads import make_load
from hypernode.stages.baseline import moduli_of
from tests.sheets import sheet, square


@cache
def seen(inclusion=square, load=("equibiaxial", (1.05, 1.1)), noise=0.0, cells=16):
    """(mesh, loading, F, u, moduli) of a test of a neo-Hookean sheet, which no test of the method changes."""
    kind, stretches = load
    data, mesh, params = sheet(cells, inclusion, make_load(kind, list(stretches)), noise, terms=())
    u = data["u_measured"].values[0]
    F = np.moveaxis(deformation_gradient(mesh, u), (2, 3), (0, 1))
    return mesh, Loading.of(data), F, u, np.exp(params[:, 0])


@pytest.mark.parametrize("load", [("equibiaxial", (1.05, 1.1)), ("uniaxial_x", (1.1,)), ("clamped_y", (1.1,))])
def test_virtual_fields_find_the_moduli_of_two_regions(load):
    mesh, loading, F, _, moduli = seen(load=load)
    found = virtual_fields_moduli(mesh, loading, F, square(mesh.centres).astype(int))
    np.testing.assert_allclose(found, moduli, rtol=0.02)


def test_virtual_fields_of_one_region_are_the_homogeneous_modulus():
    mesh, loading, F, _, moduli = seen(lambda X: np.zeros(len(X), bool))
    found = virtual_fields_moduli(mesh, loading, F, np.zeros(len(mesh.cells), int))
    np.testing.assert_allclose(found, moduli, rtol=1e-6)


def test_virtual_fields_of_cells_find_an_inclusion():
    mesh, loading, F, _, moduli = seen()
    found = virtual_fields_moduli(mesh, loading, F, np.arange(len(mesh.cells)))
    assert np.median(np.abs(found / moduli - 1.0)) < 0.02


def test_a_stress_in_equilibrium_balances_the_forces_and_an_equilibrated_one_stays():
    mesh, loading, F, _, moduli = seen()
    P = moduli * unit_stress(F)
    kept = equilibrated_stress(mesh, loading, P, moduli)
    assert np.abs(kept - P).max() < 0.02 * np.abs(P).max()
    wrong = P.copy()
    wrong[0, 0] *= 1.5
    D, inner = (
        nodal_force_matrices(mesh),
        ~np.any([mesh.on_edge(e) for e in ("left", "right", "bottom", "top")], axis=0),
    )
    right = mesh.on_edge("right")
    for stress, pull in ((wrong, 1.5), (equilibrated_stress(mesh, loading, wrong, moduli), 1.0)):
        force = D[0] @ stress[0, 0, -1] + D[1] @ stress[0, 1, -1]
        assert force[right].sum() == pytest.approx(pull * loading.resultant[-1, 0], rel=0.02)
    assert np.abs(force[inner]).max() < 0.05 * force[right].max()


def test_the_constitutive_gap_finds_an_inclusion():
    mesh, loading, F, _, moduli = seen()
    found, alternations = constitutive_gap_moduli(mesh, loading, F)
    assert np.median(np.abs(found / moduli - 1.0)) < 0.02 and 1 < alternations < 400


@pytest.mark.parametrize("noise", [0.0, 2e-4])
def test_updating_of_two_regions_finds_their_moduli_also_from_noisy_displacements(noise):
    mesh, loading, F, u, moduli = seen(noise=noise, cells=8)
    start = homogeneous_modulus(mesh, loading, F)
    found = updated_moduli(Sheet(mesh, loading, u, noise), square(mesh.centres).astype(int), start)
    np.testing.assert_allclose(found, moduli, rtol=0.02 if noise else 1e-4)


def test_the_linearised_misfit_of_updating_is_that_of_differences_and_has_its_adjoint():
    mesh, loading, F, u, _ = seen(cells=8)
    tested, random = Sheet(mesh, loading, u, 0.0), np.random.default_rng(0)
    level = np.log(homogeneous_modulus(mesh, loading, F)) + 0.2 * random.normal(size=len(mesh.cells))
    change, size = random.normal(size=len(mesh.cells)), 1e-5
    states = tested.states(level)
    J = tested.linearised(level, states)
    forward, missed = J.matvec(change), random.normal(size=J.shape[0])
    assert J.rmatvec(missed) @ change == pytest.approx(missed @ forward, rel=1e-9)
    ends = [tested.misfit(tested.states(level + sign * size * change)) for sign in (1.0, -1.0)]
    np.testing.assert_allclose((ends[0] - ends[1]) / (2.0 * size), forward, atol=1e-5 * np.abs(forward).max())


@pytest.mark.parametrize(("noise", "missed"), [(0.0, 1e-3), (2e-4, 0.05)])
def test_updating_of_cells_finds_an_inclusion_also_from_noisy_displacements(noise, missed):
    mesh, loading, F, u, moduli = seen(noise=noise)
    found, iterations = updated_field(Sheet(mesh, loading, u, noise), homogeneous_modulus(mesh, loading, F))
    assert np.median(np.abs(found / moduli - 1.0)) < missed and 1 < iterations < 30
    assert (two_regions(found) == square(mesh.centres)).mean() > 0.98


def test_two_regions_are_the_softer_and_the_stiffer_cells():
    mesh, loading, F, _, _ = seen()
    region = two_regions(equilibrium_gap_moduli(mesh, loading, F, seed=0)[0])
    assert (region == square(mesh.centres)).mean() > 0.95
    assert (two_regions(np.ones(5)) == 0).all()


def test_regions_by_the_constitutive_gap_survive_noise_that_those_by_the_equilibrium_gap_do_not():
    mesh, loading, F, _, _ = seen(noise=6e-4)
    moduli = constitutive_gap_moduli(mesh, loading, F)[0], equilibrium_gap_moduli(mesh, loading, F, seed=0)[0]
    by_law, by_balance = ((two_regions(each) == square(mesh.centres)).mean() for each in moduli)
    assert by_law > 0.98 and by_law > by_balance


@pytest.mark.parametrize(
    ("preset", "moduli"),
    [
        *(("virtual_fields_one", 1), ("virtual_fields", 2), ("virtual_fields_cells", 64)),
        *(("updating_regions", 2), ("updating_cells", 64), ("constitutive_gap", 64), ("homogeneous", 1)),
    ],
)
def test_a_preset_has_as_many_moduli_as_it_has_regions(preset, moduli):
    data, mesh, _ = sheet(8, square, make_load("equibiaxial", [1.05, 1.1]), 1e-4, terms=())
    F = np.moveaxis(deformation_gradient(mesh, data["u_measured"].values[0]), (2, 3), (0, 1))
    found, _ = moduli_of(Method.model_validate(presets()[preset]), data, F)
    assert len(np.unique(found)) == moduli


def test_states_of_the_reciprocity_gap_are_in_equilibrium_and_compatible_with_their_stress():
    X, h = np.random.default_rng(0).uniform(-0.5, 0.5, (5, 2)), 1e-6
    step = h * np.eye(2)
    slopes = [[(a - b) / (2 * h) for a, b in zip(states(X + d), states(X - d), strict=True)] for d in step]
    gradient = np.stack([slopes[J][0] for J in range(2)], axis=-1)
    _, stress = states(X)
    np.testing.assert_allclose(0.5 * (gradient + np.swapaxes(gradient, -1, -2)), strain_of(stress), atol=1e-7)
    np.testing.assert_allclose(sum(slopes[J][1][..., J] for J in range(2)), 0.0, atol=1e-7)


def small(inclusion):
    """A sheet under a small load, with the nodal forces along its outline."""
    mesh, loading, F, u, moduli = seen(inclusion, ("equibiaxial", (1.005,)), cells=20)
    P = moduli * unit_stress(F)
    D = nodal_force_matrices(mesh)
    force = np.stack([np.stack([D[0] @ P[i, 0, 0] + D[1] @ P[i, 1, 0] for i in range(2)], axis=-1)])
    inner = ~np.any([mesh.on_edge(e) for e in ("left", "right", "bottom", "top")], axis=0)
    force[:, inner] = 0.0
    return mesh, loading, F, u, force, moduli


def test_the_reciprocity_gap_of_a_homogeneous_sheet_vanishes():
    mesh, _, _, u, force, moduli = small(lambda X: np.zeros(len(X), bool))
    on_V, on_u = outline_work(mesh, u[0], force[0])
    assert np.abs(on_V / (2.0 * moduli[0]) - on_u).max() < 0.02 * np.abs(on_u).max()


@pytest.mark.parametrize("place", [(0.35, 0.6), (0.7, 0.3)])
def test_the_reciprocity_gap_tells_where_an_inclusion_is(place):
    mesh, loading, F, u, force, moduli = small(lambda X: np.linalg.norm(X - place, axis=1) < 0.12)
    found, mu, amount = locate(mesh, F, u, force)
    np.testing.assert_allclose(found, place, atol=0.1)
    assert mu == pytest.approx(2.0 * moduli.min(), rel=0.1) and amount > 0
    stiff = reciprocity_gap_moduli(mesh, loading, F, u, force) > 1.01 * 0.5 * mu
    np.testing.assert_allclose(mesh.centres[stiff].mean(axis=0), found, atol=0.05)


def test_without_tractions_along_the_outline_there_is_no_reciprocity_gap():
    mesh, loading, F, u, _ = seen()
    with pytest.raises(BaselineError, match="load cell tells resultants"):
        reciprocity_gap_moduli(mesh, loading, F, u, None)
