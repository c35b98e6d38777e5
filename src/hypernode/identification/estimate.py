"""The result of a descent: a material field, its misfits, and how the descent ended."""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from hypernode.identification import thresholds
from hypernode.identification.objective import NormalEquations, Objective, Step
from hypernode.identification.problem import FieldProblem
from hypernode.identification.score import score_of
from hypernode.identification.sensitivities import Jacobian
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.trace import Score, Trace, Trial
from hypernode.verdict import Ending


@dataclasses.dataclass(frozen=True, kw_only=True)
class Estimate:
    """Where a descent ended.

    Attributes:
        objective: what was minimised.
        linear: sensitivities at the last linearisation, with the covariance of the residuals.
        params: parameters (cell, parameter).
        states: equilibrium of every load step.
        history: displacement misfit in units of its noise after every step, that of the start first.
        cost: the whole objective, the negative logarithm of the posterior density.
        ending: how the descent ended.
        step: the last Gauss-Newton step that was tried, or None where none was.
        trial: the record of this candidate, None until it is complete.
        trace: all candidates tried before.
    """

    objective: Objective
    linear: Jacobian | None
    params: np.ndarray
    states: list
    history: np.ndarray
    cost: float
    ending: Ending
    step: Step | None
    trial: Trial | None = None
    trace: Trace = dataclasses.field(default_factory=Trace)

    @property
    def problem(self) -> FieldProblem:
        """The test, and the equilibrium that ties a field to it."""
        return self.objective.problem

    @property
    def basis(self) -> ConvexBasis:
        """The law whose parameters the cells have."""
        return self.problem.basis

    @property
    def material_count(self) -> int:
        """Number of materials of the field; 0 if every cell has its own."""
        return 0

    @property
    def gradual(self) -> bool:
        """Whether the stiffness of one material changes gradually."""
        return False

    @property
    def layered(self) -> bool:
        """Whether cells that an interface cuts are layers of two materials."""
        return False

    @property
    def by_parts(self) -> Float[np.ndarray, "parameter part cell"]:
        """Parameters of the parts of every measured cell, row by row. The stress of the cell is the mean over its
        parts."""
        return self.params.T[:, self.problem.refinement.subcells.T]

    def samples(self, count: int, seed: int) -> Float[np.ndarray, "parameter posterior_sample part cell"]:
        """:attr:`by_parts` of posterior samples."""
        deflation = self.step and self.step.deflation
        samples = self.objective.posterior_samples(self.linear, self.params, count, seed, deflation)
        samples = self.params + self.understated * (samples - self.params)
        return np.moveaxis(samples, -1, 0)[..., self.problem.refinement.subcells.T]

    @property
    def understated(self) -> float:
        """Factor by which all uncertainties are enlarged if forces are missed by more than chance.
        The source of the excess is unknown: a wrong law misses forces and stresses alike. The factor is Birge's (The
        calculation of errors by the method of least squares, 1932).
        """
        forces, number = self.misfits["force"], max(len(self.problem.forces), 1)
        # The mean square of so many is known to the root of two over their number.
        return forces if forces > 1.0 + 2.0 / np.sqrt(2.0 * number) else 1.0

    @property
    def misfits(self) -> dict[str, float]:
        """Root mean square misfits by name: of displacements over their scatter, of forces over their uncertainty.

        If points or steps share errors, a descent uses larger errors of the displacements. Its history refers to these.
        """
        displacement = float(self.history[-1]) / self.problem.observations.scatter
        return {"displacement": displacement, "force": self.objective.force_misfit(self.states, self.linear)}

    @property
    def summary(self) -> str:
        """Misfits, gradient norm and residual of the conjugate gradients in words."""
        numbers = [f"{key} misfit {value:.3g}" for key, value in self.misfits.items()]
        if self.step is not None:
            numbers += [f"gradient norm {self.step.gradient_norm:.3g}", f"CG residual {self.step.cg_residual:.2g}"]
        return ", ".join(numbers)

    @property
    def unexplained(self) -> float:
        """The larger of the two weighted misfits over its limit; above one the test is not explained."""
        forces = self.misfits["force"]
        # Forces across the pull are nearly zero, and uncertain by any share of themselves.
        relative = [force.sigma / abs(force.value) for force in self.problem.forces if force.value]
        share = thresholds.FORCES_DESCRIBED if self.problem.observations.own_grid else thresholds.LAWS_DESCRIBED
        described = share / min(relative) if relative else 0.0
        limit = max(thresholds.FORCES_UNEXPLAINED, described)
        return max(float(self.history[-1]) / thresholds.UNEXPLAINED, forces / limit)

    @functools.cached_property
    def effective_parameters(self) -> float:
        """Number of parameters of the field that noisy displacements determine; 0 without noise."""
        if self.linear is None or not self.problem.noisy:
            return 0.0
        return self.objective.effective_parameters(self.linear, self.params, self.step and self.step.deflation)

    def answers(self, curvature: Callable) -> NormalEquations:
        """Solver for the linear response of the cells.

        Args:
            curvature: x -> J^T J x of the data that hold them.
        """
        return self.objective.precision(curvature, self.params, self.step and self.step.deflation)

    @property
    def information_criterion(self) -> float:
        """The total of :attr:`score`."""
        return self.score.total

    @functools.cached_property
    def score(self) -> Score:
        """:func:`~hypernode.identification.score.score_of`, once for all that have one record."""
        if self.trial is not None and self.ending is not Ending.UNFINISHED:
            return self.trial.score
        return score_of(
            self.problem,
            white=self.objective.residuals(self.states, self.problem.sigma, self.linear),
            cost=self.cost,
            shared=0.0 if self.linear is None else self.linear.log_determinant,
            terms=len(self.basis.names),
            determined=self.effective_parameters,
            places=self.places,
        )

    @property
    def places(self) -> float:
        """Logarithm of the number of possible interfaces; 0 for free cells."""
        return 0.0

    def recorded(self, move: str, start: "Estimate | None" = None) -> "Estimate":
        """The same as a candidate of the search.

        Args:
            move: what was tried, in words.
            start: the estimate that it began from, or None for the homogeneous sheet.
        """
        trial = Trial(
            move=move,
            start=None if start is None else start.trial,
            terms=tuple(self.basis.terms),
            materials=self.material_count,
            misfits=self.misfits,
            score=self.score,
            ending=str(self.ending),
        )
        before = Trace() if start is None else start.trace
        return dataclasses.replace(self, trial=trial, trace=(before | self.trace).with_trial(trial))

    def instead_of(self, *others: "Estimate", because: str) -> "Estimate":
        """This estimate, with the trace of other estimates and the reasons against them."""
        trace = functools.reduce(Trace.__or__, [*(each.trace for each in others), self.trace])
        return dataclasses.replace(self, trace=trace.passed_over({each.trial: because for each in others}))

    @property
    def data_share(self) -> float:
        """Part of the cost due to misfits, the most that further terms could remove."""
        return self.objective.misfits(self.states, self.problem.sigma, self.linear) / self.cost

    @property
    def excess(self) -> float:
        """Excess of the residual of noisy displacements over their noise, in standard deviations.

        The standard deviation combines the sampling error of the root mean square with the uncertainty of the noise
        level.
        """
        if not self.problem.noisy:
            return 0.0
        by_chance = 0.5 / np.sqrt(self.problem.cost_of_noise)
        return float(self.history[-1] - 1.0) / float(np.hypot(by_chance, self.problem.observations.noise_uncertainty))

    @property
    def overfitted(self) -> bool:
        """Whether the residual of noisy displacements is smaller than noise allows, so noise was fitted."""
        return bool(self.excess < -thresholds.NEVER_SO_LITTLE)

    @property
    def underfitted(self) -> bool:
        """Whether the misfit is too large for any field of these terms to explain the test."""
        much = self.excess > thresholds.BY_CHANCE if self.problem.noisy else self.data_share > thresholds.MUCH_LEFT
        return bool(self.unexplained > 1.0 or much)

    def without_sensitivities(self) -> "Estimate":
        """This estimate without its sensitivities, which take most of its memory."""
        return dataclasses.replace(self, linear=None, step=None)

    def after(self, *earlier: "Estimate") -> "Estimate":
        """This estimate with the history of the preceding descents before its own."""
        return dataclasses.replace(self, history=np.concatenate([*(each.history for each in earlier), self.history]))
