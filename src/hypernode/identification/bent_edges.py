"""Edges that are off by what bends beyond them: believed where it explains most of what materials and lines leave.

The displacement of a cut edge is a mean over a window, half of which lies beyond the edge. An interface that runs along
the edge may bend it there, where nobody looks (docs/decisions/0194).
"""

from hypernode.data.measurement import EDGES_BEND_BESIDE
from hypernode.identification import budgets
from hypernode.identification.candidate import Candidate
from hypernode.identification.trials import Trials

MOVE = "edges that may be off by what bends beside them"


def with_bent_edges(
    trials: Trials, kept: Candidate, finer: Candidate, steps: list[int], finds_window: bool
) -> tuple[Candidate, Candidate]:
    """Both candidates, with edges that may be off by more if that halves the squares that were left.

    Args:
        trials: which believe it afterwards.
        kept, finer: the same materials and lines on elements of the grid, and on finer ones.
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """
    if not finer.leaves_mostly_no_noise or finer.fit.field.count == 1:
        return kept, finer
    before = trials.measurement
    trials.believe(before.assign_attrs({EDGES_BEND_BESIDE: "true"}))
    bent = _again(trials, finer, steps, finds_window)
    if bent is None or not bent.halves(finer):
        trials.believe(before)
        if bent is not None:
            trials.passed_over(bent, "leaves more than half of the squares that sharper edges leave")
        return kept, finer
    trials.passed_over(finer, "leaves more than twice the squares, with edges that are taken to be right")
    return (bent if kept is finer else _again(trials, kept, steps, finds_window) or kept), bent


def _again(trials: Trials, candidate: Candidate, steps: list[int], finds_window: bool) -> Candidate | None:
    problem, fit = trials.problem(candidate.terms, candidate.subcells), candidate.fit
    window = fit.window if finds_window else None
    return trials.descend(MOVE, candidate, problem, fit.field, candidate.u, steps, budgets.NEAR, window, finds_window)
