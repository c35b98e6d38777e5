"""What changed contours of phases would gain, before their sensitivities are computed."""

import dataclasses
import functools

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

    @functools.cached_property
    def _equations(self) -> MaterialEquations:
        return MaterialEquations(self._found.linear.curvature, self._found.phases, self._found.objective.ridge)

    def gain(self, labels: Int[np.ndarray, " cell"]) -> float:
        """By how much the cost falls; minus infinity where there is no equilibrium within reach."""
        found, objective = self._found, self._found.objective
        phases = dataclasses.replace(found.phases, labels=labels)
        moved = found.at(phases.params)
        if moved is None:
            return -np.inf
        pull = objective.misfit_gradient(moved.states, found.linear)
        pull += objective.ridge * (moved.params.ravel() - objective.centre)
        gradient = phases.columns.T @ pull
        return found.cost - moved.cost + 0.5 * float(gradient @ np.linalg.solve(self._equations.matrix, gradient))
