"""Materials and lines from the smallest load steps, in which law and direction matter least."""

from collections.abc import Iterator

from hypernode.identification import budgets
from hypernode.identification.candidate import Candidate
from hypernode.identification.moves import Moves
from hypernode.identification.parting import Parting


def from_smallest(parting: Parting, one: Candidate) -> Iterator[Candidate]:
    """Materials and lines that the smallest load steps tell, in the largest; nothing where they tell none.

    Those that these steps speak for come first. Then comes one material more, where that was tried, and a gradual
    change that leaves less. Small steps show where materials are. How many there are is told by the law, which only
    the largest steps tell.

    Args:
        parting: the search in the steps that count.
        one: the homogeneous sheet.
    """
    trials, finds, steps = parting.trials, parting.finds_window, parting.smallest(one)
    small = Parting(trials, steps, finds, small=True)
    alone = trials.descend(
        "one material, smallest load steps", None, one.problem, one.fit.field, one.u, steps, budgets.NEAR
    )
    if alone is None:
        return
    beside = small.beside(alone)
    directed = small.with_fibres(alone, beside) if "fibre" in trials.settings.terms else None
    kept = small.parted(alone, directed or small.in_cells(beside))
    if kept is None or kept is alone:
        return
    loading = one.problem.observations.loading
    less = small.gradual is not None and small.gradual.fit.misfit < kept.fit.misfit
    for told in filter(None, (kept, small.one_more, small.gradual if less else None)):
        u = dict(told.u)
        for k in set(parting.steps) - set(steps):
            like = next(step for step in steps if loading.load_case[step] == loading.load_case[k])
            # What materials change grows about as the load does.
            u[k] = one.u[k] + (told.u[like] - alone.u[like]) * loading.t[k] / loading.t[like]
        field, window = told.fit.field, told.fit.window
        move = "the same, largest load steps"
        found = trials.descend(
            move, told, told.problem, field, u, parting.steps, budgets.NEAR, window, move_lines=False
        )
        if found is not None:
            yield found


def of_likeliest_cut(moves: Moves, kept: Candidate, others: Iterator[Candidate]) -> Candidate:
    """A candidate, or other materials with the terms that pay there, where these explain more.

    Materials that were cut before fibres were known may stand for directions, or be too few. So others are asked where
    the law has fibres and there are several, or more than noise is left.

    Args:
        moves: in the steps that count.
        kept: with a law.
        others: materials with lines that may stand in their place.
    """
    while _may_be_others(kept) and (other := next(others, None)):
        other = moves.turned(moves.lawful(other))
        gain = other.gain_over(kept)
        better, worse = (other, kept) if gain > 0.0 else (kept, other)
        moves.trials.passed_over(worse, f"scores {abs(gain):+.1f} against another cut")
        kept = better
    return kept


def _may_be_others(kept: Candidate) -> bool:
    field = kept.fit.field
    several = not len(field.gradual) and (field.count > 2 or kept.leaves_more_than_noise)
    return several and "fibre" in kept.terms
