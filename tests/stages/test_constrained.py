"""Equilibrium as a constraint: exact derivatives, and a field found again from noisy displacements."""

import dataclasses
import json

import jax
import numpy as np
import pytest
import scipy.optimize
import xarray as xr
from pydantic import ValidationError

from hypernode.config import Constrained, Node
from hypernode.material import drawn_material
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, ConvexBasis
from hypernode.mechanics.kinematics import Invariants, invariants
from hypernode.mechanics.loads import make_load
from hypernode.mechanics.material_names import BASIS_TERMS
from hypernode.mechanics.materials import compressible_neo_hookean, goh, hgo, mooney_rivlin, neo_hookean
from hypernode.mechanics.mesh import rectilinear
from hypernode.stages import field_problem
from hypernode.stages.constrained import Jumps, _first_field, descend, identify
from hypernode.stages.field_problem import FieldProblem
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.stages.sheets import SCALE, sheet, square

#: All terms of an incompressible sheet, and of a compressible one.
BASES = [tuple(term for term in BASIS_TERMS if term != other) for other in ("J", "I2")]


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


@pytest.mark.parametrize("kind", ["equibiaxial", "uniaxial_x", "clamped_y"])
@pytest.mark.parametrize("window", [0.0, 0.3])
def test_the_adjoint_is_the_derivative_of_the_misfit(kind, window, monkeypatch):
    # Differences need a sharper equilibrium than an identification does.
    monkeypatch.setattr(field_problem, "NEWTON_TOLERANCE", 1e-10)
    data, _, params = sheet(5, square, make_load(kind, [1.1, 1.2]), noise=1e-3, window=window)
    problem = FieldProblem(data, Constrained(terms=["I1_squared"]))
    rng = np.random.default_rng(2)
    params = params + rng.normal(0.0, 0.1, params.shape)
    change = rng.normal(0.0, 1.0, params.size)
    sigma = problem.sigma

    states = problem.states(params, problem.extension(params))
    linear = problem.linearise(params, states, sigma)

    def residuals(params):
        u, f = problem.residuals(problem.states(params, problem.extension(params)))
        return linear.whiten(np.concatenate([*(r / sigma for r in u), f]))

    def misfit(t):
        return 0.5 * np.sum(residuals(params + t * change.reshape(params.shape)) ** 2)

    gradient = linear.adjoint(residuals(params))
    h = 1e-5
    assert gradient @ change == pytest.approx((misfit(h) - misfit(-h)) / (2 * h), rel=1e-6)
    weights = rng.normal(size=linear.shape[0])
    assert weights @ linear.forward(change) == pytest.approx(linear.adjoint(weights) @ change, rel=1e-10)


def test_every_test_of_a_heterogeneous_sheet_is_described_by_itself_so_that_forces_keep_their_noise():
    pulled, biaxial = (sheet(8, square, make_load(kind, [1.1, 1.2]))[0] for kind in ("uniaxial_x", "equibiaxial"))
    both = xr.concat([biaxial, pulled.assign(test=pulled["test"] + 1)], "load_step", data_vars="minimal")
    both["u_measured"] = both["u_measured"].transpose("repeat", "load_step", "node", "i")
    settings = Constrained(terms=["I1_squared"])
    problem = FieldProblem(both, settings)
    assert problem.force_misfit.shape == (2,) and problem.force_misfit.max() < 0.01
    assert {f.step for f in problem.forces} == {0, 1, 2, 3}
    assert all(f.sigma == pytest.approx(settings.force_noise * abs(f.value)) for f in problem.forces)


def test_a_grid_cut_out_of_a_sheet_uses_the_force_at_both_ends_and_a_whole_sheet_at_one():
    data, mesh, _ = sheet(5, square, make_load("clamped_y", [1.1]))
    whole = FieldProblem(data, Constrained(terms=["I1_squared"]))
    cut = FieldProblem(data.assign_attrs(outline="cut"), Constrained(terms=["I1_squared"]))
    ends = [[int(mesh.nodes[f.direction.reshape(-1, 2)[:, 1] > 0, 1].mean()) for f in p.forces] for p in (whole, cut)]
    assert ends == [[1], [1, 0]]
    assert cut.forces[0].value == pytest.approx(-cut.forces[1].value)


def test_a_stiff_square_is_found_again_from_noisy_displacements():
    data, mesh, true = sheet(12, square, make_load("equibiaxial", [1.1, 1.2]), noise=5e-4)
    settings = Constrained(terms=["I1_squared"], iterations=15)
    found = identify(data, settings, "square")
    params, history = found.params, found.history
    level = params[:, 0]
    inside = square(mesh.centres)
    assert history[-1] < 1.05 < history[0]
    assert level[inside].mean() - level[~inside].mean() == pytest.approx(np.log(2.0), abs=0.1)
    assert ((level > 0.5 * (level[inside].mean() + level[~inside].mean())) == inside).mean() > 0.97
    assert true.shape == params.shape


@pytest.mark.parametrize("terms", [(), ("I1_squared",)])
def test_terms_are_released_only_where_the_stiffness_alone_leaves_something_to_explain(terms):
    data, _, true = sheet(12, square, make_load("equibiaxial", [1.1, 1.2]), terms=terms)
    found = identify(data, Constrained(terms=["I1_squared"]), "square")
    assert found.problem.basis.terms == terms
    F = np.diag([1.2, 1.2])[:, :, None]
    P, wanted = (
        ConvexBasis(terms, s).stress(F, p.T)
        for s, p in ((found.problem.basis.invariant_scale, found.params), (SCALE, true))
    )
    assert np.linalg.norm(P - wanted) < 0.005 * np.linalg.norm(wanted)


def test_the_area_of_a_compressible_sheet_and_the_thickness_dependent_I2_exclude_each_other():
    with pytest.raises(ValidationError, match="without I2"):
        Constrained(terms=["I2", "J"])
    with pytest.raises(ValidationError, match="J belongs to terms"):
        Constrained(terms=[], further_terms=["J"])
    with pytest.raises(ValidationError, match="no I2"):
        Node(terms=["I1", "I2", "J"], hidden=[4])


def test_draws_have_the_inverse_of_the_objectives_curvature_as_covariance():
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=2e-3)
    found = identify(data, Constrained(terms=[], iterations=8), "square")
    draws = found.objective.draws(found.params, 400, seed=3).reshape(400, -1)
    linear = found.objective.linear
    curvature = linear.adjoint(linear.forward(np.eye(found.params.size)))
    root, _ = found.objective.jumps.roots(found.params)
    curvature += found.objective.jump_weight * (root.T @ root).toarray()
    covariance = np.linalg.inv(curvature + np.diag(found.objective.ridge))
    # The relative error of a variance from 400 samples is 7 %; that of a mean, a twentieth of the spread.
    spread = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(draws.std(axis=0), spread, rtol=0.15)
    assert np.abs((draws.mean(axis=0) - found.params.ravel()) / spread).max() < 0.2
    assert np.array_equal(draws[0], found.objective.draws(found.params, 1, seed=3).ravel())


def test_a_draw_changes_the_stress_to_first_order_so_that_parameters_that_trade_places_do_not_count():
    basis = ConvexBasis(("I2",), SCALE)
    best, change = np.array([[0.1, 0.2], [0.5, 0.3]]), np.array([[0.3, -0.2], [2.0, 4.0]])
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]])
    file = xr.Dataset(
        {
            "X": (("node", "i"), nodes),
            "cells": (("cell", "vertex"), np.array([[0, 1, 4, 5], [1, 2, 3, 4]])),
            **{f"basis.{name}": (("cell",), best[k]) for k, name in enumerate(basis.names)},
            **{
                f"draw.{name}": (("draw", "cell"), best[k] + change[k] * np.array([[1.0], [-1.0]]))
                for k, name in enumerate(basis.names)
            },
        },
        attrs={"basis": json.dumps(dataclasses.asdict(basis)), "units": json.dumps(SYNTHETIC_UNITS)},
    )
    centres = nodes[file["cells"].values].mean(axis=1)
    F = np.broadcast_to([[1.1, 0.02], [0.0, 1.05]], (4, 2, 2))
    drawn = np.asarray(drawn_material(file).stress(np.tile(centres, (2, 1)), F)).reshape(2, 2, 2, 2)
    found = np.asarray(basis.stress(F[0][:, :, None], best))
    np.testing.assert_allclose(drawn.mean(axis=0), np.moveaxis(found, -1, 0), rtol=1e-10)
    h = 1e-6
    slope = (basis.stress(F[0][:, :, None], best + h * change) - found) / h
    np.testing.assert_allclose(drawn[0] - drawn[1], 2.0 * np.moveaxis(np.asarray(slope), -1, 0), rtol=1e-4)
    assert drawn_material(file.drop_vars([f"draw.{name}" for name in basis.names])) is None


def test_a_second_family_needs_a_first():
    with pytest.raises(ValidationError, match="add fibre to terms"):
        Constrained(terms=["I2"], further_terms=["across"])
    assert Constrained(terms=["fibre"], further_terms=["across"]).further_terms == ["across"]


def test_fibres_that_no_datum_tells_of_begin_small_and_the_prior_wants_none():
    """Pulled along y, an isotropic sheet says nothing of fibres along x."""
    data, _, _ = sheet(5, square, make_load("uniaxial_y", [1.1, 1.2]))
    problem = FieldProblem(data, Constrained(terms=["I1_squared", "fibre"]))
    params, centre = _first_field(problem, None)
    fibre = [problem.basis.names.index(name) for name in FIBRE_VECTOR]
    assert np.linalg.norm(params[:, fibre], axis=1) == pytest.approx(0.01)
    assert np.all(centre[:, fibre] == 0.0)


def test_further_terms_are_kept_only_where_they_explain_more_and_an_unexplained_test_is_a_warning(capsys):
    data, _, _ = sheet(6, square, make_load("equibiaxial", [1.1, 1.2]))
    plain = Constrained(terms=["fibre"], iterations=2)
    more = plain.model_copy(update={"further_terms": ["I1_squared"]})
    alone, kept = (identify(data, settings, "square") for settings in (plain, more))
    assert alone.unexplained > 1.0
    assert kept.cost <= alone.cost
    assert "warning: constrained field of square: displacements are missed by" in capsys.readouterr().err
    assert kept.problem.basis.terms == (("fibre", "I1_squared") if kept.cost < alone.cost else ("fibre",))


def test_jumps_cost_length_times_size_and_large_ones_stop_costing_more():
    lines = np.linspace(0.0, 1.0, 9)
    mesh = rectilinear(lines, lines)
    jumps = Jumps(mesh, ("log_level",))

    def cost(height):
        return jumps.value(height * (mesh.centres[:, :1] > 0.5)) - jumps.value(np.zeros((len(mesh.cells), 1)))

    assert cost(2.0) == pytest.approx(8 * 2.0, rel=0.02)
    jumps.scale = 0.05
    assert cost(2.0) < 1.25 * cost(1.0)
    flat, step = np.zeros((len(mesh.cells), 1)), (mesh.centres[:, :1] > 0.5) * 1.0
    h = 1e-6
    slope = (jumps.value(step * (1 + h)) - jumps.value(step * (1 - h))) / (2 * h)
    R, r = jumps.roots(step)
    assert step.ravel() @ R.T @ r == pytest.approx(slope, rel=1e-5)
    assert np.array_equal(R @ step.ravel(), r)
    assert jumps.value(flat) < jumps.value(step)


def test_a_jump_of_the_stiffness_costs_no_less_when_terms_share_it():
    """Divided among parameters that counted by themselves, the same jump was a third cheaper."""
    terms = ("I1_squared", "I2")
    data, mesh, _ = sheet(8, square, make_load("equibiaxial", [1.1, 1.2]), terms=terms)
    problem = FieldProblem(data, Constrained(terms=list(terms)))
    jumps = Jumps(mesh, problem.basis.names, problem.stiffness)
    jumps.scale = 0.05
    inside, level, I2 = square(mesh.centres), *(problem.basis.names.index(key) for key in ("log_level", "log1p_I2"))
    alone, shared = (np.tile(problem.basis.start, (len(mesh.cells), 1)) for _ in range(2))
    alone[inside, level] += np.log(2.0)
    shared[inside, I2] += 0.4
    # As stiff as the other.
    missing = problem.stiffness(alone)[0] - problem.stiffness(shared)[0]
    shared[:, level] += missing
    assert 0.0 < shared[inside, level].mean() < 0.5 * np.log(2.0)
    np.testing.assert_allclose(problem.stiffness(shared)[0], problem.stiffness(alone)[0], rtol=1e-10)
    assert jumps.value(alone) < jumps.value(shared)


def test_the_gradient_of_jumps_is_their_derivative_where_terms_make_up_the_stiffness():
    terms = ("I1_squared", "I2", "fibre")
    data, mesh, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]))
    problem = FieldProblem(data, Constrained(terms=list(terms)))
    jumps = Jumps(mesh, problem.basis.names, problem.stiffness)
    rng = np.random.default_rng(5)
    params = problem.homogeneous + rng.normal(0.0, 0.2, (len(mesh.cells), len(problem.basis.names)))
    change, h = rng.normal(size=params.shape), 1e-6
    for jumps.scale in (None, 0.05):
        R, r = jumps.roots(params)
        slope = (jumps.value(params + h * change) - jumps.value(params - h * change)) / (2 * h)
        assert change.ravel() @ R.T @ r == pytest.approx(slope, rel=1e-6)


def test_a_descent_that_noise_holds_up_is_shaken_into_a_better_field_and_a_clean_one_is_left_alone():
    load, settings = make_load("equibiaxial", [1.1, 1.2]), Constrained(terms=[], iterations=15)
    data, _, true = sheet(12, square, load, noise=1e-2, seed=1)
    found = identify(data, settings, "square")
    once = descend(found.problem, settings, "square", None, None, settings.tolerance)
    assert found.cost < once.cost - 10.0

    def error(params):
        return np.std(params[:, 0] - true[:, 0])

    assert error(found.params) < 0.7 * error(once.params)
    data, _, _ = sheet(12, square, load)
    found = identify(data, settings, "square")
    once = descend(found.problem, settings, "square", None, None, settings.tolerance)
    assert np.array_equal(found.history, once.history)


def test_an_isotropic_contour_costs_its_length_along_the_grid_and_across_it():
    lines = np.linspace(0.0, 1.0, 41)
    mesh = rectilinear(lines, lines)
    jumps = Jumps(mesh, ("log_level",))
    X, flat = mesh.centres, jumps.value(np.zeros((len(mesh.cells), 1)))

    def costs():
        sides = [X[:, 0] > 0.5, X.sum(axis=1) > 1.0 + 1e-9]
        return [jumps.value(2.0 * side[:, None]) - flat for side in sides]

    # Length in cells x height; sides alone see the staircase, 2 instead of sqrt(2).
    assert costs() == pytest.approx([2.0 * 40, 2.0 * 78], rel=0.02)
    jumps.isotropic = True
    flat = jumps.value(np.zeros((len(mesh.cells), 1)))
    assert costs() == pytest.approx([2.0 * 40, 2.0 * 40 * np.sqrt(2.0)], rel=0.05)


def test_errors_of_held_edges_that_the_whole_sheet_shares_are_no_misfit_of_the_material():
    """Of the true field the whitened residuals are independent and of unit variance; raw ones are too large."""
    raw, white, count = [], [], 0
    for seed in range(4):
        data, _, params = sheet(12, square, make_load("clamped_y", [1.1, 1.2]), noise=1e-3, seed=seed)
        problem = FieldProblem(data, Constrained(terms=["I1_squared"]))
        states = problem.states(params, problem.extension(params))
        u, f = problem.residuals(states)
        residual = np.concatenate([*(r / problem.sigma for r in u), f])
        raw.append(residual @ residual)
        white.append(np.sum(problem.linearise(params, states, problem.sigma).whiten(residual) ** 2))
        # Exact forces miss by nothing of their own.
        count += len(residual) - len(f)
    by_chance = np.sqrt(2.0 * count)
    assert abs(sum(white) - count) < 3.0 * by_chance
    assert sum(raw) - count > 3.5 * by_chance
