"""Equilibrium of every load step of a test for a field of parameters of a law."""

import copy
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.fem.factors import factorise
from hypernode.fem.mesh import EDGE_NAMES, Mesh
from hypernode.fem.solver import EquilibriumSolver, law_stress
from hypernode.identification import numerics
from hypernode.identification.boundary import Boundary
from hypernode.identification.observations import Observations
from hypernode.mechanics.loads import Load
from hypernode.mechanics.point_law import PointLaw


@dataclass(frozen=True)
class State:
    """Equilibrium of one load step for one material field.

    Attributes:
        u: displacement (node, 2).
        force: nodal forces (degree of freedom,).
        free: degrees of freedom that are not prescribed.
    """

    u: np.ndarray
    force: np.ndarray
    free: np.ndarray


class FieldEquilibrium:
    """Finite elements of one sheet whose boundary moves as it was measured.

    Args:
        tolerance: relative residual at which a state counts as equilibrium.
        relative_thickness: of every cell.
    """

    def __init__(
        self,
        *,
        mesh: Mesh,
        law: PointLaw,
        boundaries: tuple[Boundary, ...],
        tolerance: float,
        relative_thickness: Float[np.ndarray, " cell"],
    ):
        self.mesh, self.boundaries, self._tolerance = mesh, boundaries, tolerance
        self._log_thickness = np.log(relative_thickness)
        self._solver = EquilibriumSolver(
            mesh,
            law_stress(law),
            {"params": np.tile(law.start, (len(mesh.cells), 1))},
        )

    @classmethod
    def of(cls, observations: Observations, law: PointLaw) -> "FieldEquilibrium":
        """That of the sheet of a test."""
        mesh, thickness = observations.refinement.mesh, observations.relative_thickness
        return cls(
            mesh=mesh,
            law=law,
            boundaries=observations.boundaries,
            tolerance=numerics.NEWTON_TOLERANCE,
            relative_thickness=thickness,
        )

    def under_boundaries(self, boundaries: tuple[Boundary, ...]) -> "FieldEquilibrium":
        """The same sheet, and its compiled finite elements, whose boundary moves otherwise."""
        other = copy.copy(self)
        other.boundaries = boundaries
        return other

    @property
    def shape_gradients(self):
        """(dN_a/dX_J (cell, quad, 4, 2), quadrature weights (cell, quad))."""
        return self._solver.shape_gradients

    def of_sheet(self, params: Float[np.ndarray, "cell parameter"]) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of the sheet of one thickness that is as stiff: its stress is the exponential of the first."""
        sheet = np.array(params)
        sheet[:, 0] += self._log_thickness
        return sheet

    def states(self, params: Float[np.ndarray, "cell parameter"], guesses, factors=None) -> list[State] | None:
        """Equilibrium of every load step, or None where Newton's method fails for one.

        Args:
            guesses: displacement of every step to begin from.
            factors: factors of the free tangents of states near by.
        """
        self._solver.set_parameters({"params": self.of_sheet(params)})
        found = []
        each = zip(guesses, self.boundaries, factors or [None] * len(guesses), strict=True)
        for guess, boundary, factor in each:
            reached = self._solver.newton(guess, boundary.prescribed, self._tolerance, factor)
            if reached.u is None:
                return None
            found.append(State(reached.u, reached.force, boundary.free))
        return found

    def under(
        self, params: Float[np.ndarray, "cell parameter"], load: Load
    ) -> tuple[Float[np.ndarray, "step node 2"], Float[np.ndarray, "step edge 2"]]:
        """(displacement, outward force over thickness on every edge, NaN where free) under a load of its own.

        Raises:
            ConvergenceError: a step finds no equilibrium.
        """
        self._solver.set_parameters({"params": self.of_sheet(params)})
        u, _ = self._solver.solve(load)
        force = np.full((len(u), len(EDGE_NAMES), 2), np.nan)
        for step, field in enumerate(u):
            for (edge, component), value in self._solver.edge_forces(field, load).items():
                force[step, EDGE_NAMES.index(edge), component] = value
        return u, force

    def extension(self, params: Float[np.ndarray, "cell parameter"]) -> list[np.ndarray]:
        """First guesses: the prescribed displacements continued into the sheet by linear elasticity."""
        K = next(self.tangents(params, [np.zeros_like(self.mesh.nodes)]))
        guesses = []
        for boundary in self.boundaries:
            free = boundary.free
            u = np.where(boundary.mask, boundary.values, 0.0).ravel()
            u[free] = -factorise(K[free][:, free]).solve((K @ u)[free])
            guesses.append(u.reshape(-1, 2))
        return guesses

    def tangents(self, params: Float[np.ndarray, "cell parameter"], displacements) -> Iterator:
        """Tangent stiffness (degree of freedom, degree of freedom) in each of the given states, one after the other."""
        for u in displacements:
            self._solver.set_parameters({"params": self.of_sheet(params)})
            yield self._solver.tangent(u)[1]
