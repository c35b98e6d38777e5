"""Equilibrium as a constraint: a field found again from noisy displacements, with the terms that it needs."""

import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg
import xarray as xr
from pydantic import ValidationError

from hypernode.config.methods import Constrained, Node
from hypernode.identification import budgets
from hypernode.identification.choice import likeliest
from hypernode.identification.gauss_newton import descend, first_field
from hypernode.identification.problem import field_problem
from hypernode.identification.strategy import identify
from hypernode.material.files import posterior_material
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, ConvexBasis
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.sheets import SCALE, sheet, square


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0, 5e-4])
def test_a_grid_of_many_cells_begins_from_the_field_of_every_second_line_and_finds_the_same(noise, capsys, monkeypatch):
    data, mesh, true = sheet(12, square, make_load("equibiaxial", [1.1, 1.2]), noise=noise)
    monkeypatch.setattr(budgets, "MOST_CELLS_AT_ONCE", 100)
    found = identify(data, Constrained(terms=["I1_squared"]), "square")
    assert "36 cells of every second grid line first" in capsys.readouterr().err
    assert found.unexplained < 1.0 and len(found.params) == 144
    level, inside = found.params[:, 0], square(mesh.centres)
    assert ((level > 0.5 * (level[inside].mean() + level[~inside].mean())) == inside).all()
    if noise == 0.0:
        assert np.abs(found.params - true).max() < 0.02


@pytest.mark.slow
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


@pytest.mark.slow
def test_fibres_that_stiffen_as_those_of_skin_are_found_with_the_term_for_it_and_not_without():
    terms, skin = ("fibre", "stiffening"), {"fibre_x": 0.4, "fibre_y": 0.2, "log1p_stiffening": 0.6}
    load = make_load("equibiaxial", [1.05, 1.1, 1.15, 1.2])
    data, _, true = sheet(8, square, load, terms=terms, values=skin.items())
    F = np.diag([1.2, 1.2])[:, :, None]
    wanted, errors = ConvexBasis(terms, SCALE).stress(F, true.T), []
    for known in (["fibre"], ["fibre", "stiffening"]):
        found = identify(data, Constrained(terms=known), "skin")
        P = found.problem.basis.stress(F, found.params.T)
        errors.append(np.linalg.norm(P - wanted) / np.linalg.norm(wanted))
    assert errors[1] < 0.01 < 0.05 < errors[0]


@pytest.mark.slow
@pytest.mark.parametrize("truth", ["ogden", "fibre"])
def test_fibres_are_there_only_if_a_field_with_them_is_the_likelier_one(truth):
    load = make_load("clamped_y", [1.08, 1.16, 1.24])
    values = {"ogden": {"log1p_ogden_6": 0.7}, "fibre": {"fibre_x": -0.5, "fibre_y": 0.4}}[truth]
    data, _, true = sheet(8, square, load, noise=2e-4, terms=(truth,), values=values.items())
    settings = Constrained(terms=["I2", "fibre"], isotropic_terms=["I2", "ogden"])
    found = identify(data, settings, truth)
    assert found.problem.basis.terms == {"ogden": ("I2", "ogden"), "fibre": ("I2", "fibre")}[truth]
    F = np.diag([1.2**-0.5, 1.2])[:, :, None]
    P = found.problem.basis.stress(F, found.params.T)
    wanted = ConvexBasis((truth,), SCALE).stress(F, true.T)
    assert np.linalg.norm(P - wanted) < 0.05 * np.linalg.norm(wanted)


@pytest.mark.slow
def test_a_descent_begins_anew_where_no_equilibrium_is_near_that_of_the_terms_before():
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1]))
    settings = Constrained(terms=["I1_squared"], iterations=3)
    problem = field_problem(data, settings)
    before = descend(field_problem(data, Constrained(terms=[])), settings, "square", None, 0.0)
    torn = [dataclasses.replace(state, u=state.u.copy()) for state in before.states]
    for state in torn:
        state.u.ravel()[state.free] = np.random.default_rng(1).normal(size=len(state.free))
    assert problem.equilibrium.states(np.tile(problem.homogeneous.params, (25, 1)), [state.u for state in torn]) is None
    found, anew = (
        descend(problem, settings, "square", each, 0.0) for each in (dataclasses.replace(before, states=torn), None)
    )
    assert np.array_equal(found.params, anew.params)


def test_the_area_of_a_compressible_sheet_and_the_thickness_dependent_I2_exclude_each_other():
    with pytest.raises(ValidationError, match="without I2"):
        Constrained(terms=["I2", "J"])
    with pytest.raises(ValidationError, match="and ogden"):
        Constrained(terms=["ogden", "J"])
    with pytest.raises(ValidationError, match="neither fibre nor J"):
        Constrained(terms=["fibre"], isotropic_terms=["fibre"])
    with pytest.raises(ValidationError, match="J belongs to terms"):
        Constrained(terms=[], further_terms=["J"])
    with pytest.raises(ValidationError, match="no I2"):
        Node(terms=["I1", "I2", "J"], hidden=[4])


def test_posterior_samples_have_the_inverse_of_the_objectives_curvature_as_covariance():
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=2e-3)
    found = identify(data, Constrained(terms=[], iterations=8), "square")
    linear = found.linear
    samples = found.objective.posterior_samples(linear, found.params, 400, seed=3).reshape(400, -1)
    curvature = linear.curvature(np.eye(found.params.size))
    R, _, derivative = found.objective.regulariser.roots(found.params, found.objective.jump_cost)
    root = R @ scipy.linalg.block_diag(*derivative)
    curvature += found.objective.regulariser_weight * root.T @ root
    covariance = np.linalg.inv(curvature + np.diag(found.objective.ridge))
    # The relative error of a variance from 400 samples is 7 %; that of a mean, a twentieth of the spread.
    spread = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(samples.std(axis=0), spread, rtol=0.15)
    assert np.abs((samples.mean(axis=0) - found.params.ravel()) / spread).max() < 0.2
    assert np.array_equal(samples[0], found.objective.posterior_samples(linear, found.params, 1, seed=3).ravel())


def test_effective_parameters_are_the_trace_of_what_the_data_say_of_their_own_fit():
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=2e-3)
    found = descend(field_problem(data, Constrained(terms=[])), Constrained(iterations=8), "square", None, 0.0)
    curvature = found.linear.curvature(np.eye(found.params.size))
    R, _, derivative = found.objective.regulariser.roots(found.params, found.objective.jump_cost)
    root = R @ scipy.linalg.block_diag(*derivative)
    jumps = found.objective.regulariser_weight * root.T @ root
    share = np.linalg.solve(curvature + jumps + np.diag(found.objective.ridge), curvature)
    number = np.trace(share)
    by_chance = np.sqrt(2.0 * np.trace(share @ share))
    assert abs(found.effective_parameters - number) < 2.5 * by_chance < number


def test_without_noise_no_parameter_fits_it():
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]))
    found = descend(field_problem(data, Constrained(terms=[])), Constrained(iterations=2), "square", None, 0.0)
    assert found.effective_parameters == 0.0


def test_a_posterior_sample_changes_the_stress_to_first_order_so_that_parameters_that_trade_places_do_not_count():
    basis = ConvexBasis(("I2",), SCALE)
    best, change = np.array([[0.1, 0.2], [0.5, 0.3]]), np.array([[0.3, -0.2], [2.0, 4.0]])
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]])
    file = xr.Dataset(
        {
            "X": (("node", "i"), nodes),
            "cells": (("cell", "vertex"), np.array([[0, 1, 4, 5], [1, 2, 3, 4]])),
            **{f"basis.{name}": (("subcell", "cell"), best[k, None]) for k, name in enumerate(basis.names)},
            **{
                f"posterior.{name}": (
                    ("posterior_sample", "subcell", "cell"),
                    best[k] + change[k] * np.array([[[1.0]], [[-1.0]]]),
                )
                for k, name in enumerate(basis.names)
            },
        },
        attrs={"basis": json.dumps(dataclasses.asdict(basis)), "units": json.dumps(SYNTHETIC_UNITS)},
    )
    centres = nodes[file["cells"].values].mean(axis=1)
    F = np.broadcast_to([[1.1, 0.02], [0.0, 1.05]], (4, 2, 2))
    drawn = np.asarray(posterior_material(file).stress(np.tile(centres, (2, 1)), F)).reshape(2, 2, 2, 2)
    found = np.asarray(basis.stress(F[0][:, :, None], best))
    np.testing.assert_allclose(drawn.mean(axis=0), np.moveaxis(found, -1, 0), rtol=1e-10)
    h = 1e-6
    slope = (basis.stress(F[0][:, :, None], best + h * change) - found) / h
    np.testing.assert_allclose(drawn[0] - drawn[1], 2.0 * np.moveaxis(np.asarray(slope), -1, 0), rtol=1e-4)
    assert posterior_material(file.drop_vars([f"posterior.{name}" for name in basis.names])) is None


def test_a_field_that_explains_noise_or_misses_the_test_is_kept_only_where_there_is_no_other():
    def field(information_criterion, unexplained=0.5, overfitted=False):
        made = SimpleNamespace(
            information_criterion=information_criterion, unexplained=unexplained, overfitted=overfitted, trial=object()
        )
        made.instead_of = lambda other, because: made
        return made

    sound, missing, noise = field(10.0), field(1.0, unexplained=1.2), field(2.0, overfitted=True)
    assert likeliest(missing, noise, sound) is sound
    assert likeliest(noise, missing) is missing
    assert likeliest(field(11.0), sound) is sound


@pytest.mark.slow
def test_forces_are_explained_to_two_and_a_half_uncertainties_or_as_far_as_finite_elements_describe_them():
    data, _, _ = sheet(6, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-3)
    limits = []
    for noise in (1e-2, 6e-4):
        settings = Constrained(terms=["I1_squared"], force_noise=noise, iterations=1)
        found = descend(field_problem(data, settings), settings, "square", None, 0.0)
        forces = found.misfits["force"]
        limits.append(forces / dataclasses.replace(found, history=np.zeros(1)).unexplained)
    assert limits == pytest.approx([2.5, 4.0], rel=1e-6)


def test_a_second_family_needs_a_first():
    with pytest.raises(ValidationError, match="add fibre to terms"):
        Constrained(terms=["I2"], further_terms=["across"])
    with pytest.raises(ValidationError, match="add I1_squared to terms"):
        Constrained(terms=["fibre"], further_terms=["stiffening", "I1_stiffening"])
    with pytest.raises(ValidationError, match="add I1_squared to isotropic_terms"):
        Constrained(terms=["fibre", "I1_squared"], isotropic_terms=["I2", "I1_stiffening"])
    assert Constrained(terms=["fibre"], further_terms=["across"]).further_terms == ["across"]


def test_fibres_that_no_datum_tells_of_begin_small_and_the_prior_wants_none():
    """Pulled along y, an isotropic sheet says nothing of fibres along x."""
    data, _, _ = sheet(5, square, make_load("uniaxial_y", [1.1, 1.2]))
    problem = field_problem(data, Constrained(terms=["I1_squared", "fibre"]))
    params, centre, _ = first_field(problem, None)
    fibre = [problem.basis.names.index(name) for name in FIBRE_VECTOR]
    assert np.linalg.norm(params[:, fibre], axis=1) == pytest.approx(0.01)
    assert np.all(centre[:, fibre] == 0.0)


def test_a_descent_begins_where_another_ended_even_where_no_fibres_were_found_in_some_cells():
    """The first cell has none, as in a plain matrix: once, all cells lost theirs."""
    data, _, _ = sheet(5, square, make_load("uniaxial_y", [1.1, 1.2]))
    problem = field_problem(data, Constrained(terms=["I1_squared", "fibre"]))
    found = np.random.default_rng(6).normal(size=first_field(problem, None)[0].shape)
    found[0, [problem.basis.names.index(name) for name in FIBRE_VECTOR]] = 0.0
    params, _, _ = first_field(problem, SimpleNamespace(problem=problem, params=found, states=[]))
    np.testing.assert_allclose(params, found, atol=1e-12)


@pytest.mark.slow
def test_further_terms_are_kept_only_where_they_explain_more_and_an_unexplained_test_is_a_warning(capsys):
    data, _, _ = sheet(6, square, make_load("equibiaxial", [1.1, 1.2]))
    plain = Constrained(terms=["fibre"], iterations=2)
    more = plain.model_copy(update={"further_terms": ["I1_squared"]})
    alone, kept = (identify(data, settings, "square") for settings in (plain, more))
    assert alone.unexplained > 1.0
    assert kept.cost <= alone.cost
    assert "warning: constrained field of square: displacements are missed by" in capsys.readouterr().err
    assert kept.problem.basis.terms == (("fibre", "I1_squared") if kept.cost < alone.cost else ("fibre",))


@pytest.mark.slow
@pytest.mark.parametrize(("terms", "most"), [(["J"], 100), (["I1_squared"], 30)], ids=["compressible", "many cells"])
def test_further_terms_are_tried_where_no_field_of_the_stiffness_alone_was_made_before(terms, most, monkeypatch):
    """Neither a sheet whose volume may change nor a grid that began from a coarser one has such a field."""
    data, _, _ = sheet(6, square, make_load("equibiaxial", [1.1, 1.2]), values=(("log1p_I1_squared", 1.5),))
    further = "I1_squared" if terms == ["J"] else "I2"
    settings = Constrained(terms=terms, isotropic_terms=[], further_terms=[further], iterations=2)
    monkeypatch.setattr(budgets, "MOST_CELLS_AT_ONCE", most)
    found = identify(data, settings, "square")
    assert found.unexplained > 1.0 and set(terms) <= set(found.problem.basis.terms) <= {*terms, further}
