"""Which of several candidates is kept, and why the others are not."""

from hypernode.identification.estimate import Estimate


def likeliest(*tried: Estimate) -> Estimate:
    """The most probable of some estimates; the first of several alike.

    One that does not explain the test, or explains its noise as well, is kept only where there is no other. The trace
    of the one that is kept says why the others were not.
    """
    best = min(tried, key=lambda each: (each.unexplained > 1.0 or each.overfitted, each.information_criterion))
    for other in tried:
        if other.trial is not best.trial:
            best = best.instead_of(other, because=reason_against(other, best))
    return best


def reason_against(other: Estimate, best: Estimate) -> str:
    """Why one estimate is passed over for another, in words."""
    if other.unexplained > 1.0 >= best.unexplained:
        return "does not explain the test"
    if other.overfitted and not best.overfitted:
        return "explains noise as well"
    return f"scores {other.information_criterion - best.information_criterion:+.1f} against the better one"
