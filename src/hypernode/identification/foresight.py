"""What changed contours of phases would gain, before their sensitivities are computed."""

import dataclasses

import numpy as np
from jaxtyping import Int

from hypernode.identification.estimate import Estimate
from hypernode.identification.few_materials import MaterialEquations


class Foresight:
    """What other labels would gain, foreseen without sensitivities of their own.

    The misfit is computed anew, with the covariance that the field has without them; by how much materials that follow
    lower it is known from their curvature there.
    """

    def __init__(self, found: Estimate):
        self._found = found
        self._equations = MaterialEquations(found.linear.curvature, found.phases, found.objective.ridge)

    def gain(self, labels: Int[np.ndarray, " cell"]) -> float:
        """By how much the cost falls; minus infinity where there is no equilibrium within reach."""
        found, objective, problem = self._found, self._found.objective, self._found.problem
        phases = dataclasses.replace(found.phases, labels=labels)
        states = problem.equilibrium.states(phases.params, [state.u for state in found.states])
        if states is None:
            return -np.inf
        residuals = objective.residuals(states, found.linear.sigma, found.linear)
        pull = found.linear.adjoint(np.concatenate(residuals))
        pull += objective.ridge * (phases.params.ravel() - objective.centre)
        gradient = phases.columns.T @ pull
        followed = 0.5 * gradient @ np.linalg.solve(self._equations.matrix, gradient)
        return found.cost - objective.value(phases.params, states, problem.sigma, found.linear) + float(followed)
