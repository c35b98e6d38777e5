"""Jumps of a field: what a contour costs, and how the cost changes."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.fem.mesh import rectilinear
from hypernode.identification.problem import field_problem
from hypernode.identification.regulariser import JumpCost, Regulariser
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square


def level_alone(params):
    """Stiffness of a sheet without further terms."""
    return params[:, 0], np.ones_like(params)


def test_jumps_cost_length_times_size_and_large_ones_stop_costing_more():
    lines = np.linspace(0.0, 1.0, 9)
    mesh = rectilinear(lines, lines)
    regulariser = Regulariser(mesh=mesh, names=("log_level",), unit=np.sqrt(mesh.areas[0]), stiffness=level_alone)

    def cost(height, kind):
        flat = regulariser.value(np.zeros((len(mesh.cells), 1)), kind)
        return regulariser.value(height * (mesh.centres[:, :1] > 0.5), kind) - flat

    assert cost(2.0, JumpCost()) == pytest.approx(8 * 2.0, rel=0.02)
    saturated = JumpCost(scale=0.05)
    assert cost(2.0, saturated) < 1.25 * cost(1.0, saturated)
    flat, step = np.zeros((len(mesh.cells), 1)), (mesh.centres[:, :1] > 0.5) * 1.0
    h = 1e-6
    slope = (regulariser.value(step * (1 + h), saturated) - regulariser.value(step * (1 - h), saturated)) / (2 * h)
    R, r, _ = regulariser.roots(step, saturated)
    assert step.ravel() @ R.T @ r == pytest.approx(slope, rel=1e-5)
    assert np.array_equal(R @ step.ravel(), r)
    assert regulariser.value(flat, saturated) < regulariser.value(step, saturated)


def test_a_jump_of_the_stiffness_costs_no_less_when_terms_share_it():
    """Divided among parameters that counted by themselves, the same jump was a third cheaper."""
    terms = ("I1_squared", "I2")
    data, mesh, _ = sheet(8, square, make_load("equibiaxial", [1.1, 1.2]), terms=terms)
    problem = field_problem(data, Constrained(terms=list(terms)))
    regulariser = Regulariser(
        mesh=mesh, names=problem.basis.names, unit=np.sqrt(mesh.areas[0]), stiffness=problem.stiffness
    )
    saturated = JumpCost(scale=0.05)
    inside, level, I2 = square(mesh.centres), *(problem.basis.names.index(key) for key in ("log_level", "log1p_I2"))
    alone, shared = (np.tile(problem.basis.start, (len(mesh.cells), 1)) for _ in range(2))
    alone[inside, level] += np.log(2.0)
    shared[inside, I2] += 0.4
    # As stiff as the other.
    missing = problem.stiffness(alone)[0] - problem.stiffness(shared)[0]
    shared[:, level] += missing
    assert 0.0 < shared[inside, level].mean() < 0.5 * np.log(2.0)
    np.testing.assert_allclose(problem.stiffness(shared)[0], problem.stiffness(alone)[0], rtol=1e-10)
    assert regulariser.value(alone, saturated) < regulariser.value(shared, saturated)


def test_the_gradient_of_jumps_is_their_derivative_where_terms_make_up_the_stiffness():
    terms = ("I1_squared", "I2", "fibre")
    data, mesh, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]))
    problem = field_problem(data, Constrained(terms=list(terms)))
    regulariser = Regulariser(
        mesh=mesh, names=problem.basis.names, unit=np.sqrt(mesh.areas[0]), stiffness=problem.stiffness
    )
    rng = np.random.default_rng(5)
    params = problem.homogeneous.params + rng.normal(0.0, 0.2, (len(mesh.cells), len(problem.basis.names)))
    change, h = rng.normal(size=params.shape), 1e-6
    for cost in (JumpCost(), JumpCost(scale=0.05)):
        R, r, B = regulariser.roots(params, cost)
        slope = (regulariser.value(params + h * change, cost) - regulariser.value(params - h * change, cost)) / (2 * h)
        assert np.einsum("ckp,cp->ck", B, change).ravel() @ R.T @ r == pytest.approx(slope, rel=1e-6)


def test_an_isotropic_contour_costs_its_length_along_the_grid_and_across_it():
    lines = np.linspace(0.0, 1.0, 41)
    mesh = rectilinear(lines, lines)
    regulariser = Regulariser(mesh=mesh, names=("log_level",), unit=np.sqrt(mesh.areas[0]), stiffness=level_alone)
    X = mesh.centres

    def costs(kind):
        flat = regulariser.value(np.zeros((len(mesh.cells), 1)), kind)
        sides = [X[:, 0] > 0.5, X.sum(axis=1) > 1.0 + 1e-9]
        return [regulariser.value(2.0 * side[:, None], kind) - flat for side in sides]

    # Length in cells x height; sides alone see the staircase, 2 instead of sqrt(2).
    assert costs(JumpCost()) == pytest.approx([2.0 * 40, 2.0 * 78], rel=0.02)
    assert costs(JumpCost(isotropic=True)) == pytest.approx([2.0 * 40, 2.0 * 40 * np.sqrt(2.0)], rel=0.05)
