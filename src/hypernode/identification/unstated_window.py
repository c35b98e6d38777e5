"""How wide the window of an engine of image correlation is that nobody stated, as a sheet of two materials tells it.

A field of mixtures explains what a window blurs by materials that are not there. Two materials and a line between them
cannot: what they miss beside the line says how wide the window is.
"""

import copy
from dataclasses import replace

import numpy as np
import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.believed_window import BelievedWindow
from hypernode.data.measurement import correlation_window, window_uncertainty
from hypernode.identification.estimate import Estimate
from hypernode.identification.layered_descent import LayeredDescent
from hypernode.identification.layered_estimate import LayeredEstimate
from hypernode.identification.objective import white_residuals
from hypernode.identification.observations import Observations, observe, seen_points
from hypernode.identification.problem import FieldProblem
from hypernode.progress import say
from hypernode.verdict import Ending


def unstated_window(
    found: Estimate, measurement: xr.Dataset, settings: Constrained, name: str
) -> BelievedWindow | None:
    """The window through which two materials and a line explain a test of which none is stated.

    None where it is stated, where points are exact by what the measurement says of itself, where two materials explain
    the test without one, and where behind one they do not. Whether they are likelier than mixtures behind the same
    window, an identification with it tells: criteria of fields that weigh points otherwise do not compare.

    Args:
        found: the field without a window.
        measurement: of which it is.
    """
    observations = found.problem.observations
    may_be = found.problem.noisy and observations.by_points and not found.problem.divided
    unstated = observations.window == 0.0 and window_uncertainty(measurement) > 0.0
    if not (settings.layers and may_be and unstated) or (found.layered and not found.ambiguous):
        return None
    free = found.free if found.layered else found
    descent = DescentOfWindow(free, measurement, name)
    reached = descent.end()
    certain = found.problem.strategy.window_certain * descent.window.error
    if reached is None or reached.underfitted or descent.window.side < certain:
        return None
    say("constrained", name, f"no window is stated; again as seen through one of {descent.said}")
    return descent.window


class DescentOfWindow:
    """Rounds of two materials and a line, with a step of the window's side after each descent.

    Attributes:
        window: where it ended.
        step: mean distance of points.
    """

    def __init__(self, free: Estimate, measurement: xr.Dataset, name: str):
        self._free, self._measurement, self._name = free, measurement, name
        grid, self._strategy = free.problem.observations.grid, free.problem.strategy
        self.step = float(np.sqrt(grid.areas.mean()))
        self._longest = self._strategy.window_longest * float(min(np.ptp(line) for line in grid.lines))
        self.window = BelievedWindow(self._strategy.window_start * self.step, np.inf)

    @property
    def said(self) -> str:
        """The window in words."""
        return f"{self.window.side:.3g} +- {self.window.error:.1g}, {self.window.side / self.step:.2g} points"

    def end(self) -> LayeredEstimate | None:
        """The field at the last side that was tried; None where two materials lead nowhere, or no window is left."""
        best = None
        for _ in range(self._strategy.window_rounds):
            side = self.window.side
            if side < self._strategy.window_seen * self.step:
                return None
            free = self._through(side)
            if best is None:
                descent = LayeredDescent.of_halves(free, self._name)
            else:
                descent = LayeredDescent.along(best.distance, free, self._name)
            reached = descent and descent.end()
            if reached is None or (reached.underfitted and reached.ending is Ending.STAGNATED):
                return None
            best = reached
            change, error = self._newton(best)
            self.window = BelievedWindow(self._bounded(side, change), error)
            say("constrained", self._name, f"window {self.said}")
            if abs(self.window.side - side) < max(error, self._strategy.window_settled * side):
                break
        return best

    def _bounded(self, side: float, change: float) -> float:
        """The side after a step, which is trusted to half of it."""
        return float(np.clip(side + np.clip(change, -0.5 * side, 0.5 * side), 0.0, self._longest))

    def _through(self, side: float) -> Estimate:
        """The free field as it is seen through a window."""
        seen = observe(self._measurement.assign_attrs(correlation_window=side), 1, self._strategy)
        return replace(self._free, objective=replace(self._free.objective, problem=_observed(self._free.problem, seen)))

    def _newton(self, reached: LayeredEstimate) -> tuple[float, float]:
        """(Gauss-Newton step of the side, to which materials and line answer; its standard deviation)."""
        linear, problem = reached.linear, reached.problem
        residual = np.concatenate(white_residuals(problem, reached.states, problem.sigma, linear))
        column = linear.whiten(self._derivative(reached))
        J = linear.product(reached.columns.toarray())
        answers = np.linalg.solve(J.T @ J + reached.held.toarray(), J.T @ column)
        curvature = float(column @ column - (J.T @ column) @ answers)
        return -float(column @ residual) / curvature, curvature**-0.5

    def _derivative(self, reached: LayeredEstimate) -> np.ndarray:
        """Derivative of all residuals by the side, by a central difference; weights stay."""
        observations, apart = reached.problem.observations, self._strategy.window_difference * self.step
        _, kernel = correlation_window(self._measurement)
        wider, narrower = (
            seen_points(observations.refinement, observations.window + sign * apart, kernel) for sign in (1.0, -1.0)
        )
        by_side = (wider - narrower) / (2.0 * apart * reached.problem.sigma)
        each = zip(observations.boundaries, reached.states, strict=True)
        seen = [(by_side @ state.u.ravel())[step.observed] / step.relative for step, state in each]
        return np.concatenate([*seen, np.zeros(len(reached.problem.forces))])


def _observed(problem: FieldProblem, observations: Observations) -> FieldProblem:
    """The same sheet, and its compiled functions, seen otherwise."""
    other = copy.copy(problem)
    other.observations, other.equilibrium = observations, problem.equilibrium.under_boundaries(observations.boundaries)
    return other
