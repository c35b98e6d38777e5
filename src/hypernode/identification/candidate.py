"""A field of materials and lines that was tried, and what it scores."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2, norm

from hypernode.identification import thresholds
from hypernode.identification.errors import EdgeAnswers
from hypernode.identification.interface_fit import Fit
from hypernode.identification.problem import FieldProblem
from hypernode.trace import Score, Trial


@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """A fit and its place in the search.

    Attributes:
        move: what was tried.
        start: what it began from, None for the homogeneous sheet.
        problem: with which law, on which finite elements.
        fit: where the descent ended.
        u: displacement of every load step in equilibrium or near it.
    """

    move: str
    start: "Candidate | None"
    problem: FieldProblem
    fit: Fit
    u: Mapping[int, Float[np.ndarray, "node 2"]]

    @property
    def history(self) -> list[float]:
        """Misfit of the displacements before each step of the descent, over the noise assumed at that step."""
        return ([] if self.start is None else self.start.history) + self.fit.history

    @property
    def terms(self) -> tuple[str, ...]:
        """Terms of the law."""
        return tuple(self.problem.basis.terms)

    @property
    def subcells(self) -> int:
        """Rows and columns into which a cell of the grid is divided."""
        return round(np.sqrt(self.problem.refinement.subcells.shape[1]))

    def edges(self, problem: FieldProblem, steps: list[int]) -> Sequence[EdgeAnswers] | None:
        """Approximate response of these steps to errors of held edges of the same certainty; None if unknown.

        The window and the law change what they answer by little.
        """
        own, other = (each.observations.boundaries for each in (self.problem, problem))
        known = self.fit.steps == steps and self.problem.sigma == problem.sigma
        alike = known and all(
            own[k].errors.shape[1] == other[k].errors.shape[1]
            and np.array_equal(own[k].observed, other[k].observed)
            and np.array_equal(own[k].relative, other[k].relative)
            for k in steps
        )
        return self.fit.edges if alike else None

    @property
    def missed(self) -> float:
        """Misfit of the displacements over its expected value."""
        return self.fit.misfit / self.problem.observations.scatter

    @property
    def sigma_left(self) -> float:
        """Uncertainty of displacements as if their errors were independent, with their residual as the noise."""
        left = self.fit.left
        return self.problem.sigma * max(left.level * float(np.sqrt(left.inflation)), 1.0)

    @property
    def leaves_more_than_noise(self) -> bool:
        """Whether the residual of displacements is larger than noise makes it by chance."""
        known = self.problem.observations.noise_uncertainty
        return bool(self.level > 1.0 + thresholds.BY_CHANCE * max(known, (2.0 * self.fit.left.independent) ** -0.5))

    @property
    def misses_forces(self) -> bool:
        """Whether forces are missed by more than their errors make it by chance."""
        count = sum(force.step in self.fit.steps for force in self.problem.forces)
        return bool(self.fit.force_squared > chi2.isf(norm.sf(thresholds.BY_CHANCE), max(count, 1)))

    @property
    def leaves_mostly_no_noise(self) -> bool:
        """Whether most of the residual of displacements is no noise."""
        return bool(self.level > thresholds.MOSTLY_NO_NOISE)

    def halves(self, other: "Candidate") -> bool:
        """Whether its squared residual is less than half of that of another candidate, most of which was no noise."""
        return bool(other.leaves_mostly_no_noise and self.fit.misfit**2 < 0.5 * other.fit.misfit**2)

    @property
    def leaves_nothing(self) -> bool:
        """Whether residuals of displacements are as small as those of equilibrium, and those of forces are chance."""
        return bool(self.fit.misfit <= self.problem.solver_error and self.fit.forces <= 1.0)

    @property
    def misses_deformation(self) -> bool:
        """Whether its residual is larger than noise, and the same in all steps."""
        return self.leaves_more_than_noise and self.fit.left.alike

    @property
    def level(self) -> float:
        """Residual of displacements over their assumed noise."""
        return self.fit.left.level / self.problem.observations.scatter

    def gain_over(self, other: "Candidate") -> float:
        """Gain in score over another candidate; positive is better.

        Residuals are worth as many independent numbers as those of the one that leaves less: they are the nearer to
        noise. What a law, a line or a trend leaves is the same in all neighbours, and would count as a few numbers.
        """
        independent = min(self.fit, other.fit, key=lambda fit: fit.misfit).left.independent
        return other.score(independent).total - self.score(independent).total

    def score(self, independent: float) -> Score:
        """Negative logarithm of the posterior probability, with the noise taken from the residual.

        Args:
            independent: how many independent numbers the residuals of displacements are worth.
        """
        fit = self.fit
        return Score(
            displacements=independent * float(np.log(np.hypot(fit.misfit, self.problem.solver_error))),
            # What leaves more than noise of displacements describes forces no better.
            forces=0.5 * fit.force_squared / max(self.level, 1.0) ** 2,
            prior=fit.prior,
            noise=0.0,
            terms=0.5 * len(self.problem.basis.names) * float(np.log(max(independent, 2.0))),
            determined=fit.determined,
            places=fit.field.places,
        )

    def trial(self, start: Trial | None, independent: float, promises: Mapping[str, float]) -> Trial:
        """Its record: :meth:`score`, and the gain that each further term promised."""
        misfits = {"displacement": self.missed, "force": self.fit.forces}
        score, ending = self.score(independent), str(self.fit.ending)
        return Trial(
            move=self.move,
            start=start,
            terms=self.terms,
            materials=self.fit.field.count,
            misfits=misfits,
            score=score,
            ending=ending,
            promises=promises,
        )
