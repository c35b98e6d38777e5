"""Selection of one candidate, and the reasons against the others."""

from hypernode.identification.estimate import Estimate


def likeliest(*tried: Estimate) -> Estimate:
    """The most probable estimate; the first of several equal ones.

    An estimate that does not explain the test, or that has fitted its noise, is chosen only without an alternative. The
    trace of the chosen one has the reasons against the others.
    """
    best = min(tried, key=lambda each: (each.unexplained > 1.0 or each.overfitted, each.information_criterion))
    for other in tried:
        if other.trial is not best.trial:
            best = best.instead_of(other, because=reason_against(other, best))
    return best


def reason_against(other: Estimate, best: Estimate) -> str:
    """Why one estimate is rejected in favour of another, in words."""
    if other.unexplained > 1.0 >= best.unexplained:
        return "does not explain the test"
    if other.overfitted and not best.overfitted:
        return "explains noise as well"
    return f"scores {other.information_criterion - best.information_criterion:+.1f} against the better one"
