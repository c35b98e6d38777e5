"""Cells that interfaces may cut, divided into subcells where a test without noise tells what they are."""

from hypernode.config.methods import Constrained
from hypernode.identification.estimate import Estimate
from hypernode.identification.gauss_newton import descend
from hypernode.identification.problem import field_problem
from hypernode.progress import say


def rivals(found: Estimate, tried: list[Estimate]) -> list[Estimate]:
    """Fields of other terms that explain a test as well, as far as what undivided cells miss of it allows to tell.

    Subcells miss less, and tell which terms are right. Not where a field misses displacements by so much more that what
    interfaces cut, which is alike for all terms, does not account for it.
    """
    if not found.problem.blurred:
        return []
    others = [each for each in tried if each.problem.basis.terms != found.problem.basis.terms]
    as_well = found.problem.strategy.rival_misfit * float(found.history[-1])
    return [each for each in others if each.unexplained <= 1.0 and each.history[-1] <= as_well]


def subdivided(found: Estimate, measurement, settings: Constrained, name: str) -> Estimate:
    """The field with cells divided into subcells, where interfaces lie anywhere and the data can tell where.

    A cell that an interface cuts is no material: neither does it deform as a mixture would, nor is it one. Subcells
    of it are both more nearly, and what is left of the misfit tells how much of the cell is which. It also tells how
    far finite elements describe the sheet, which depends on its contrast. Where that is better than assumed, what was
    measured is trusted more.
    """
    strategy = found.problem.strategy
    count = strategy.subcells**2 * len(found.params)
    if not found.problem.blurred or found.unexplained > 1.0:
        return found
    if count > strategy.most_subcells:
        say("constrained", name, f"cells that interfaces cut stay mixtures: {count} subcells are too many")
        return found
    terms, iterations = list(found.problem.basis.terms), min(strategy.subcells_iterations, settings.iterations)
    settings = settings.model_copy(update={"terms": terms, "iterations": iterations})
    problem = field_problem(measurement, settings, strategy.subcells, strategy)
    found = descend(problem, settings, name, found, (), settings.tolerance, "divided cells").after(found)
    misfit = float(found.history[-1])
    if problem.noisy or misfit > strategy.overestimated:
        return found
    error = max(misfit, strategy.smallest_reestimate) * problem.sigma
    problem = field_problem(measurement, settings, strategy.subcells, strategy, error)
    return descend(problem, settings, name, found, (), settings.tolerance, "smaller error of elements").after(found)
