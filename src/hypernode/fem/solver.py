"""Newton's method for displacement-driven hyperelastic sheets, assembled by JAX-FEM.

This is the only module that imports ``jax_fem``. Its ``problem`` and ``fe`` modules are used; its
``solver`` is not, because that needs PETSc, which has no wheel (see docs/decisions).
"""

import contextlib
import io
import logging
import sys
import types
from collections.abc import Callable, Mapping
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import scipy.sparse
from jaxtyping import Array, Float

from hypernode.errors import ExpectedError
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.mechanics.closed_forms import energy_derivatives
from hypernode.mechanics.kinematics import invariants
from hypernode.mechanics.loads import Load
from hypernode.mechanics.stress import first_piola_kirchhoff

MAX_ITERATIONS = 20
MAX_BISECTIONS = 6
#: Share of the residual that may remain after a step with old factors before new ones are made.
SLOW = 0.3


class ConvergenceError(ExpectedError, RuntimeError):
    """Newton's method found no equilibrium; the message names the load step and the residual."""


def _import_jax_fem():
    """Import JAX-FEM without its banner, its debug log, or gmsh, which only its mesher needs."""
    absent = "gmsh" not in sys.modules
    if absent:
        sys.modules["gmsh"] = types.ModuleType("gmsh")
    printing = np.get_printoptions()
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            import jax_fem
            import jax_fem.generate_mesh
            import jax_fem.problem
        jax_fem.logger.setLevel(logging.WARNING)
    finally:
        np.set_printoptions(**printing)
        if absent:
            del sys.modules["gmsh"]
    return jax_fem


class Equilibrium(NamedTuple):
    """Where Newton's method ended: displacement, relative residuals, nodal forces."""

    u: np.ndarray | None
    history: list[float]
    force: np.ndarray


class EquilibriumSolver:
    """Quasi-static equilibrium of one sheet: stress law, mesh and constraints.

    Args:
        mesh: quadrilateral mesh.
        stress: P = stress(F, params) with F[i, J] and P[i, J] at one point.
        point_parameters: pytree of arrays (cell, ...), the params of ``stress`` by cell.
    """

    def __init__(self, mesh: Mesh, stress: Callable, point_parameters: Mapping):
        jax_fem = _import_jax_fem()
        names = tuple(point_parameters)

        class Sheet(jax_fem.problem.Problem):
            def get_tensor_map(self):
                def tensor_map(grad_u, *values):
                    return stress(grad_u + jnp.eye(2), dict(zip(names, values, strict=True)))

                return tensor_map

            def pre_jit_fns(self):
                super().pre_jit_fns()
                self.kernel_jac = jax.jit(jax.vmap(cell_tangent))

            def split_and_compute_cell(self, cells_sol_flat, np_version, jac_flag, internal_vars):
                # One compiled call: the twenty slices that spare a small device's memory take as long again.
                kernel = self.kernel_jac if jac_flag else self.kernel
                return kernel(cells_sol_flat, *self.geometry, *internal_vars)

        def cell_tangent(u, points, gradient, weight, weighted_gradient, *values):
            """(nodal forces (8,), their derivative (8, 8)) of one cell, by the chain rule through F.

            Four derivatives at a quadrature point, of P with respect to F, where JAX-FEM takes eight of the
            whole cell, one a nodal displacement.
            """

            def stress_at(F, *values):
                P = stress(F, dict(zip(names, values, strict=True)))
                return P, P

            F = jnp.eye(2) + jnp.einsum("ai,qaJ->qiJ", u.reshape(4, 2), gradient)
            A, P = jax.vmap(jax.jacfwd(stress_at, has_aux=True))(F, *values)
            force = jnp.einsum("q,qaJ,qiJ->ai", weight[0], gradient, P)
            stiffness = jnp.einsum("q,qaJ,qiJkL,qbL->aibk", weight[0], gradient, A, gradient)
            return force.ravel(), stiffness.reshape(8, 8)

        if not jax.config.jax_enable_x64:
            raise RuntimeError("finite elements need float64: enable jax_enable_x64 first")
        self.mesh = mesh
        mesh_fem = jax_fem.generate_mesh.Mesh(mesh.nodes, mesh.cells, ele_type="QUAD4")
        self._problem = Sheet(mesh_fem, vec=2, dim=2, ele_type="QUAD4", gauss_order=2)
        self.set_parameters(point_parameters)
        problem = self._problem
        geometry = problem.physical_quad_points, problem.shape_grads, problem.JxW, problem.v_grads_JxW
        problem.geometry = tuple(map(jnp.asarray, geometry))
        self._dofs = (2 * mesh.cells[:, :, None] + np.arange(2)).reshape(len(mesh.cells), -1)
        self._residual = jax.jit(lambda u, values: problem.compute_residual_vars([u], values, [])[0])

    def set_parameters(self, point_parameters: Mapping) -> None:
        """Replace the material parameters; shapes must stay the same."""
        quads = self._problem.fes[0].num_quads
        self._problem.internal_vars = [
            jnp.repeat(jnp.asarray(value)[:, None], quads, axis=1) for value in point_parameters.values()
        ]

    @property
    def shape_gradients(self) -> tuple[Array, Array]:
        """(dN_a/dX_J (cell, quad, 4, 2), quadrature weights (cell, quad)) of the bilinear cells."""
        element = self._problem.fes[0]
        return jnp.asarray(element.shape_grads), jnp.asarray(element.JxW)

    @property
    def quadrature_points(self) -> Float[np.ndarray, "cell quad 2"]:
        """Reference positions of the quadrature points."""
        return np.asarray(self._problem.physical_quad_points)

    def deformation_gradient(self, u: Float[np.ndarray, "node 2"]) -> Float[np.ndarray, "cell quad 2 2"]:
        """F at the quadrature points."""
        return np.asarray(self._problem.fes[0].sol_to_grad(u)) + np.eye(2)

    def internal_force(self, u: Float[np.ndarray, "node 2"]) -> Float[np.ndarray, "node 2"]:
        """Nodal forces that hold the sheet in the state ``u``, per unit thickness."""
        return np.asarray(self._residual(jnp.asarray(u), self._problem.internal_vars))

    def tangent(self, u: Float[np.ndarray, "node 2"]):
        """(nodal forces as a flat vector, sparse tangent stiffness) in the state ``u``."""
        problem, dofs = self._problem, np.size(u)
        forces, stiffness = problem.split_and_compute_cell(np.ravel(u)[self._dofs], np, True, problem.internal_vars)
        residual = np.bincount(self._dofs.ravel(), np.ravel(forces), dofs)
        K = scipy.sparse.coo_matrix((np.ravel(stiffness), (problem.I, problem.J)), (dofs, dofs))
        return residual, K.tocsc()

    def constrained_dofs(self, load: Load) -> np.ndarray:
        """Flat numbers (2 node + component) of the constrained degrees of freedom.

        Where a load leaves a rigid translation free, one corner node holds it; its reaction
        vanishes at equilibrium.
        """
        mask = np.zeros((len(self.mesh.nodes), 2), dtype=bool)
        for edge, component in load.constrained:
            mask[self.mesh.on_edge(edge), component] = True
        for component in range(2):
            if not mask[:, component].any():
                corner = np.argmin(np.abs(self.mesh.nodes - self.mesh.lower).sum(axis=1))
                mask[corner, component] = True
        return np.flatnonzero(mask.ravel())

    def newton(self, u, fixed, tolerance: float = 1e-10, factor=None):
        """Equilibrium from the guess ``u``, whose ``fixed`` degrees of freedom stay as they are.

        Converged when the free residual is below ``tolerance`` times the reaction norm, or below
        it times the norm at the first guess where there is no reaction.

        Args:
            factor: factors of the free tangent of a state near by. They serve as long as every step with them
                leaves little of the residual, which costs a fraction of a step with factors of its own.

        Returns:
            The state reached; its ``u`` is None where Newton's method does not converge.
        """
        free = np.setdiff1d(np.arange(u.size), fixed)
        u, history = u.copy(), []
        for _ in range(MAX_ITERATIONS):
            residual = self.internal_force(u).ravel()
            scale = max(np.linalg.norm(residual[fixed]), 1e-300)
            history.append(np.linalg.norm(residual[free]) / scale)
            if not np.isfinite(history[-1]) or history[-1] > 1e8:
                break
            if history[-1] <= tolerance:
                return Equilibrium(u, history, residual)
            if factor is None or (len(history) > 1 and history[-1] > SLOW * history[-2]):
                _, K = self.tangent(u)
                factor = factorise(K[free][:, free])
            step = np.zeros(u.size)
            step[free] = factor.solve(residual[free])
            u = u - step.reshape(u.shape)
        return Equilibrium(None, history, residual)

    def solve(self, load: Load, progress: Callable = lambda step, history: None):
        """Displacements at every load step, each started from the last plus an affine increment.

        A step that does not converge is reached in halves, down to 2^-6 of itself.

        Args:
            load: the load case.
            progress: called as progress(step, relative residuals) after each step.

        Returns:
            u[step, node, i] and the final relative residual of each step.

        Raises:
            ConvergenceError: a step does not converge even in the smallest increments.
        """
        fixed = self.constrained_dofs(load)
        position = self.mesh.nodes - self.mesh.lower
        u, H = np.zeros_like(self.mesh.nodes), np.zeros((2, 2))
        fields, residuals = [], []
        for step, target in enumerate(load.H):
            start, fraction, size, bisections = (u, H), 0.0, 1.0, 0
            while fraction < 1.0:
                size = min(size, 1.0 - fraction)
                new_H = start[1] + (fraction + size) * (target - start[1])
                found = self.newton(u + position @ (new_H - H).T, fixed)
                history = found.history
                if found.u is not None:
                    u, H, fraction = found.u, new_H, fraction + size
                    continue
                bisections += 1
                if bisections > MAX_BISECTIONS:
                    raise ConvergenceError(
                        f"load step {step} (stretch {load.stretch[step]:.4g}): Newton's method stopped at a "
                        f"relative residual of {history[-1]:.2e} after {len(history)} iterations and "
                        f"{MAX_BISECTIONS} halvings of the increment"
                    )
                size *= 0.5
            fields.append(u)
            residuals.append(history[-1])
            progress(step, history)
        return np.stack(fields), np.array(residuals)

    def edge_forces(self, u, load: Load) -> dict[tuple[str, int], float]:
        """Resultant outward force on each constrained edge and component, per unit thickness."""
        force = self.internal_force(u)
        return {
            (edge, component): float(force[self.mesh.on_edge(edge), component].sum())
            for edge, component in load.constrained
        }


def closed_form_stress(models: tuple[str, ...]) -> Callable:
    """P(F, params) at one point for a field whose points belong to one of ``models``."""

    def stress(F, params):
        angle = params.get("fibre_angle", 0.0)
        dPsi = energy_derivatives(models, invariants(F, angle), params)
        return first_piola_kirchhoff(F, dPsi, angle)

    return stress


__all__ = ["ConvergenceError", "EquilibriumSolver", "closed_form_stress"]
