"""Newton's method for displacement-driven hyperelastic sheets, assembled by JAX-FEM.

This is the only module that imports ``jax_fem``. Its ``problem`` and ``fe`` modules are used; its
``solver`` is not, because that needs PETSc, which has no wheel (see docs/decisions).
"""

import contextlib
import functools
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
from hypernode.fem.cells import cell_forces, filled
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.mechanics.closed_forms import energy_derivatives
from hypernode.mechanics.kinematics import invariants
from hypernode.mechanics.loads import Load
from hypernode.mechanics.point_law import PointLaw
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
        if not jax.config.jax_enable_x64:
            raise RuntimeError("finite elements need float64: enable jax_enable_x64 first")
        jax_fem = _import_jax_fem()
        self.mesh = mesh
        mesh_fem = jax_fem.generate_mesh.Mesh(mesh.nodes, mesh.cells, ele_type="QUAD4")
        problem = self._problem = jax_fem.problem.Problem(mesh_fem, vec=2, dim=2, ele_type="QUAD4", gauss_order=2)
        self._dofs = (2 * mesh.cells[:, :, None] + np.arange(2)).reshape(len(mesh.cells), -1)
        self._filled = filled(len(mesh.cells))
        self._geometry = [
            jnp.asarray(np.asarray(each)[self._filled]) for each in (problem.shape_grads, problem.JxW[:, 0])
        ]
        self._forces, self._tangent = cell_forces(stress, tuple(point_parameters))
        self.set_parameters(point_parameters)

    def set_parameters(self, point_parameters: Mapping) -> None:
        """Replace the material parameters; shapes must stay the same."""
        self._parameters = [jnp.asarray(np.asarray(value)[self._filled]) for value in point_parameters.values()]

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
        return self._assembled(self._of_cells(self._forces, u)).reshape(np.shape(u))

    def tangent(self, u: Float[np.ndarray, "node 2"]):
        """(nodal forces as a flat vector, sparse tangent stiffness) in the state ``u``."""
        problem, count, cells = self._problem, np.size(u), len(self._dofs)
        forces, stiffness = self._of_cells(self._tangent, u)
        K = np.ravel(np.asarray(stiffness)[:cells])
        K = scipy.sparse.coo_matrix((K, (problem.I, problem.J)), (count, count))
        return self._assembled(forces), K.tocsc()

    def _of_cells(self, function, u):
        """What a compiled function makes of every cell, and of those that fill them up."""
        return function(np.ravel(u)[self._dofs][self._filled], *self._geometry, *self._parameters)

    def _assembled(self, forces) -> np.ndarray:
        """Nodal forces as a flat vector, of those of cells."""
        count, cells = self.mesh.nodes.size, len(self._dofs)
        return np.bincount(self._dofs.ravel(), np.ravel(np.asarray(forces)[:cells]), count)

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


@functools.lru_cache(maxsize=16)
def law_stress(law: PointLaw) -> Callable:
    """P(F, params) at one point of a law whose parameters are ``params["params"]``; one function for one law."""
    return lambda F, params: law.stress(F, params["params"])


@functools.lru_cache(maxsize=16)
def closed_form_stress(models: tuple[str, ...]) -> Callable:
    """P(F, params) at one point for a field whose points belong to one of ``models``."""

    def stress(F, params):
        angle = params.get("fibre_angle", 0.0)
        dPsi = energy_derivatives(models, invariants(F, angle), params)
        return first_piola_kirchhoff(F, dPsi, angle)

    return stress


__all__ = ["ConvergenceError", "EquilibriumSolver", "closed_form_stress", "law_stress"]
