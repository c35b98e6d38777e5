"""What a test says of a sheet, whatever its noise, its thickness and where the camera was."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.data.believed_noise import BelievedNoise, NoiseSource
from hypernode.identification import thresholds
from hypernode.identification.problem import field_problem
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, sheet, square

SETTINGS = Constrained(terms=["I1_squared"])


def residuals(data, params):
    """(problem, misfit of the displacements of a field as stiff as this one)."""
    problem = field_problem(data, SETTINGS)
    of_problem = np.tile(problem.basis.start, (len(params), 1))
    of_problem[:, 0] = params[:, 0]
    states = problem.equilibrium.states(of_problem, problem.equilibrium.extension(of_problem))
    return problem, np.concatenate(problem.residuals(states)[0])


@pytest.mark.parametrize("shift", [0.0, 0.03])
def test_a_sheet_that_nothing_holds_along_y_may_have_been_shifted_by_the_camera(shift):
    data, _, params = sheet(8, square, make_load("uniaxial_x", [1.05, 1.1]))
    u = data["u_measured"].values.copy()
    u[..., 1] += shift
    moved = data.assign(u_measured=(data["u_measured"].dims, u))
    _, still = residuals(data, params)
    _, found = residuals(moved, params)
    np.testing.assert_allclose(found, still, atol=1e-9)


def test_the_one_point_that_keeps_a_free_sheet_in_place_is_as_wrong_as_its_noise():
    data, _, _ = sheet(8, square, make_load("uniaxial_x", [1.05]), noise=1e-3)
    (boundary,) = field_problem(data, SETTINGS).observations.boundaries
    (point,) = np.flatnonzero(boundary.mask[:, 1])
    np.testing.assert_array_equal(boundary.values[point, 1], data["u_measured"].values[0, 0, point, 1])
    own = boundary.errors[[2 * point + 1]]
    assert np.linalg.norm(own.toarray()) == pytest.approx(1e-3)


def test_a_step_that_is_twice_as_noisy_weighs_half_as_much():
    data, _, _ = sheet(8, square, make_load("uniaxial_x", [1.05, 1.1]), noise=1e-3)
    level = data["noise_level"].values * [[1.0, 1.0], [2.0, 2.0]]
    uneven = data.assign(noise_level=(("load_step", "i"), level), noise_scatter=(("load_step", "i"), level))
    even, weighted = (field_problem(d, SETTINGS).observations for d in (data, uneven))
    assert weighted.sigma == pytest.approx(np.sqrt(2.5) * 1e-3, rel=1e-3)
    for k, factor in ((0, 1.0), (1, 2.0)):
        ratio = weighted.boundaries[k].seen * weighted.sigma / (even.boundaries[k].seen * even.sigma)
        np.testing.assert_allclose(ratio, (weighted.sigma / even.sigma) ** 2 / factor, rtol=2e-3)


def test_errors_that_are_shared_are_expected_to_scatter_less_than_they_weigh():
    data, _, _ = sheet(8, square, make_load("uniaxial_x", [1.05]), noise=1e-3)
    shared = believed(data, 3e-3).assign(noise_scatter=data["noise_scatter"])
    alone, together = (field_problem(d, SETTINGS) for d in (data, shared))
    assert alone.observations.scatter == pytest.approx(1.0) and together.observations.scatter == pytest.approx(
        1 / 3, rel=1e-3
    )
    assert together.sigma == pytest.approx(3.0 * alone.sigma, rel=1e-3)


def test_a_thicker_cell_pulls_as_one_that_is_stiffer_does():
    data, mesh, _ = sheet(8, square, make_load("biaxial", [[1.05, 1.03]]))
    ratio = 1.0 + 0.3 * (mesh.centres[:, 0] - 0.5)
    charted = data.assign(relative_thickness=("cell", ratio))
    problem, thick = (field_problem(d, SETTINGS) for d in (data, charted))
    params = np.tile(problem.basis.start, (len(mesh.cells), 1))
    stiffer = params.copy()
    stiffer[:, 0] += np.log(ratio)
    guesses = problem.equilibrium.extension(params)
    (expected,), (found,) = problem.equilibrium.states(stiffer, guesses), thick.equilibrium.states(params, guesses)
    np.testing.assert_allclose(found.u, expected.u, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.force, expected.force, rtol=1e-9, atol=1e-12)


def test_what_was_measured_is_described_as_well_as_cells_are_small_and_what_was_computed_on_the_grid_better():
    load = make_load("uniaxial_x", [1.1])
    computed, measured = [], []
    for cells in (6, 12):
        data, _, _ = sheet(cells, square, load)
        for each, found in (("measured_grid", computed), ("finer", measured)):
            found.append(field_problem(data.assign_attrs(mesh=each), SETTINGS))
    assert computed[0].sigma == pytest.approx(computed[1].sigma, rel=1e-3)
    assert measured[0].sigma == pytest.approx(2.0 * measured[1].sigma, rel=1e-3)
    assert measured[1].sigma > 50.0 * computed[1].sigma
    assert all(each.blurred and not each.noisy for each in measured) and not computed[0].blurred
    divided = field_problem(data.assign_attrs(mesh="finer"), SETTINGS, 2)
    assert divided.sigma < 0.5 * measured[1].sigma


def test_noise_that_hides_what_finite_elements_miss_is_all_that_counts():
    data, _, _ = sheet(8, square, make_load("uniaxial_x", [1.1]), noise=3e-3)
    problem = field_problem(data.assign_attrs(mesh="finer"), SETTINGS)
    assert problem.noisy and problem.sharp and problem.sigma == pytest.approx(3e-3)


def test_noise_as_large_as_finite_elements_may_really_miss_rules_at_first(monkeypatch):
    data, _, _ = sheet(8, square, make_load("uniaxial_x", [1.1]), noise=4e-4)
    measured = data.assign_attrs(mesh="finer")
    at_first = field_problem(measured, SETTINGS)
    assert at_first.noisy and at_first.sigma == pytest.approx(4e-4)
    monkeypatch.setattr(thresholds, "NOISE_RULES", 1.0)
    then = field_problem(measured, SETTINGS)
    assert then.blurred and then.sigma > 1.5 * at_first.sigma


WINDOW = 0.25


def of_a_kink(uncertainty, source=NoiseSource.MEASUREMENT):
    """Observations of a sheet that bends along one line, through a window that is known to ``uncertainty``."""
    data, mesh, _ = sheet(16, square, make_load("equibiaxial", [1.05, 1.1]), noise=1e-5, window=WINDOW)
    u = np.zeros((2, len(mesh.nodes), 2))
    u[..., 0] = np.abs(mesh.nodes[:, 0] - 0.5) * [[0.1], [0.2]]
    data = data.assign(u_measured=(data["u_measured"].dims, u[None])).assign_attrs(window_uncertainty=uncertainty)
    data = data.assign_attrs(BelievedNoise(source).stored())
    return field_problem(data, SETTINGS).observations, mesh


def weights(observations, step):
    """Standard deviation of each observed number, over that of all: rows of the window's mean sum to one."""
    return 1.0 / np.asarray(observations.boundaries[step].observe.sum(axis=1)).ravel()


def test_points_whose_window_sees_a_kink_count_for_less_by_what_the_window_does_to_it():
    exact, mesh = of_a_kink(0.0)
    unsure, _ = of_a_kink(0.25)
    for step in (0, 1):
        ratio = weights(unsure, step) / weights(exact, step)
        observed = unsure.boundaries[step].observed
        away = np.abs(mesh.nodes[observed // 2, 0] - 0.5)
        along_x = observed % 2 == 0
        far, near = along_x & (away > 1.5 * WINDOW), along_x & (away < 0.2 * WINDOW)
        assert near.any() and far.any()
        np.testing.assert_allclose(ratio[far | ~along_x], 1.0)
        assert (ratio[near] > 5.0).all()


def test_the_error_of_a_window_grows_with_the_deformation_that_it_does_not_resolve():
    unsure, mesh = of_a_kink(0.25)
    observed = unsure.boundaries[0].observed
    near = (observed % 2 == 0) & (np.abs(mesh.nodes[observed // 2, 0] - 0.5) < 0.2 * WINDOW)
    np.testing.assert_allclose(weights(unsure, 1)[near] / weights(unsure, 0)[near], 2.0, rtol=0.02)


def test_an_error_of_the_window_that_nothing_shares_counts_once():
    shared, _ = of_a_kink(0.25)
    alone, _ = of_a_kink(0.25, NoiseSource.INDEPENDENT)
    assert alone.scatter == pytest.approx(1.0) and shared.scatter < 0.97


def test_beside_a_kink_alone_displacements_scatter_by_less_than_they_weigh():
    shared, mesh = of_a_kink(0.25)
    away = np.abs(mesh.nodes[:, 0] - 0.5)
    np.testing.assert_allclose(shared.expected[:, away > 1.5 * WINDOW, 0], 1.0)
    assert (shared.expected[:, away < 0.2 * WINDOW, 0] < 0.5).all()
