"""The forward problem of the identification: displacements and forces of a material field, with exact derivatives.

It combines the observations of a test with the finite-element equilibrium of every load step for a field of parameters
of a law.
"""

import copy
import functools
from collections.abc import Callable
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.config.methods import Constrained
from hypernode.data.measurement import force_uncertainty
from hypernode.fem.cells import filled
from hypernode.fem.mesh import Mesh
from hypernode.fem.refinement import Refinement
from hypernode.identification import numerics
from hypernode.identification.cellwise import cell_sensitivity, log_stress
from hypernode.identification.equilibrium import FieldEquilibrium, State
from hypernode.identification.homogeneous import Homogeneous, fit_homogeneous
from hypernode.identification.observations import Observations, observe
from hypernode.identification.resultants import EdgeForce, edge_forces, shared_errors
from hypernode.identification.sensitivities import Jacobian, StepJacobian, quadrature
from hypernode.mechanics.convex_basis import RIGID, ConvexBasis
from hypernode.mechanics.point_law import PointLaw


class FieldProblem:
    """The observations of a test and the equilibrium that ties a material field to them; see :func:`field_problem`.

    Attributes:
        basis: the law whose parameters the field holds, a convex basis unless said otherwise.
        forces: measured resultants.

    Args:
        fit: of the homogeneous material; left out where no descent begins at it.
    """

    def __init__(
        self,
        *,
        observations: Observations,
        basis: PointLaw,
        forces: list[EdgeForce],
        fit: Callable[["FieldProblem"], Homogeneous] | None = None,
    ):
        self.observations, self.basis, self.forces, self._fit = observations, basis, forces, fit
        self._mean = jnp.asarray(observations.mean_F), observations.loading.scale
        # Terms differ by how steps differ, in directions that noise hides; without it they decide where a step leads.
        self._shares = self._shares_of_steps()

    @functools.cached_property
    def equilibrium(self) -> FieldEquilibrium:
        """Finite elements of the sheet, every cell a material of its own; made when they are first asked for."""
        return FieldEquilibrium.of(self.observations, self.basis)

    @functools.cached_property
    def _elements(self):
        """(cells as many as are compiled for, their shape gradients, rows and columns of :meth:`linearise`)."""
        cells, count = len(self.mesh.cells), len(self.basis.names)
        every = filled(cells)
        geometry = [np.asarray(each)[every] for each in self.equilibrium.shape_gradients]
        rows = np.repeat(self.mesh.dofs[:, :, None], count, axis=2).ravel()
        columns = np.arange(cells)[:, None] * count + np.arange(count)
        return every, geometry, rows, np.repeat(columns[:, None], 8, axis=1).ravel()

    @functools.cached_property
    def homogeneous(self) -> Homogeneous | None:
        """The homogeneous material that the test is closest to; None where no descent begins at it."""
        return None if self._fit is None else self._fit(self)

    @functools.cached_property
    def bounds(self) -> Float[np.ndarray, "2 parameter"]:
        """Least and largest parameters of a material: beyond them it is rigid beside the sheet, or hardly there."""
        bounds = np.stack([self.basis.lowest, self.basis.highest])
        bounds[:, 0] = self.homogeneous.params[0] + np.log(RIGID) * np.array([-1.0, 1.0])
        return bounds

    @property
    def refinement(self) -> Refinement:
        """How the measured cells are divided."""
        return self.observations.refinement

    @property
    def mesh(self) -> Mesh:
        """The mesh of the subcells, each a material of its own."""
        return self.refinement.mesh

    @property
    def sigma(self) -> float:
        """Standard deviation of the displacements."""
        return self.observations.sigma

    @property
    def solver_error(self) -> float:
        """How far displacements are from equilibrium, over their standard deviation."""
        return numerics.NEWTON_TOLERANCE * float(np.abs(self.observations.u).max()) / self.sigma

    @property
    def noisy(self) -> bool:
        """Whether noise dominates the discretisation error."""
        return self.observations.noisy

    @property
    def sharp(self) -> bool:
        """Whether displacements are noisy and were observed point by point."""
        return self.noisy and self.observations.window == 0.0

    @property
    def blurred(self) -> bool:
        """Whether interfaces may cut cells, and noise is too small to hide it."""
        return not self.noisy and not self.observations.own_grid

    @property
    def certain(self) -> bool:
        """Whether displacements are exact finite-element displacements on this very grid."""
        return not self.noisy and self.observations.own_grid

    @property
    def observed(self) -> int:
        """Number of observed displacements: measured, not prescribed and not lost, over all load steps."""
        return sum(len(boundary.observed) for boundary in self.observations.boundaries)

    @property
    def cost_of_noise(self) -> float:
        """Expected cost of the noise at the true field."""
        return 0.5 * self.observed

    def _shares_of_steps(self):
        return _quadrature(self.observations) if self.noisy else np.ones(len(self.observations.u))

    def of_steps(self, steps: Int[np.ndarray, " kept"]) -> "FieldProblem":
        """The same with some of its load steps: their displacements, forces and boundaries, as uncertain as before."""
        place = {int(step): number for number, step in enumerate(steps)}
        other = copy.copy(self)
        other._fit = lambda _: self.homogeneous
        other.observations = self.observations.of_steps(steps)
        other.equilibrium = self.equilibrium.under_boundaries(other.observations.boundaries)
        other.forces = [replace(force, step=place[force.step]) for force in self.forces if force.step in place]
        other._shares = other._shares_of_steps()
        return other

    def stiffness(self, params: Float[np.ndarray, "cell parameter"]):
        """(logarithm of the stress under the mean deformation of the sheet (cell,), its derivative)."""
        value, derivative = log_stress(self.basis)(params[filled(len(params))], *self._mean)
        return np.asarray(value)[: len(params)], np.asarray(derivative)[: len(params)]

    def residuals(self, states: list[State]) -> tuple[list[np.ndarray], np.ndarray]:
        """(misfit of the observed displacements by step, misfit of the forces over their uncertainty)."""
        each = zip(self.observations.boundaries, states, strict=True)
        u = [boundary.observe @ state.u.ravel() - boundary.seen for boundary, state in each]
        f = [(f.direction @ states[f.step].force - f.value) / f.sigma for f in self.forces]
        return u, np.array(f)

    def linearise(self, params, states: list[State], sigma: float) -> Jacobian:
        """Derivative of the residuals by the parameters, where displacements have the uncertainty ``sigma``."""
        shape = (self.mesh.nodes.size, params.size)
        tangents = self.equilibrium.tangents(params, [state.u for state in states])
        params, steps = self.equilibrium.of_sheet(params), []
        every, geometry, rows, columns = self._elements
        for number, (state, K, boundary) in enumerate(zip(states, tangents, self.observations.boundaries, strict=True)):
            given = state.u[self.mesh.cells][every], params[every], *geometry
            cellwise = np.asarray(cell_sensitivity(self.basis)(*given))[: len(params)]
            B = scipy.sparse.csr_matrix((cellwise.ravel(), (rows, columns)), shape)
            forces = [(force.direction, force.sigma) for force in self.forces if force.step == number]
            seen = boundary.observe / sigma
            steps.append(StepJacobian(K=K, B=B, free=state.free, observe=seen, forces=forces, errors=boundary.errors))
        errors = shared_errors(self.forces) / np.array([force.sigma for force in self.forces])[:, None]
        of_forces = [force.step for force in self.forces]
        return Jacobian(steps=steps, force_steps=of_forces, force_errors=errors, sigma=sigma, shares=self._shares)


def field_problem(
    measurement,
    settings: Constrained,
    subcells: int = 1,
    floor: float | None = None,
    at_lines: bool = False,
) -> FieldProblem:
    """The problem of a measurement: its observations, the homogeneous fit, and forces as certain as the load cell is.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        subcells: rows and columns into which every measured cell is divided.
        floor, at_lines: error of the description by finite elements; see :func:`observe`.
    """
    observations = observe(measurement, subcells, floor, at_lines)
    stretch = observations.largest_stretch
    basis = ConvexBasis(tuple(settings.terms), 2.0 * stretch**2 + stretch**-4 - 3.0)
    return FieldProblem(
        observations=observations,
        basis=basis,
        forces=_forces(measurement, observations, settings),
        fit=lambda own: fit_homogeneous(own.observations, own.basis, own.equilibrium),
    )


def with_law(problem: FieldProblem, law: PointLaw) -> FieldProblem:
    """The same test of a sheet of another law; the homogeneous fit stays that of the first."""
    return FieldProblem(
        observations=problem.observations, basis=law, forces=problem.forces, fit=lambda _: problem.homogeneous
    )


def problem_of_basis(
    measurement,
    settings: Constrained,
    basis: PointLaw,
    subcells: int = 1,
    floor: float | None = None,
    at_lines: bool = False,
) -> FieldProblem:
    """The problem of a measurement whose material is known in terms of a law: nothing is fitted.

    Args:
        measurement, settings, subcells, floor, at_lines: as of :func:`field_problem`.
        basis: the law; a convex basis has the scale of the identification that made the field.
    """
    observations = observe(measurement, subcells, floor, at_lines)
    forces = _forces(measurement, observations, settings)
    return FieldProblem(observations=observations, basis=basis, forces=forces)


def _forces(measurement, observations: Observations, settings: Constrained) -> list[EdgeForce]:
    """The resultants, as certain as the load cell is said to be."""
    relative = np.maximum(settings.force_noise, force_uncertainty(measurement))
    return edge_forces(measurement, observations.refinement.mesh, relative)


def _quadrature(observations: Observations) -> Float[np.ndarray, " step"]:
    """Weight of every step, so that a few steps of each load case stand for all of its steps."""
    loading = observations.loading
    shares = np.empty(len(observations.u))
    for case in np.unique(loading.load_case):
        steps = loading.load_case == case
        shares[steps] = quadrature(loading.t[steps])
    return shares
