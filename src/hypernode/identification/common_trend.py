"""Materials whose stiffness changes gradually by a common factor: believed where it explains most of what they leave.

A print that cures unevenly, a thickness that nobody mapped, and a camera that is not square to the sheet are smooth
over all of it. Materials and lines cannot follow that, and bend to take a part of it up (docs/decisions/0181).
"""

import numpy as np

from hypernode.identification import priors, thresholds
from hypernode.identification.beside import Beside
from hypernode.identification.candidate import Candidate
from hypernode.identification.parting import Parting
from hypernode.identification.trend import trend


def with_common_trend(parting: Parting, one: Candidate, beside: Beside, kept: Candidate) -> Candidate:
    """A candidate of several materials, or one with a common factor if that halves the squares that were left.

    What changes gradually may have misled the cut as well, or was cut into levels. So two materials alone are tried
    too.

    Args:
        one: the homogeneous sheet.
        beside: the factor in every cell on top of it.
        kept: on elements of the grid.
    """
    trials, tried = parting.trials, []
    rest = parting.steps, parting.finds_window, kept
    for begun in (kept, parting.of_two or parting.of_parts(one, beside, 2)):
        if begun is None or begun.level > thresholds.NOT_MADE_OF_FEW * kept.level:
            continue
        nothing = np.zeros(len(begun.fit.field.lines.grid.mesh.cells))
        found = trend(trials, begun, begun.fit.field, nothing, begun.u, *rest, bends=priors.GRADUAL_BENDS[:1])
        if found is not None:
            tried.append(found)
    if not tried:
        return kept
    first = tried[-1] if tried[-1].gain_over(tried[0]) > 0.0 else tried[0]
    for other in tried:
        if other is not first:
            trials.passed_over(other, f"scores {first.gain_over(other):+.1f} against a change on top of other lines")
    field, best = first.fit.field, first
    # Smaller bends leave no less.
    if first.halves(kept):
        best = trend(
            trials, first, field, field.grid_factor(), first.u, *rest, best=first, bends=priors.GRADUAL_BENDS[1:]
        )
    gain = best.gain_over(kept)
    if gain > thresholds.EVIDENCE and best.halves(kept):
        trials.passed_over(kept, f"scores {gain:+.1f} against a gradual change of all materials")
        return best
    why = f"scores {-gain:+.1f} against none" if gain <= thresholds.EVIDENCE else "leaves more than half of the squares"
    trials.passed_over(best, why)
    return kept
