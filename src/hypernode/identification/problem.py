"""What equilibrium makes of a material field: displacements and forces, and their derivatives.

The forward half of :mod:`hypernode.stages.constrained`: the data of a measurement, the finite-element
equilibrium of every load step for a field of convex-basis parameters, and the exact linearisation of
the one with respect to the other.
"""

import dataclasses
import itertools
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import scipy.sparse
from jaxtyping import Float
from scipy.optimize import least_squares

from hypernode.config.methods import Constrained
from hypernode.data.loading import Loading
from hypernode.data.measurement import displacement_noise, mesh_of, stress_resultants
from hypernode.fem.factors import factorise
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.fem.refinement import refine
from hypernode.fem.solver import EquilibriumSolver
from hypernode.identification.boundary import prescribed_displacement
from hypernode.identification.camera import window_average
from hypernode.identification.sensitivities import Jacobian, StepJacobian, quadrature
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, ConvexBasis

#: Displacements are never trusted beyond this share of the largest one, noise apart: what finite elements on the
#: measured grid make of a field that was computed on that same grid, and of one that was seen through a
#: correlation window, whose interfaces lie anywhere; the latter on cells divided into parts.
SAME_GRID_FLOOR, WINDOW_FLOOR, PARTS_FLOOR = 3.8e-5, 1.3e-3, 2e-4


#: Misfit of the best homogeneous material of one test beyond which the basis cannot describe the forces (a
#: record with rate effects, say); their uncertainty is then that misfit. Below it, heterogeneity explains it,
#: as it does what several tests together leave: each would have a homogeneous material of its own.
DESCRIPTION_ERROR = 0.015


#: Preference of the homogeneous fit for the plainest material, in units of a misfit of 1 %.
STRONG_RIDGE, WEAK_RIDGE = 0.3, 0.03


#: How often what clamps do to a homogeneous sheet is computed anew.
BENT_ROUNDS = 3


NEWTON_TOLERANCE = 1e-6


#: Of weights that sum to one.
ROUNDING = 1e-9


@dataclasses.dataclass
class State:
    """Equilibrium of one load step for one material field."""

    u: np.ndarray
    force: np.ndarray
    free: np.ndarray


@dataclasses.dataclass
class EdgeForce:
    """A measured resultant: load step, indicator of its degrees of freedom, value and its uncertainty."""

    step: int
    direction: np.ndarray
    value: float
    sigma: float


class FieldProblem:
    """The data of a measurement and the equilibrium that ties a material field to them.

    Args:
        measurement: an opened measurement file.
        settings: configuration of the stage.
        parts: rows and columns into which every measured cell is divided, each part a material of its own.
    """

    def __init__(self, measurement, settings: Constrained, parts: int = 1):
        self.grid, self.loading = mesh_of(measurement), Loading.of(measurement)
        self.refinement = refine(self.grid, parts)
        self.mesh, self.divided = self.refinement.mesh, parts > 1
        self.u = measurement["u_measured"].values.mean(axis=0)
        noise = displacement_noise(measurement)
        window = float(measurement.attrs["correlation_window"])
        floor = (PARTS_FLOOR if self.divided else WINDOW_FLOOR) if window > 0.0 else SAME_GRID_FLOOR
        floor *= np.abs(self.u).max()
        self.sigma, self.noisy = float(np.hypot(noise, floor)), noise >= floor
        # Where interfaces lie anywhere, cells that they cut are something in between; noise may hide of what.
        self.sharp = self.noisy and window == 0.0
        self.blurred = not self.noisy and window > 0.0
        stretch = float(measurement["stretch"].values.max())
        self.basis = ConvexBasis(tuple(settings.terms), 2.0 * stretch**2 + stretch**-4 - 3.0)
        cells = len(self.mesh.cells)
        self.solver = EquilibriumSolver(
            self.mesh,
            lambda F, p: self.basis.stress(F, p["params"]),
            {"params": np.tile(self.basis.start, (cells, 1))},
        )
        self._hold(measurement, noise)
        measured = 2 * self.refinement.nodes[:, None] + np.arange(2)
        observe = window_average(self.mesh, window)[measured.ravel()]
        self.observe = [observe[seen] for seen in self.seen]
        area = self.grid.areas / self.grid.areas.sum()
        self._mean_F = jnp.asarray(np.einsum("scij,c->ijs", deformation_gradient(self.grid, self.u), area))
        self.homogeneous, self.force_misfit = self._homogeneous(measurement.attrs["outline"] == "cut")
        described = self.force_misfit <= DESCRIPTION_ERROR
        relative = np.where(described, settings.force_noise, self.force_misfit)[self.loading.load_case]
        self._edge_forces(measurement, np.maximum(relative, float(measurement.attrs["force_uncertainty"])))
        # Terms differ by how steps differ, in directions that noise hides; without it they decide where a step leads.
        self._shares = self._quadrature() if self.noisy else np.ones(len(self.u))
        self._sensitivity = jax.jit(jax.vmap(self._cell_sensitivity))
        self._stiffness = jax.jit(jax.vmap(jax.value_and_grad(self._log_stress)))
        self._gradients, self._weights = self.solver.shape_gradients
        dofs = (2 * self.mesh.cells[:, :, None] + np.arange(2)).reshape(cells, 8)
        count = len(self.basis.names)
        self._rows = np.repeat(dofs[:, :, None], count, axis=2).ravel()
        columns = np.arange(cells)[:, None] * count + np.arange(count)
        self._columns = np.repeat(columns[:, None], 8, axis=1).ravel()

    @property
    def cost_of_noise(self) -> float:
        """Half the number of measured displacements: what noise of the assumed size costs at the true field."""
        return 0.5 * sum(len(seen) for seen in self.seen)

    def _quadrature(self) -> Float[np.ndarray, " step"]:
        """Weight of every step, so that a few steps of each test stand for all of its steps."""
        shares = np.empty(len(self.u))
        for case in np.unique(self.loading.load_case):
            steps = self.loading.load_case == case
            shares[steps] = quadrature(self.loading.t[steps])
        return shares

    def _hold(self, measurement, noise: float) -> None:
        """Prescribed, free and seen degrees of freedom of every step, and how wrong the prescribed ones may be.

        Where the grid is cut out of a larger sheet, its outline is no edge of the sheet: the measured
        displacement holds it all round, and no traction there is assumed to vanish.
        """
        held = measurement["edge_constrained"].values > 0
        if measurement.attrs["outline"] == "cut":
            held = np.ones_like(held)
        found = [prescribed_displacement(self.grid, u, h, noise) for u, h in zip(self.u, held, strict=True)]
        between = self.refinement.interpolation
        self.values = [between @ edges.values for edges in found]
        both = scipy.sparse.kron(between, scipy.sparse.identity(2), format="csr")
        self.edge_errors = [both @ edges.errors for edges in found]
        self.masks, self.fixed, self.free, self.seen = [], [], [], []
        for edges in found:
            mask = edges.mask
            for i in np.flatnonzero(~mask.any(axis=0)):
                mask[np.argmin(np.abs(self.grid.nodes - self.grid.lower).sum(axis=1)), i] = True
            self.seen.append(np.flatnonzero(~mask.ravel()))
            # A node between two that are held is held as well.
            mask = between @ mask > 1.0 - ROUNDING
            self.masks.append(mask)
            self.fixed.append(np.flatnonzero(mask.ravel()))
            self.free.append(np.flatnonzero(~mask.ravel()))

    def _homogeneous(self, cut: bool) -> tuple[np.ndarray, np.ndarray]:
        """(parameters of one homogeneous material, smallest relative misfit of each test's mean stresses).

        The first comes from a fit to all tests that prefers the plainest material, the second from fits to
        one test that hardly do: what no material of the basis can follow is an error of the description.

        Mean stresses are those of the mean deformation, and where clamps bend even a homogeneous sheet, what that
        changes is computed and taken into account. Not where the grid is cut out of a larger sheet: clamps are far.
        """
        loading = self.loading
        target, known = np.moveaxis(loading.P_average, 0, -1), np.moveaxis(loading.measured, 0, -1)
        start = self.basis.start
        start[0] = np.log(0.3 * loading.scale.max())

        def relative(params, target, mean_F, scale):
            return (self.basis.stress(mean_F, params[:, None]) - target) / scale

        # Data are arguments, so that tests of as many steps share what is compiled.
        value, derivative = (
            partial(jax.jit(function), mean_F=self._mean_F, scale=loading.scale)
            for function in (relative, jax.jacfwd(relative))
        )

        def measured(values, steps):
            return np.asarray(values)[:, :, steps][known[:, :, steps]]

        # Fibres begin above zero, where they have a gradient, but the plainest material has none.
        plainest = np.array([0.0 if key in FIBRE_VECTOR else p for key, p in zip(self.basis.names, start, strict=True)])

        def fit(ridge, steps, target):
            ridges = ridge * np.eye(len(start))[1:]
            return least_squares(
                lambda p: np.concatenate([100.0 * measured(value(p, target), steps), ridges @ (p - plainest)]),
                start,
                jac=lambda p: np.concatenate([100.0 * measured(derivative(p, target), steps), ridges]),
            ).x

        found = fit(STRONG_RIDGE, slice(None), target)
        clamped = loading.constrained.all(axis=2).any()
        straight = target
        for _ in range(BENT_ROUNDS if clamped and not cut else 0):
            bent = self._bending(found)
            if bent is None:
                break
            straight = target - bent
            found = fit(STRONG_RIDGE, slice(None), straight)
        tests = [loading.load_case == k for k in range(loading.load_case.max() + 1)]
        fits = [(fit(WEAK_RIDGE, steps, straight), steps) for steps in tests]
        closest = [np.sqrt(np.mean(measured(value(params, straight), steps) ** 2)) for params, steps in fits]
        return found, np.array(closest)

    def _bending(self, params) -> Float[np.ndarray, "2 2 step"] | None:
        """Mean stress of a homogeneous sheet beyond that of its mean deformation, or None without equilibrium."""
        everywhere = np.tile(params, (len(self.mesh.cells), 1))
        states = self.states(everywhere, self.extension(everywhere))
        if states is None:
            return None
        area = self.mesh.areas / self.mesh.areas.sum()
        P = [np.einsum("ai,aJ->iJ", s.force.reshape(-1, 2), self.mesh.nodes) / self.mesh.areas.sum() for s in states]
        F = np.einsum("scij,c->ijs", deformation_gradient(self.mesh, np.stack([s.u for s in states])), area)
        return np.stack(P, axis=-1) - np.asarray(self.basis.stress(F, params[:, None]))

    def _edge_forces(self, measurement, relative: Float[np.ndarray, " step"]) -> None:
        """Measured resultants, one a step and component; their overall balance gives the other edge.

        Not where the grid is cut out of a larger sheet: its sides carry forces that are not known, so that
        both resultants say something.
        """
        cut = measurement.attrs["outline"] == "cut"
        force = stress_resultants(measurement)
        constrained = measurement["edge_constrained"].values > 0
        largest = np.nanmax(np.abs(force), axis=(1, 2))
        self.forces = []
        for step in range(len(self.u)):
            for edges, i in itertools.product((("right", "left"), ("top", "bottom")), range(2)):
                for edge in edges:
                    e = EDGE_NAMES.index(edge)
                    if constrained[step, e, i] and np.isfinite(force[step, e, i]):
                        direction = np.zeros(self.mesh.nodes.shape)
                        direction[self.mesh.on_edge(edge), i] = 1.0
                        sigma = relative[step] * max(abs(force[step, e, i]), 0.1 * largest[step])
                        self.forces.append(EdgeForce(step, direction.ravel(), float(force[step, e, i]), sigma))
                        if not cut:
                            break

    def _cell_sensitivity(self, u, params, gradient, weight):
        """d(nodal forces)/d(parameters) of one cell (8, parameter)."""

        def nodal(params):
            F = jnp.eye(2)[:, :, None] + jnp.einsum("ai,qaJ->iJq", u, gradient)
            return jnp.einsum("q,qaJ,iJq->ai", weight, gradient, self.basis.stress(F, params[:, None])).ravel()

        return jax.jacfwd(nodal)(params)

    def _log_stress(self, params):
        """Logarithm of the size of the stress under the mean deformation of the sheet, every step over its scale."""
        P = self.basis.stress(self._mean_F, params[:, None]) / self.loading.scale
        return 0.5 * jnp.log(jnp.sum(P**2))

    def stiffness(self, params: Float[np.ndarray, "cell parameter"]):
        """(logarithm of the stress under the mean deformation of the sheet (cell,), its derivative)."""
        value, derivative = self._stiffness(params)
        return np.asarray(value), np.asarray(derivative)

    def states(self, params: Float[np.ndarray, "cell parameter"], guesses, factors=None) -> list[State] | None:
        """Equilibrium of every load step, or None where Newton's method fails for one.

        Args:
            guesses: displacement of every step to begin from.
            factors: factors of the free tangents of states near by.
        """
        self.solver.set_parameters({"params": params})
        found = []
        for guess, fixed, free, factor in zip(
            guesses, self.fixed, self.free, factors or [None] * len(guesses), strict=True
        ):
            reached = self.solver.newton(guess, fixed, NEWTON_TOLERANCE, factor)
            if reached.u is None:
                return None
            found.append(State(reached.u, reached.force, free))
        return found

    def inherited(self, params: Float[np.ndarray, "cell parameter"], u: list[np.ndarray]):
        """(parameters, displacements of every step) of the measured cells, on the mesh of their parts."""
        inherited = np.empty((len(self.mesh.cells), params.shape[1]))
        inherited[self.refinement.subcells] = params[:, None]
        return inherited, [self.refinement.interpolation @ each for each in u]

    def extension(self, params) -> list[np.ndarray]:
        """First guesses: the held displacements continued into the sheet by linear elasticity."""
        self.solver.set_parameters({"params": params})
        _, K = self.solver.tangent(np.zeros_like(self.mesh.nodes))
        guesses = []
        for mask, values, free in zip(self.masks, self.values, self.free, strict=True):
            u = np.where(mask, values, 0.0).ravel()
            u[free] = -factorise(K[free][:, free]).solve((K @ u)[free])
            guesses.append(u.reshape(-1, 2))
        return guesses

    def residuals(self, states: list[State]) -> tuple[list[np.ndarray], np.ndarray]:
        """(misfit of the seen displacement of the free nodes by step, misfit of forces over their uncertainty)."""
        each = zip(self.observe, states, self.u, self.seen, strict=True)
        u = [W @ state.u.ravel() - data.ravel()[seen] for W, state, data, seen in each]
        f = [(f.direction @ states[f.step].force - f.value) / f.sigma for f in self.forces]
        return u, np.array(f)

    def linearise(self, params, states: list[State], sigma: float) -> Jacobian:
        """Derivative of the residuals by the parameters, where displacements have the uncertainty ``sigma``."""
        shape = (self.mesh.nodes.size, params.size)
        self.solver.set_parameters({"params": params})
        steps = []
        for number, state in enumerate(states):
            K = self.solver.tangent(state.u)[1]
            cellwise = self._sensitivity(jnp.asarray(state.u)[self.mesh.cells], params, self._gradients, self._weights)
            B = scipy.sparse.csr_matrix((np.asarray(cellwise).ravel(), (self._rows, self._columns)), shape)
            forces = [(force.direction, force.sigma) for force in self.forces if force.step == number]
            steps.append(StepJacobian(K, B, state.free, self.observe[number] / sigma, forces, self.edge_errors[number]))
        return Jacobian(steps, [force.step for force in self.forces], sigma, self._shares)
