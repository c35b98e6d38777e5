"""Load steps that a polished network does not see, and whether it explains them better than the network before."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from hypernode.identification.objective import white_residuals
from hypernode.identification.problem import FieldProblem
from hypernode.identification.sensitivities import Jacobian

#: Standard deviations beyond which chance makes neither a misfit nor the difference of two costs.
BEYOND_CHANCE = 2.0


def held_out_steps(load_case: Int[np.ndarray, " step"]) -> Bool[np.ndarray, " step"]:
    """Every second step of each load case, counted back from the one before its last; none of a single step.

    The largest load is always used: it says most of the law, and to go beyond what is used would be another question.
    """
    held = np.zeros(len(load_case), bool)
    for case in np.unique(load_case):
        held[np.flatnonzero(load_case == case)[-2::-2]] = True
    return held


class Misfit(NamedTuple):
    """Residuals of some load steps over their uncertainties, free of errors that they share.

    Attributes:
        displacement, force: residuals.
    """

    displacement: Float[np.ndarray, " residual"]
    force: Float[np.ndarray, " residual"]

    @classmethod
    def of(cls, problem: FieldProblem, states, linear: Jacobian) -> "Misfit":
        """That of states of a problem, whitened as where it is linearised."""
        return cls(*white_residuals(problem, states, problem.sigma, linear))

    @property
    def sizes(self) -> dict[str, float]:
        """Root mean squares by name: one by chance, where the uncertainties are noise; zero where there is none."""
        each = zip(self._fields, self, strict=True)
        return {name: float(np.sqrt(np.mean(r**2))) if len(r) else 0.0 for name, r in each}

    @property
    def cost(self) -> float:
        """Minus the logarithm of their probability, but for a constant."""
        return 0.5 * sum(float(r @ r) for r in self)

    @property
    def explained(self) -> bool:
        """Whether each root mean square is one, or more by no more than chance makes of it."""
        each = zip(self.sizes.values(), self, strict=True)
        return all(size <= 1.0 + BEYOND_CHANCE / math.sqrt(2.0 * len(r)) for size, r in each if len(r))


def why_not_better(before: Misfit, after: Misfit) -> str:
    """Why one does not explain held-out steps better than another did; empty where it does.

    It must be the likelier one by more than noise makes of the difference, whose standard deviation is the distance of
    the two predictions. Neither displacements nor forces may be missed by more than before, beyond noise.
    """
    distance = math.sqrt(sum(float(np.sum((a - b) ** 2)) for a, b in zip(before, after, strict=True)))
    for name, size in after.sizes.items():
        if size > max(before.sizes[name], 1.0):
            return f"held-out {name}s are missed by more, {size:.3g} and not {before.sizes[name]:.3g} of their noise"
    if before.cost - after.cost <= BEYOND_CHANCE * distance:
        return "held-out steps are not explained better by more than chance"
    return ""
