"""Materials and lines from the smallest load steps, in which law and direction matter least."""

from hypernode.identification.candidate import Candidate
from hypernode.identification.moves import Moves
from hypernode.identification.parting import Parting
from hypernode.identification.trials import NEAR

MOVE = "one material, smallest load steps"


def from_smallest(parting: Parting, one: Candidate) -> Candidate | None:
    """Materials and lines that the smallest load steps tell, in the largest; None where they tell none.

    Fibres are taken where they explain half of the squares that a factor leaves of these steps, in blocks as large.

    Args:
        parting: the search in the steps that count.
        one: the homogeneous sheet.
    """
    trials, finds, steps = parting.trials, parting.finds_window, parting.smallest(one)
    small = Parting(trials, steps, finds, small=True)
    alone = trials.descend(MOVE, None, one.problem, one.fit.field, one.u, steps, NEAR)
    if alone is None:
        return None
    beside = small.beside(alone)
    directed = small.with_direction(alone, beside) if "fibre" in trials.settings.terms else beside
    if directed.found is not None and (beside.found is None or directed.found.halves(beside.found)):
        kept = small.parted(alone, directed)
    else:
        kept = small.parted(alone, small.in_cells(beside))
    if kept is None or kept is alone:
        return None
    loading, u = one.problem.observations.loading, dict(kept.u)
    for k in set(parting.steps) - set(steps):
        like = next(step for step in steps if loading.load_case[step] == loading.load_case[k])
        # What materials change grows about as the load does.
        u[k] = one.u[k] + (kept.u[like] - alone.u[like]) * loading.t[k] / loading.t[like]
    move, window = "the same, largest load steps", kept.fit.window
    return trials.descend(move, kept, kept.problem, kept.fit.field, u, parting.steps, NEAR, window, move_lines=False)


def of_likelier_cut(parting: Parting, moves: Moves, one: Candidate, kept: Candidate) -> Candidate:
    """A candidate, or materials that the smallest load steps tell, with their law, where these explain more.

    Several materials that were cut before fibres were known may stand for directions. Small steps are asked once.

    Args:
        parting, moves: the search in the steps that count.
        one: the homogeneous sheet.
        kept: with a law.
    """
    asked = parting.trials.was_tried(MOVE, None)
    if kept.fit.field.count <= 2 or "fibre" not in kept.terms or asked:
        return kept
    other = from_smallest(parting, one)
    if other is None:
        return kept
    other = moves.merged(moves.with_law(other))
    gain = other.gain_over(kept)
    better, worse = (other, kept) if gain > 0.0 else (kept, other)
    parting.trials.passed_over(worse, f"scores {abs(gain):+.1f} against another cut")
    return better
