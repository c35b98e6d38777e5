"""Noisy sheets of two materials whose interface cuts cells: two materials and a line, where that is the likelier."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.evaluation.equilibrium import nodal_forces
from hypernode.fem.gradient import deformation_gradient
from hypernode.identification.gauss_newton import descend
from hypernode.identification.layered import in_layers
from hypernode.identification.layered_descent import LayeredDescent
from hypernode.identification.layered_estimate import LayeredEstimate
from hypernode.identification.left_out import predict_left_out
from hypernode.identification.problem import field_problem
from hypernode.identification.settings import STRATEGY
from hypernode.identification.strategy import _warn
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, observed_coarsely

NOISE, CELLS = 1e-3, 12
SETTINGS = Constrained(terms=[], layers=True)


def disc(X):
    return (np.linalg.norm(X - [0.48, 0.53], axis=1) < 0.27).astype(float)


def free_field(inclusion, *terms):
    """(noisy field of mixtures of a sheet that was computed on twice as many cells, share of the inclusion)."""
    settings = SETTINGS.model_copy(update={"terms": list(terms)})
    data, share = observed_coarsely(CELLS, inclusion, make_load("equibiaxial", [1.05, 1.1, 1.15]), 0.0)
    noise = np.random.default_rng(3).normal(0.0, NOISE, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + noise), NOISE).assign_attrs(mesh="finer")
    problem = field_problem(data, settings)
    assert problem.noisy and not problem.observations.own_grid
    return descend(problem, settings, "sheet", None, (), settings.tolerance), share


@pytest.fixture(scope="module")
def of_a_disc():
    """(free field, the one in layers, share of the inclusion in every cell)."""
    free, share = free_field(disc)
    return free, in_layers(free, [], SETTINGS, "sheet"), share


def test_two_materials_and_the_line_between_them_are_found(of_a_disc):
    free, found, share = of_a_disc
    assert isinstance(found, LayeredEstimate) and found.material_count == 2
    assert found.information_criterion < free.information_criterion
    stiff, soft = np.exp(found.materials[:, 0])
    assert stiff / soft == pytest.approx(2.0, rel=0.03)
    names = found.problem.basis.names
    assert np.abs(found.params[:, names.index("share")] - share).mean() < 0.02
    assert found.unexplained <= 1.0 and abs(found.excess) < 3.0


def test_the_parts_of_a_cell_are_its_layers_by_their_shares(of_a_disc):
    _, found, _ = of_a_disc
    share = found.params[:, found.problem.basis.names.index("share")]
    assert ((share > 0.1) & (share < 0.9)).sum() > 5
    F = jnp.array([[1.1, 0.02], [0.0, 1.05]])[:, :, None]
    parts = np.mean([found.basis.stress(F, part) for part in np.moveaxis(found.by_parts, 1, 0)], axis=0)
    A, B = (np.asarray(found.basis.stress(F, each[:, None])) for each in found.materials)
    np.testing.assert_allclose(parts, share * A + (1.0 - share) * B, rtol=1e-6)


def test_layers_are_in_equilibrium_where_the_mean_of_both_at_one_deformation_is_not(of_a_disc):
    _, found, _ = of_a_disc
    mesh, state = found.problem.mesh, found.states[-1]
    F = deformation_gradient(mesh, state.u)[None]
    at_one = [found.basis.stress(np.moveaxis(F[0], 0, -1), part) for part in np.moveaxis(found.by_parts, 1, 0)]
    at_one = np.moveaxis(np.mean(at_one, axis=0), -1, 0)[None]

    def left(P):
        return np.linalg.norm(nodal_forces(mesh, P)[0].ravel()[state.free])

    assert left(at_one + found.jump_stress(F)) < 0.3 * left(at_one)


def test_samples_are_stiffer_and_softer_by_as_much_as_those_of_the_free_field(of_a_disc):
    free, found, _ = of_a_disc
    samples, (_, slope) = found.samples(3, 1), free.problem.stiffness(free.params)
    factor = samples[0] - found.by_parts[0]
    for k, sample in enumerate(np.moveaxis(free.samples(3, 1)[:, :, 0], 1, 0)):
        expected = ((sample.T - free.params) * slope).sum(axis=1)
        np.testing.assert_allclose(factor[k], np.broadcast_to(expected, factor[k].shape), atol=1e-12)
    assert samples.shape == (1, 3, 2, CELLS**2) and 0.0 < factor.std() < 0.5


def test_a_left_out_step_is_predicted_by_chance(of_a_disc):
    _, found, _ = of_a_disc
    predicted = predict_left_out(found)
    assert abs(predicted.displacement - 1.0) < 4.0 / np.sqrt(2.0 * predicted.observed) and predicted.force < 3.0


@pytest.fixture(scope="module")
def of_richer_terms():
    """The free field of the same test with terms that the sheet has not."""
    return free_field(disc, "I1_squared", "I2")[0]


def near(estimate):
    """How many nodes have a distance that may change."""
    return int((np.abs(estimate.distance) < STRATEGY.layer_reach).sum())


def test_layers_are_found_from_coefficients_that_stand_where_they_have_no_slope(of_a_disc, of_richer_terms):
    _, found, _ = of_a_disc
    below = of_richer_terms.params.copy()
    below[:, 1:] = -0.15
    descent = LayeredDescent.of_halves(dataclasses.replace(of_richer_terms, params=below), "sheet")
    reached = descent.end()
    lowest = reached.basis.lowest[1:]
    assert (reached.materials[:, 1:] >= lowest).all()
    assert reached.history[-1] == pytest.approx(found.history[-1], rel=0.01)
    share = reached.params[:, reached.problem.basis.names.index("share")]
    assert np.abs(share - found.params[:, found.problem.basis.names.index("share")]).mean() < 0.01
    # A step that is left out changes nothing of them either.
    at_none = (reached.materials[:, 1:] == lowest).sum()
    assert at_none > 0 and reached.columns.shape[1] + at_none == len(reached.materials.ravel()) + near(reached)
    assert predict_left_out(reached).displacement < 1.2


def test_two_materials_are_of_the_plainest_law_that_explains_the_test(of_a_disc, of_richer_terms):
    free, found, _ = of_a_disc
    kept = in_layers(of_richer_terms, [free], SETTINGS, "sheet")
    assert kept.basis.terms == () and kept.information_criterion == pytest.approx(found.information_criterion)


def test_mixtures_stay_where_nobody_asks_for_layers_and_where_stiffness_has_a_slope(of_a_disc):
    free, _, _ = of_a_disc
    assert in_layers(free, [], Constrained(terms=[]), "sheet") is free
    slope, _ = free_field(lambda X: X[:, 0])
    assert in_layers(slope, [], SETTINGS, "sheet").trial is slope.trial


def test_a_sheet_of_one_material_gets_no_second_one():
    free, _ = free_field(lambda X: np.zeros(len(X)))
    assert in_layers(free, [], SETTINGS, "sheet").trial is free.trial


def test_two_materials_that_miss_a_test_are_warned_of_by_their_terms(of_a_disc, capsys):
    _, found, _ = of_a_disc
    _warn(dataclasses.replace(found, history=np.array([9.0])), SETTINGS, "sheet")
    assert "missed by 9.0 times" in capsys.readouterr().err.replace("\n", " ")
