"""The field of a grid of many cells, which begins from that of every second of its lines."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from hypernode.config.methods import Constrained
from hypernode.identification.certain_phases import of_certain_phases
from hypernode.identification.estimate import Estimate
from hypernode.identification.gauss_newton import descend
from hypernode.identification.phases import on_finer_grid
from hypernode.verdict import Ending


def from_coarser_grid(
    problem_of: Callable, first: Sequence[str], settings: Constrained, coarse: Estimate, name: str
) -> tuple[Estimate, bool]:
    """The field of a finer grid that begins from a coarser one's, and whether it is of phases, which are kept.

    Phases are where they explain the test with all terms that there are, or leave others nothing to explain.

    Args:
        problem_of: terms -> the problem of the finer grid.
        first: the plainest terms.
        settings: configuration of the stage.
        coarse: the field of the coarser grid.
        name: case, for progress.
    """
    problem = problem_of(*coarse.problem.basis.terms)
    finer = on_finer_grid(problem, settings, coarse, name)
    if finer is not None:
        return finer, True
    near = problem.certain and of_certain_phases(problem, problem_of(*first), settings, coarse, name)
    if not near:
        return descend(problem, settings, name, coarse, (), settings.tolerance, "finer grid").after(coarse), False
    every = near.ending is Ending.CONVERGED and set(settings.terms) <= set(problem.basis.terms)
    if near.complete or (every and not near.ambiguous):
        return near, True
    loose = replace(problem.strategy, cg_tolerance=problem.strategy.cg_tolerance_of_phases)
    near = replace(near, linear=None, phases=None)
    return descend(
        problem.with_strategy(loose), settings, name, near, (), settings.tolerance, "cells from phases"
    ).after(near), False
