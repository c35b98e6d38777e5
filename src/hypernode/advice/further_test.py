"""Further tests of an identified sheet, ranked by how much each would narrow what is left open of its stress."""

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.advice.candidates import Candidate
from hypernode.advice.simulation import recorded
from hypernode.advice.stress_spread import StressSpread
from hypernode.config.methods import Constrained
from hypernode.errors import ExpectedError
from hypernode.fem.solver import ConvergenceError
from hypernode.identification.gauss_newton import objective_at_end
from hypernode.identification.problem import FieldProblem, problem_of_basis
from hypernode.identification.sensitivities import Jacobian
from hypernode.progress import Progress

#: Reduction of the spread below which a test is not worth doing: errors of the spread itself are as large.
WORTH = 0.05
#: Standard errors by which two tests must differ to be told apart.
TOLD_APART = 2.0
#: Random vectors by which spreads are estimated: with them the comparison of two tests is known to a few per cent.
PROBES = 8


class AdviceError(ExpectedError, ValueError):
    """No further test can be advised; the message says why, and what would help."""


@dataclass(frozen=True)
class FurtherTest:
    """What one more test would leave open.

    Attributes:
        name: of the test.
        spread: relative posterior deviation of the stress after it; NaN where it was refused.
        reduction: by how much less that is, relative to before.
        uncertainty: standard error of the reduction.
        refused: why there is no number, or "".
    """

    name: str
    spread: float
    reduction: float
    uncertainty: float
    _: KW_ONLY
    refused: str = ""

    @property
    def done(self) -> bool:
        """Whether there is a number."""
        return not self.refused


@dataclass(frozen=True)
class Advice:
    """The further tests of a sheet, the one that tells most first, those without a number last.

    Attributes:
        before: relative posterior deviation of the stress by the present test.
        stress: root mean square size of the stress that both are relative to.
        tests: ranked.
    """

    before: float
    stress: float
    tests: tuple[FurtherTest, ...]

    @property
    def sentence(self) -> str:
        """Which test is worth doing next, and which cannot be told from it."""
        done = [test for test in self.tests if test.done]
        if not done:
            return "No further test can be advised: the identified field finds no equilibrium under any of them."
        best = done[0]
        narrowed = f"the spread of the stress from {100.0 * self.before:#.3g} % to {100.0 * best.spread:#.3g} %"
        if best.reduction < WORTH:
            return f"No further test of these is worth doing: the best, {best.name}, would only narrow {narrowed}."
        beside = [
            test.name
            for test in done[1:]
            if best.reduction - test.reduction < TOLD_APART * float(np.hypot(best.uncertainty, test.uncertainty))
        ]
        alike = f" As good, as far as can be told: {', '.join(beside)}." if beside else ""
        return f"The next test worth doing is {best.name}: it would narrow {narrowed}.{alike}"


def advise(
    problem: FieldProblem,
    params: Float[np.ndarray, "subcell parameter"],
    guesses: Sequence[Float[np.ndarray, "node 2"]],
    measurement: xr.Dataset,
    settings: Constrained,
    tests: Sequence[Candidate],
    stretches: Sequence[float],
    name: str,
    count: int = PROBES,
    seed: int = 0,
) -> Advice:
    """How much each of some further tests would narrow the stress that the present test leaves open.

    Args:
        problem: the present test.
        params: the field that was identified.
        guesses: its displacements in every load step, on the mesh of the subcells.
        measurement: opened file of the present test.
        settings: with which the field was identified.
        tests: those that are compared.
        stretches: at which the stress is asked for, in every probe mode (stretch,).
        name: case, for progress and messages.
        count, seed: of the random vectors by which spreads are estimated.

    Raises:
        AdviceError: noise leaves nothing open, or the field has no equilibrium.
    """
    if problem.certain:
        raise AdviceError(
            f"{name}: the displacements are exact, so that nothing is left to chance and no test can be told from "
            "another: give the case a noise"
        )
    states = problem.equilibrium.states(params, guesses)
    if states is None:
        raise AdviceError(f"{name}: the identified field has no equilibrium near the one that is stored: run it again")
    present = problem.linearise(params, states, problem.sigma)
    spread = StressSpread(
        objective=objective_at_end(problem, settings, params),
        params=params,
        stretches=stretches,
        count=count,
        seed=seed,
    )
    progress = Progress("advise", name, 1 + len(tests))
    before = spread.variances([present.nearly_curvature])
    progress.advance(spread=_root_mean(before))
    found = []
    for test in tests:
        try:
            further = present if test.load is None else linearised(problem, params, test, measurement, settings, seed)
        except ConvergenceError as error:
            refused = f"no equilibrium: {error}"
            found.append(FurtherTest(test.name, *(3 * [float("nan")]), refused=refused))
        else:
            after = spread.variances([present.nearly_curvature, further.nearly_curvature])
            found.append(_compared(test.name, before, after))
        progress.advance(spread=found[-1].spread)
    ranked = sorted(found, key=lambda each: (not each.done, -each.reduction if each.done else 0.0))
    return Advice(_root_mean(before), spread.size, tuple(ranked))


def linearised(
    problem: FieldProblem,
    params: Float[np.ndarray, "subcell parameter"],
    test: Candidate,
    measurement: xr.Dataset,
    settings: Constrained,
    seed: int,
) -> Jacobian:
    """Sensitivities of what a further test would record to the parameters of the field, over its noise.

    Raises:
        ConvergenceError: the sheet finds no equilibrium under its load.
    """
    further = recorded(problem, params, test, measurement, seed)
    floor = None
    if not problem.noisy:
        # What finite elements miss grows with the displacement.
        size = np.abs(further["u_measured"].values).max() / np.abs(problem.observations.u).max()
        floor = problem.sigma * float(size)
    subcells = round(problem.refinement.subcells.shape[1] ** 0.5)
    other = problem_of_basis(further, settings, problem.basis, subcells, floor)
    begin = [problem.refinement.interpolation @ u for u in other.observations.u]
    states = other.equilibrium.states(params, begin)
    if states is None:
        raise ConvergenceError("its edges with the noise of the cameras find none")
    return other.linearise(params, states, other.sigma)


def _root_mean(variances) -> float:
    return float(np.sqrt(np.mean(variances)))


def _compared(name: str, before, after) -> FurtherTest:
    """What is left, with the standard error of the ratio of two means over the same random vectors."""
    ratio = np.mean(after) / np.mean(before)
    error = np.std(after - ratio * before, ddof=1) / (np.mean(before) * np.sqrt(len(before)))
    return FurtherTest(name, _root_mean(after), 1.0 - float(np.sqrt(ratio)), float(0.5 * error / np.sqrt(ratio)))
