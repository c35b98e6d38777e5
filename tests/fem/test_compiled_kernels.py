"""What is compiled computes what was written, at the sizes of real tests.

The pinned compiler gets some reductions wrong at some sizes (docs/decisions/0020), so that small cases prove little.
"""

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.fem.equilibrium_gap import EquilibriumGap
from hypernode.fem.mesh import rectilinear
from hypernode.fem.solver import EquilibriumSolver
from hypernode.material.laws import mean_of_subcells, node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.convex_basis import ConvexBasis

BASIS = ConvexBasis(("I1_squared", "I2", "fibre"), 0.4)


def square_mesh(cells):
    lines = np.linspace(0.0, 1.0, cells + 1)
    return rectilinear(lines, lines)


def test_nodal_forces_of_a_large_mesh_are_the_sums_over_its_quadrature_points():
    mesh, rng = square_mesh(135), np.random.default_rng(0)
    params = BASIS.start + 0.1 * rng.normal(size=(len(mesh.cells), len(BASIS.start)))
    solver = EquilibriumSolver(mesh, lambda F, p: BASIS.stress(F, p["params"]), {"params": params})
    u = 0.1 * mesh.nodes + 0.0005 * rng.normal(size=mesh.nodes.shape)
    gradient, weight = (np.asarray(each) for each in solver.shape_gradients)
    F = np.eye(2) + np.einsum("cai,cqaJ->cqiJ", u[mesh.cells], gradient)
    P = np.asarray(BASIS.stress(jnp.moveaxis(F, (2, 3), (0, 1)), params.T[:, :, None]))
    wanted = np.zeros(u.shape)
    np.add.at(wanted, mesh.cells, np.einsum("cq,cqaJ,iJcq->cai", weight, gradient, P))
    for found in (solver.internal_force(u), solver.tangent(u)[0].reshape(u.shape)):
        np.testing.assert_allclose(found, wanted, atol=1e-12 * np.abs(wanted).max())


def multiplied(factor):
    """The matrix whose factor is stored by blocks."""
    pivots, below = (np.asarray(each, float) for each in (factor.pivots, factor.below))
    count, size, _ = pivots.shape
    L = np.zeros((count, size, count, size))
    for k in range(count):
        L[k, :, k] = np.linalg.inv(pivots[k])
        if k:
            L[k, :, k - 1] = below[k]
    L = L.reshape(count * size, count * size)
    return (L @ L.T)[np.ix_(factor.place, factor.place)]


def test_the_compiled_equilibrium_gap_and_its_gradient_are_products_with_its_matrices():
    mesh, rng = square_mesh(50), np.random.default_rng(1)
    held = np.array([[True, False], [True, False], [False, True], [False, True]])
    gap = EquilibriumGap.build(mesh, held, held)
    P = rng.normal(size=(2, 2, 4, len(mesh.cells))).astype(np.float32)
    resultant, scale = jnp.ones((4, 2), jnp.float32), jnp.ones(4, jnp.float32)

    def squared(P):
        return jnp.sum(gap.squared(P, resultant, scale))

    found, slope = jax.jit(jax.value_and_grad(squared))(P)
    wanted, gradient = 0.0, np.zeros(P.shape)
    for i in range(2):
        work = [np.asarray(each.todense(), float) for each in gap.work[i]]
        R = sum(work[J] @ P[i, J].T.astype(float) for J in range(2)) - np.asarray(gap.loads[i], float)[:, None]
        field = np.linalg.solve(multiplied(gap.energies[i]), R) / gap.area
        wanted += np.sum(R * field)
        for J in range(2):
            gradient[i, J] = 2.0 * (work[J].T @ field).T
    np.testing.assert_allclose(found, wanted, rtol=1e-5)
    np.testing.assert_allclose(slope, gradient, atol=1e-5 * np.abs(gradient).max())


def test_the_gradient_of_a_mean_over_all_cells_is_the_mean_of_those_over_groups_of_them():
    node = NodeMaterial(terms=("I1", "I2"), hidden=(4, 4), steps=2, invariant_scale=0.5, stress_scale=1.0)
    rng, cells, groups = np.random.default_rng(2), 20000, 80
    start = np.asarray(node.initial_params(jax.random.key(0)))
    params = jnp.asarray(start[:, None] * (1.0 + 0.1 * rng.normal(size=(len(start), cells))), jnp.float32)
    F = np.eye(2)[:, :, None, None] * np.array([1.05, 1.2])[:, None] + 0.02 * rng.normal(size=(2, 2, 2, cells))
    F = jnp.asarray(F, jnp.float32)

    @jax.jit
    def misfit_and_gradient(params, F):
        return jax.value_and_grad(lambda p: jnp.mean((node_stress(node, F, p) - 0.3) ** 2))(params)

    whole, slope = misfit_and_gradient(params, F)
    parts = [
        misfit_and_gradient(p, f)
        for p, f in zip(jnp.split(params, groups, axis=-1), jnp.split(F, groups, axis=-1), strict=True)
    ]
    np.testing.assert_allclose(whole, np.mean([float(value) for value, _ in parts]), rtol=1e-5)
    wanted = np.concatenate([np.asarray(gradient) for _, gradient in parts], axis=-1) / groups
    np.testing.assert_allclose(slope, wanted, atol=1e-5 * np.abs(wanted).max())


def test_a_cell_is_the_mean_of_its_parts_compiled_or_not():
    """The mean along a middle axis, as the compiler fused it with the stress, was wrong at just this size."""
    rng = np.random.default_rng(3)
    F = (np.eye(2)[:, :, None, None] + 0.1 * rng.normal(size=(2, 2, 16, 2500))).astype(np.float32)
    params = (BASIS.start[:, None, None] + 0.1 * rng.normal(size=(6, 4, 2500))).astype(np.float32)
    mean = mean_of_subcells(BASIS.stress)
    each = np.stack([BASIS.stress(F[:, :, case], params[:, k]) for case in range(16) for k in range(4)])
    wanted = np.moveaxis(each.reshape(16, 4, 2, 2, 2500).mean(axis=1), 0, 2)
    np.testing.assert_allclose(mean(F, params), wanted, atol=1e-4)
    np.testing.assert_allclose(jax.jit(mean)(F, params), wanted, atol=1e-4)
