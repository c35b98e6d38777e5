"""The forward problem against mathematics and against an independent finite-element library."""

import numpy as np
import pytest
import scipy.sparse.linalg
import skfem
from skfem.helpers import det, inv, transpose

from hypernode.config.cases import Case
from hypernode.config.geometries import Glyph
from hypernode.fem.mesh import rectilinear
from hypernode.fem.solver import ConvergenceError, EquilibriumSolver, closed_form_stress
from hypernode.mechanics.loads import make_load
from hypernode.synthetic.geometry import make_shape

MODELS = ("neo_hookean",)


def solver_for(n, mu):
    mesh = rectilinear(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    parameters = {"model": np.zeros(len(mesh.cells)), "mu": mu(mesh.centres)}
    return mesh, parameters, EquilibriumSolver(mesh, closed_form_stress(MODELS), parameters)


def test_displacement_converges_with_second_order():
    smooth = lambda X: 1.0 + 0.5 * np.sin(2 * X[:, 0]) * np.cos(3 * X[:, 1])  # noqa: E731
    load = make_load("equibiaxial", [1.15])
    fields = {n: solver_for(n, smooth)[2].solve(load)[0][0] for n in (8, 16, 64)}
    errors = []
    for n in (8, 16):
        fine = fields[64].reshape(65, 65, 2)[:: 64 // n, :: 64 // n].reshape(-1, 2)
        errors.append(np.sqrt(np.mean((fields[n] - fine) ** 2)))
    assert np.log2(errors[0] / errors[1]) > 1.9


def test_agrees_with_an_independent_library_on_the_P_problem():
    shape = make_shape(Glyph(shape="glyph", text="P"))
    mu_at = lambda X: np.where(shape(X) > 0.5, 2.0, 1.0)  # noqa: E731
    n = 20
    mesh, _parameters, solver = solver_for(n, mu_at)
    load = make_load("equibiaxial", [1.1])
    ours = solver.solve(load)[0][0]
    grid = skfem.MeshQuad(np.ascontiguousarray(mesh.nodes.T), np.ascontiguousarray(mesh.cells.T))
    basis = skfem.Basis(grid, skfem.ElementVector(skfem.ElementQuad1()), intorder=3)
    assert basis.X.shape[1] == 4, "two by two Gauss points"
    cell_mu = mu_at(grid.p[:, grid.t].mean(axis=1).T)[:, None]
    identity = np.eye(2)[:, :, None, None]

    def kinematics(w):
        F = w["u"].grad + identity
        return F, det(F), transpose(inv(F))

    @skfem.LinearForm
    def residual(v, w):
        F, J, Fit = kinematics(w)
        return np.einsum("ij...,ij...", w["mu"] * (F - Fit / J**2), v.grad)

    @skfem.BilinearForm
    def tangent(du, v, w):
        _, J, Fit = kinematics(w)
        dF = du.grad
        trace = np.einsum("ij...,ij...", Fit, dF)
        dFit = -np.einsum("ik...,lk...,lj...->ij...", Fit, dF, Fit)
        dP = w["mu"] * (dF - (dFit - 2.0 * trace * Fit) / J**2)
        return np.einsum("ij...,ij...", dP, v.grad)

    u = basis.zeros()
    nodal = basis.nodal_dofs
    x, y = grid.p
    u[nodal[0]], u[nodal[1]] = 0.1 * x, 0.1 * y
    fixed = np.concatenate([nodal[0][(x == 0) | (x == 1)], nodal[1][(y == 0) | (y == 1)]])
    free = np.setdiff1d(np.arange(u.size), fixed)
    for _ in range(8):
        data = {"u": basis.interpolate(u), "mu": cell_mu * np.ones((1, 4))}
        r, K = residual.assemble(basis, **data), tangent.assemble(basis, **data)
        u[free] -= scipy.sparse.linalg.spsolve(K[free][:, free].tocsc(), r[free])
    theirs = np.empty_like(ours)
    order = {tuple(np.round(p, 9)): k for k, p in enumerate(grid.p.T)}
    for k, node in enumerate(mesh.nodes):
        theirs[k] = u[nodal[:, order[tuple(np.round(node, 9))]]]
    assert np.linalg.norm(ours - theirs) / np.linalg.norm(ours) < 1e-8


@pytest.mark.parametrize("kind", ["equibiaxial", "uniaxial_x", "uniaxial_y", "clamped_y", "shear"])
def test_a_homogeneous_sheet_balances_its_forces(kind):
    _, _, solver = solver_for(6, lambda X: np.ones(len(X)))
    load = make_load(kind, [1.2])
    u = solver.solve(load)[0][0]
    forces = solver.edge_forces(u, load)
    for i in range(2):
        total = sum(value for (_, component), value in forces.items() if component == i)
        assert abs(total) < 1e-9


def test_uniaxial_sheet_has_the_textbook_stress():
    _, _, solver = solver_for(4, lambda X: np.ones(len(X)))
    load = make_load("uniaxial_x", [1.3])
    u = solver.solve(load)[0][0]
    np.testing.assert_allclose(solver.edge_forces(u, load)["right", 0], 1.3 - 1.3**-2, rtol=1e-8)


def test_a_solution_that_cannot_converge_is_an_error_with_step_and_residual():
    # The exponential of such stiff fibres overflows long before the stretch is reached.
    mesh = rectilinear(np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    values = {"C10": 1.0, "k1": 1.0, "k2": 1000.0, "kappa": 0.0, "fibre_angle": 0.0, "model": 0.0}
    parameters = {key: np.full(len(mesh.cells), value) for key, value in values.items()}
    solver = EquilibriumSolver(mesh, closed_form_stress(("goh",)), parameters)
    load = make_load("equibiaxial", [1.05, 3.0])
    with pytest.raises(ConvergenceError, match=r"load step 1 .* residual"):
        solver.solve(load)


def test_unit_case_defaults_are_the_papers_grid():
    assert Case(geometry="a", matrix="b", loads=["c"], methods=["d"]).cells == (50, 50)
