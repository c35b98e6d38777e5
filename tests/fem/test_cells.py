"""Cells of small meshes are filled up, so that what a law compiles to serves them all, and nothing else changes."""

import numpy as np
import pytest

from hypernode.fem import solver as solvers
from hypernode.fem.cells import SIZES, cell_forces, filled
from hypernode.fem.mesh import rectilinear
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress

STRESS = closed_form_stress(("neo_hookean",))


def solver_of(rows, columns):
    mesh = rectilinear(np.linspace(0.0, 1.0, columns + 1), np.linspace(0.0, 1.5, rows + 1))
    mu = 1.0 + 0.5 * np.random.default_rng(1).random(len(mesh.cells))
    return EquilibriumSolver(mesh, STRESS, {"model": np.zeros_like(mu), "mu": mu})


def state(mesh):
    return mesh.nodes @ np.array([[0.2, 0.03], [0.0, -0.1]]) + 1e-2 * np.sin(3.0 * mesh.nodes)


@pytest.mark.parametrize("cells", [1, SIZES[0] - 1, SIZES[0], SIZES[0] + 1, SIZES[-1], SIZES[-1] + 1])
def test_small_meshes_are_filled_with_their_last_cell_and_large_ones_stay_as_they_are(cells):
    numbers = filled(cells)
    assert len(numbers) in {*SIZES, cells} and len(numbers) >= cells
    np.testing.assert_array_equal(numbers[:cells], np.arange(cells))
    assert (numbers[cells:] == cells - 1).all()


def test_forces_and_tangent_are_those_of_the_cells_alone(monkeypatch):
    found = solver_of(3, 4)
    u = state(found.mesh)
    monkeypatch.setattr(solvers, "filled", np.arange)
    alone = solver_of(3, 4)
    np.testing.assert_allclose(found.internal_force(u), alone.internal_force(u), atol=1e-15)
    for one, other in zip(found.tangent(u), alone.tangent(u), strict=True):
        assert abs(one - other).max() < 1e-14


def test_small_meshes_of_one_law_share_what_is_compiled():
    compiled = cell_forces(STRESS, ("model", "mu"))
    for rows, columns in ((3, 4), (5, 5), (7, 2)):
        solver = solver_of(rows, columns)
        solver.internal_force(state(solver.mesh))
        solver.tangent(state(solver.mesh))
        assert (solver._forces, solver._tangent) == compiled
    before = [each._cache_size() for each in compiled]
    solver = solver_of(4, 6)
    solver.internal_force(state(solver.mesh))
    solver.tangent(state(solver.mesh))
    assert [each._cache_size() for each in compiled] == before
