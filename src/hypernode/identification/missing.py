"""What materials and lines lack, where they leave mostly no noise under the law that was found.

Another cut into more materials stands against a gradual change of all of them: what either leaves decides
(docs/decisions/0199).
"""

from hypernode.identification.beside import Beside
from hypernode.identification.candidate import Candidate
from hypernode.identification.common_trend import with_common_trend
from hypernode.identification.parting import Parting


def with_what_is_missing(parting: Parting, one: Candidate, beside: Beside, kept: Candidate) -> Candidate:
    """A candidate with what explains more of what it leaves; itself where nothing does.

    Args:
        one: the homogeneous sheet.
        beside: the factor in every cell on top of it.
        kept: several materials with a law, on elements of the grid.
    """
    if len(kept.fit.field.gradual) or not kept.leaves_mostly_no_noise:
        return kept
    on_top = parting.in_cells(parting.beside(kept))
    if on_top.found is None:
        return kept
    more = parting.parted(kept, on_top)
    if more is kept:
        return kept
    common = with_common_trend(parting, one, beside, kept)
    gain = more.gain_over(common)
    if common is kept or gain > 0.0:
        if common is not kept:
            parting.trials.passed_over(common, f"scores {gain:+.1f} against {more.fit.field.count} materials")
        return more
    parting.trials.passed_over(more, f"scores {-gain:+.1f} against a gradual change of all materials")
    return common
