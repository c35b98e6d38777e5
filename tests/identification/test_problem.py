"""What equilibrium makes of a field: exact derivatives, forces that are known, errors that residuals share."""

import numpy as np
import pytest
import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.fem.transfer import transfer
from hypernode.identification import numerics
from hypernode.identification.interface_numbers import numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.problem import field_problem
from hypernode.identification.resultants import shared_errors
from hypernode.identification.sensitivities import quadrature
from hypernode.mechanics.convex_basis import RIGID
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square


@pytest.mark.parametrize("kind", ["equibiaxial", "uniaxial_x", "clamped_y"])
@pytest.mark.parametrize(("window", "subcells"), [(0.0, 1), (0.3, 1), (0.2, 2)])
def test_the_adjoint_is_the_derivative_of_the_misfit(kind, window, subcells, monkeypatch):
    # Differences need a sharper equilibrium than an identification does.
    monkeypatch.setattr(numerics, "NEWTON_TOLERANCE", 1e-10)
    data, _, params = sheet(5, square, make_load(kind, [1.1, 1.2]), noise=1e-3, window=window)
    data = data.assign_attrs(force_gain_uncertainty=0.01, force_offset_uncertainty=0.003)
    problem = field_problem(data, Constrained(terms=["I1_squared"]), subcells)
    params = params[transfer(problem.observations.grid, problem.mesh).cells]
    rng = np.random.default_rng(2)
    params = params + rng.normal(0.0, 0.1, params.shape)
    change = rng.normal(0.0, 1.0, params.size)
    sigma = problem.sigma

    states = problem.equilibrium.states(params, problem.equilibrium.extension(params))
    linear = problem.linearise(params, states, sigma)

    def residuals(params):
        u, f = problem.residuals(problem.equilibrium.states(params, problem.equilibrium.extension(params)))
        return linear.whiten(np.concatenate([*(r / sigma for r in u), f]))

    step = change.reshape(params.shape)

    def misfit(t):
        return 0.5 * np.sum(residuals(params + t * step) ** 2)

    gradient = linear.adjoint(residuals(params))
    h = 1e-5
    assert gradient @ change == pytest.approx((misfit(h) - misfit(-h)) / (2 * h), rel=1e-6)
    J = np.stack([linear.adjoint(unit) for unit in np.eye(linear.shape[0])])
    slope = (residuals(params + h * step) - residuals(params - h * step)) / (2 * h)
    np.testing.assert_allclose(J @ change, slope, atol=1e-6 * np.abs(slope).max())
    np.testing.assert_allclose(
        linear.curvature(change), J.T @ (J @ change), rtol=1e-10, atol=1e-12 * np.abs(J).max() ** 2
    )


def test_no_material_is_more_than_rigid_beside_the_sheet_nor_less_than_hardly_there():
    """However far a step would lead, and along other numbers that have bounds as well."""
    data, _, _ = sheet(5, square, make_load("clamped_y", [1.1, 1.2]), noise=1e-3)
    problem = field_problem(data, Constrained(terms=["I1_squared"]))
    lines = Lines.of(problem.observations.grid, problem.refinement)
    field = Interfaces.homogeneous(lines, problem.homogeneous.params)
    numbers = numbers_of(problem, field, field.still, None)
    for change in (50.0, -50.0):
        y = numbers.after(np.full(len(numbers.y), change), problem.basis)
        level, coefficient = y - [problem.homogeneous.params[0], 0.0]
        assert abs(level) <= np.log(RIGID) * (1.0 + 1e-9)
        assert problem.basis.lowest[1] <= coefficient <= problem.basis.highest[1]


def test_every_test_of_a_heterogeneous_sheet_is_described_by_itself_so_that_forces_keep_their_noise():
    pulled, biaxial = (sheet(8, square, make_load(kind, [1.1, 1.2]))[0] for kind in ("uniaxial_x", "equibiaxial"))
    both = xr.concat([biaxial, pulled.assign(load_case=pulled["load_case"] + 1)], "load_step", data_vars="minimal")
    both["u_measured"] = both["u_measured"].transpose("repeat", "load_step", "node", "i")
    settings = Constrained(terms=["I1_squared"])
    problem = field_problem(both, settings)
    assert problem.homogeneous.force_misfit.shape == (2,) and problem.homogeneous.force_misfit.max() < 0.01
    assert {f.step for f in problem.forces} == {0, 1, 2, 3}
    assert all(f.sigma == pytest.approx(settings.force_noise * abs(f.value)) for f in problem.forces)


def test_a_reading_is_one_datum_the_mean_of_both_ends_of_a_grid_that_is_cut_out_of_a_sheet():
    data, mesh, _ = sheet(5, square, make_load("clamped_y", [1.1]))
    whole = field_problem(data, Constrained(terms=["I1_squared"])).forces
    cut = field_problem(data.assign_attrs(outline="cut"), Constrained(terms=["I1_squared"])).forces
    assert len(cut) == len(whole) == 2
    for one, both in zip(whole, cut, strict=True):
        assert both.value == pytest.approx(one.value) and both.sigma == pytest.approx(one.sigma)
        by_edge = [
            [f.direction.reshape(-1, 2)[mesh.on_edge(edge)].sum() / 6.0 for edge in ("bottom", "top")]
            for f in (one, both)
        ]
        np.testing.assert_allclose(by_edge, [[0.0, 1.0], [-0.5, 0.5]])


def test_edges_of_a_part_answer_for_what_a_field_told_that_they_carry():
    data, mesh, _ = sheet(10, square, make_load("clamped_y", [1.1]))
    part = data.assign_attrs(outline="cut", seen_share="[[0.8, 1.0]]")
    settings = Constrained(terms=["I1_squared"])
    before = field_problem(part, settings).forces[-1]
    after = field_problem(part.assign_attrs(carried_share="[[1.0, 1.25]]"), settings).forces[-1]
    assert after.value == pytest.approx(1.25 * before.value)
    for each in (before, after):
        np.testing.assert_allclose(each.direction.reshape(-1, 2)[mesh.on_edge("top"), 1], 0.5)


@pytest.mark.slow
def test_errors_of_prescribed_edges_that_the_whole_sheet_shares_are_no_misfit_of_the_material():
    """Of the true field the whitened residuals are independent and of unit variance; raw ones are too large."""
    raw, white, count = [], [], 0
    for seed in range(4):
        data, _, params = sheet(12, square, make_load("clamped_y", [1.1, 1.2]), noise=1e-3, seed=seed)
        problem = field_problem(data, Constrained(terms=["I1_squared"]))
        states = problem.equilibrium.states(params, problem.equilibrium.extension(params))
        u, f = problem.residuals(states)
        residual = np.concatenate([*(r / problem.sigma for r in u), f])
        raw.append(residual @ residual)
        white.append(np.sum(problem.linearise(params, states, problem.sigma).whiten(residual) ** 2))
        # Exact forces miss by nothing of their own.
        count += len(residual) - len(f)
    by_chance = np.sqrt(2.0 * count)
    assert abs(sum(white) - count) < 3.0 * by_chance
    assert sum(raw) - count > 3.5 * by_chance


def test_errors_that_forces_share_are_those_of_each_load_cell_and_whitened_residuals_have_none():
    """W (I + A A^T) W = I, where A holds the errors of edges by step and those of gain and zero over all steps."""
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-3)
    data = data.assign_attrs(force_gain_uncertainty=0.02, force_offset_uncertainty=0.01)
    problem = field_problem(data, Constrained(terms=["I1_squared"]))
    force = np.array([each.value for each in problem.forces])
    A = shared_errors(problem.forces)
    # Forces of both steps on two edges: two load cells, each with a gain and a zero.
    assert A.shape == (4, 4) and np.linalg.matrix_rank(A) == 4
    np.testing.assert_allclose(np.linalg.norm(A[:, 0::2], axis=1), 0.02 * force)
    largest = np.array([abs(force[k::2]).max() for k in (0, 1, 0, 1)])
    np.testing.assert_allclose(np.linalg.norm(A[:, 1::2], axis=1), 0.01 * largest)

    params = problem.homogeneous.params[None].repeat(25, axis=0)
    states = problem.equilibrium.states(params, problem.equilibrium.extension(params))
    linear = problem.linearise(params, states, problem.sigma)
    W = np.stack([linear.whiten(unit) for unit in np.eye(linear.shape[0])], axis=1)
    covariance = np.linalg.inv(W @ W.T)
    by_step = field_problem(data.assign_attrs(force_gain_uncertainty=0.0, force_offset_uncertainty=0.0),
                            Constrained(terms=["I1_squared"])).linearise(params, states, problem.sigma)  # fmt: skip
    S = np.stack([by_step.whiten(unit) for unit in np.eye(linear.shape[0])], axis=1)
    of_forces = np.zeros((linear.shape[0], 4))
    of_forces[-4:] = A / np.array([each.sigma for each in problem.forces])[:, None]
    white = S @ of_forces
    # The order of the two whitenings matters to W, not to the quadratic form.
    expected = S @ np.linalg.inv(np.eye(len(S)) + white @ white.T) @ S
    np.testing.assert_allclose(W.T @ W, expected, atol=1e-9 * np.abs(expected).max())
    assert linear.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], rel=0.02)


def test_a_load_cell_that_reads_three_percent_too_much_is_no_misfit_where_it_may():
    data, _, params = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-4)

    def misfit(read, gain):
        read = data.assign(edge_force=read * data["edge_force"]).assign_attrs(force_gain_uncertainty=gain)
        problem = field_problem(read, Constrained(terms=["I1_squared"]))
        states = problem.equilibrium.states(params, problem.equilibrium.extension(params))
        linear = problem.linearise(params, states, problem.sigma)
        u, f = problem.residuals(states)
        return np.sum(linear.whiten(np.concatenate([*(r / problem.sigma for r in u), f])) ** 2)

    assert misfit(1.03, 0.0) > misfit(1.0, 0.0) + 1000.0
    # Two load cells, each off by one standard deviation.
    assert abs(misfit(1.03, 0.03) - misfit(1.0, 0.03)) < 4.0


def test_two_steps_of_a_test_stand_for_all_of_them():
    sizes = np.array([0.2, 0.45, 0.6, 0.9, 1.0])
    weights = quadrature(sizes)
    assert np.count_nonzero(weights) == 2 and weights.min() >= 0.0
    for power in (2, 3):
        np.testing.assert_allclose(weights @ sizes**power, np.sum(sizes**power))
    np.testing.assert_allclose(weights @ sizes**4, np.sum(sizes**4), rtol=0.05)
    for few in ([1.0], [0.5, 1.0], [1.0, 1.0, 1.0]):
        assert np.array_equal(quadrature(np.array(few)), np.ones(len(few)))


def test_the_curvature_of_two_steps_is_nearly_that_of_a_noisy_test_and_all_of_it_without_noise():
    load = make_load("equibiaxial", [1.05, 1.1, 1.15, 1.2])
    for noise, difference in ((1e-3, 0.1), (0.0, 1e-12)):
        data, _, params = sheet(5, square, load, noise=noise)
        problem = field_problem(data, Constrained(terms=["I1_squared"]))
        linear = problem.linearise(
            params, problem.equilibrium.states(params, problem.equilibrium.extension(params)), problem.sigma
        )
        full, lean = (
            np.linalg.eigvalsh(each(np.eye(params.size))) for each in (linear.curvature, linear.nearly_curvature)
        )
        assert np.abs(lean - full).max() < difference * full.max()


def test_observed_are_the_displacements_that_nothing_prescribes_and_that_were_not_lost():
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-3)
    settings = Constrained(terms=[])
    assert field_problem(data, settings).observed == 2 * 2 * (36 - 12)
    assert field_problem(data.assign_attrs(outline="cut"), settings).observed == 2 * 2 * 16
    u = data["u_measured"].values.copy()
    u[:, 1, 14] = np.nan
    lost = data.assign(u_measured=(data["u_measured"].dims, u))
    assert field_problem(lost, settings).observed == 2 * 2 * (36 - 12) - 2
