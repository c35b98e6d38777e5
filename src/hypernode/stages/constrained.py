"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

Displacements are data here, not input. The unknown is a field of convex-basis coefficients, one set a
cell; for every guess JAX-FEM solves the equilibrium of each load step, and the misfit of displacements
and edge forces, in units of their noise, is reduced together with the jumps of the field by
Gauss-Newton steps. Nothing measured is ever differentiated, so noise hardly matters.
"""

import dataclasses
import json

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from hypernode.config import Constrained
from hypernode.errors import ExpectedError
from hypernode.mechanics.mesh import Mesh
from hypernode.progress import Progress
from hypernode.stages.equilibrium_solver import factorise
from hypernode.stages.field_problem import FieldProblem
from hypernode.storage.netcdf import read, units_of, write

#: Jumps of the parameters below this size are smoothed rather than counted.
SMALLEST_JUMP = 0.02
#: What a jump of each parameter counts, against one of the logarithm of the stiffness.
JUMP_SHARE = {"log_level": 1.0, "logit_dispersion": 0.3, "fibre_x": 4.0, "fibre_y": 4.0}
DEFAULT_JUMP_SHARE = 0.5
#: Weight of the squared distance from the homogeneous fit, small: it decides only what data leave open.
RIDGE = 0.02
#: Iterations with total variation before jumps above ``jump_scale`` stop costing more.
CONVEX_ITERATIONS = 5
#: Largest change of a parameter in one step.
LARGEST_STEP = 2.0
#: Damping beyond which no descent is left to find.
LARGEST_DAMPING = 1e6
#: A displacement misfit this close to its noise counts as explained.
CLOSE = 1.05
#: Conjugate-gradient iterations of a step, before and after jumps stop costing more.
LINEAR_ITERATIONS = (60, 100)


class IdentificationError(ExpectedError, RuntimeError):
    """No material field could be found; the message says at which iteration and why."""


class Jumps:
    """How much the parameter field varies from cell to cell, all parameters jointly.

    Total variation first: sum over shared sides of length x |jump|. Later a logarithm of it,
    ``scale`` log(1 + |jump| / scale), which no longer shrinks true jumps.
    """

    def __init__(self, mesh: Mesh, names):
        pairs, length, _ = mesh.neighbours()
        n = len(pairs)
        self.difference = scipy.sparse.csr_matrix(
            (np.repeat([1.0, -1.0], n), (np.tile(np.arange(n), 2), pairs.T.ravel())), (n, len(mesh.cells))
        )
        self.length = length / np.sqrt(mesh.areas.mean())
        self.share = np.array([JUMP_SHARE.get(name, DEFAULT_JUMP_SHARE) for name in names])
        self.scale = None

    def _size(self, params):
        return np.sqrt(((self.difference @ (params * self.share)) ** 2).sum(axis=1) + SMALLEST_JUMP**2)

    def value(self, params) -> float:
        """The penalty."""
        size = self._size(params)
        return float(self.length @ (size if self.scale is None else self.scale * np.log1p(size / self.scale)))

    def hessian(self, params) -> scipy.sparse.csc_matrix:
        """Quadratic form that touches the penalty from above, on the flattened parameters."""
        size = self._size(params)
        weight = self.length / size / (1.0 if self.scale is None else 1.0 + size / self.scale)
        laplacian = self.difference.T @ scipy.sparse.diags(weight) @ self.difference
        return scipy.sparse.kron(laplacian, scipy.sparse.diags(self.share**2)).tocsc()


@dataclasses.dataclass
class Objective:
    """What is minimised: misfits in units of their uncertainty, jumps of the field, a small ridge."""

    problem: FieldProblem
    jumps: Jumps
    jump_weight: float
    ridge: np.ndarray
    centre: np.ndarray

    def misfit(self, states) -> float:
        """Root mean square of the displacement misfit."""
        u, _ = self.problem.residuals(states)
        return float(np.sqrt(sum(r @ r for r in u) / sum(len(r) for r in u)))

    def value(self, params, states, sigma: float) -> float:
        """The objective with displacements weighted by ``sigma``."""
        u, f = self.problem.residuals(states)
        regular = self.jump_weight * self.jumps.value(params)
        regular += 0.5 * self.ridge @ (params.ravel() - self.centre) ** 2
        return 0.5 * (sum(r @ r for r in u) / sigma**2 + f @ f) + regular

    def gauss_newton(self, params, states, sigma: float, damping: float):
        """(linearisation, step) of a damped Gauss-Newton iteration, by preconditioned conjugate gradients."""
        linear = self.problem.linearise(params, states, sigma)
        u, f = self.problem.residuals(states)
        regular = self.jump_weight * self.jumps.hessian(params) + scipy.sparse.diags(self.ridge + damping)
        gradient = linear.adjoint([r / sigma for r in u], f)
        gradient += (regular - damping * scipy.sparse.identity(params.size)) @ params.ravel() - self.ridge * self.centre
        precondition = factorise(regular)
        size = (params.size, params.size)
        operator = scipy.sparse.linalg.LinearOperator(size, lambda x: linear.adjoint(*linear.forward(x)) + regular @ x)
        step, _ = scipy.sparse.linalg.cg(
            operator,
            -gradient,
            rtol=0.02,
            maxiter=LINEAR_ITERATIONS[self.jumps.scale is not None],
            M=scipy.sparse.linalg.LinearOperator(size, precondition.solve),
        )
        return linear, step


def identify(problem: FieldProblem, settings: Constrained, name: str):
    """The parameter field and its equilibrium states.

    Displacements are weighted by the larger of their noise and their present misfit, so that early
    iterations, far from the solution, are not ruled by the last digit.

    Returns:
        (params (cell, parameter), states, history of the misfit in units of the noise).

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    cells, count = len(problem.mesh.cells), len(problem.basis.names)
    params = np.tile(problem.homogeneous, (cells, 1))
    states = problem.states(params, problem.extension(params))
    if states is None:
        raise IdentificationError(
            f"constrained field of {name}: no equilibrium for the homogeneous material; are the held edges "
            "smooth, and is every load step one state of the same test?"
        )
    ridge = np.tile(np.where(np.arange(count) == 0, 0.0, RIDGE**2), cells)
    jumps = Jumps(problem.mesh, problem.basis.names)
    objective = Objective(problem, jumps, settings.jump_weight, ridge, params.ravel().copy())
    progress = Progress("constrained field", name, settings.iterations)
    damping, history = 1.0, [objective.misfit(states) / problem.sigma]
    for iteration in range(settings.iterations):
        sigma = problem.sigma * max(1.0, history[-1])
        before = objective.value(params, states, sigma)
        linear, step = objective.gauss_newton(params, states, sigma, damping)
        found = _line_search(objective, params, states, sigma, linear, step, before)
        if found is None:
            if damping > LARGEST_DAMPING:
                break
            damping = max(100.0 * damping, 1.0)
            progress.advance(misfit=history[-1], cost=before)
            continue
        params, states, after, fraction = found
        damping = max(damping / 4, 1e-4) if fraction >= 0.99 else 4 * damping if fraction < 0.5 else damping
        history.append(objective.misfit(states) / problem.sigma)
        progress.advance(misfit=history[-1], cost=after)
        close = history[-1] <= CLOSE
        if jumps.scale is None and (close or iteration + 1 >= CONVEX_ITERATIONS):
            jumps.scale = settings.jump_scale
        elif close and (before - after) / before < settings.tolerance:
            break
    return params, states, np.array(history)


def _line_search(objective, params, states, sigma, linear, change, before):
    """The longest of a few fractions of ``change`` that lowers the cost, or None."""
    du = linear.displacement(change)
    fraction = min(1.0, LARGEST_STEP / max(np.abs(change).max(), 1e-300))
    for _ in range(6):
        trial = params + fraction * change.reshape(params.shape)
        guesses = []
        for state, d in zip(states, du, strict=True):
            guess = state.u.ravel().copy()
            guess[state.free] += fraction * d
            guesses.append(guess.reshape(-1, 2))
        reached = objective.problem.states(trial, guesses)
        if reached is not None:
            after = objective.value(trial, reached, sigma)
            if after < before:
                return trial, reached, after, fraction
        fraction *= 0.4
    return None


def run(settings: Constrained, name: str, measurement_file: str, output: str, attributes: dict) -> None:
    """Identify the field of basis coefficients and write its equilibrium states.

    Args:
        settings: the method's ``constrained`` section.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    measurement = read(measurement_file)
    problem = FieldProblem(measurement, settings)
    params, states, history = identify(problem, settings, name)
    u = np.stack([state.u for state in states])
    _, forces = problem.residuals(states)
    variables = {key: measurement[key].values for key in ("X", "cells", "corners", "test", "stretch")}
    variables |= {"u": u, "loss": history, "loss_iteration": np.arange(len(history))}
    variables |= {f"basis.{key}": (("cell",), params[:, index]) for index, key in enumerate(problem.basis.names)}
    if "F_truth" in measurement:
        variables["F_truth"] = measurement["F_truth"].values
    write(
        output,
        variables,
        f"equilibrium field of {name}",
        {
            **attributes,
            "units": units_of(measurement),
            "material_kind": "convex_basis",
            "basis": json.dumps(dataclasses.asdict(problem.basis)),
            "displacement_sigma": problem.sigma,
            "displacement_misfit": float(history[-1]),
            "force_misfit": float(np.sqrt(np.mean(forces**2))) if len(forces) else 0.0,
            "homogeneous_force_misfit": problem.force_misfit,
        },
        parents=[measurement_file],
    )
