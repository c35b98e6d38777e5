"""Two materials as one, where data hardly tell them apart.

A law that lacks a term may part a material into several, each with a direction or a stiffness of its own. With the term
they are one, and a small one of them has parameters that nothing determines.
"""

import numpy as np

from hypernode.identification import budgets, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.trials import Trials
from hypernode.mechanics.convex_basis import FIBRE_VECTOR


def merged(trials: Trials, kept: Candidate, steps: list[int], finds_window: bool) -> Candidate:
    """The candidate with two materials as one whose difference is known least, as long as two do not explain more.

    Args:
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """
    move = "two materials as one"
    while kept.fit.field.count > 2 and not trials.was_tried(move, kept):
        field, window = _without_least_known(kept), kept.fit.window
        if field is None:
            break
        found = trials.descend(
            move, kept, kept.problem, field, kept.u, steps, budgets.FAR, window, finds_window, settled=False
        )
        if found is None or kept.gain_over(found) > thresholds.EVIDENCE:
            if found is not None:
                trials.passed_over(found, f"scores {kept.gain_over(found):+.1f} against two")
            break
        trials.passed_over(kept, f"scores {kept.gain_over(found):+.1f} against one material less")
        kept = found
    return kept


def _without_least_known(kept: Candidate) -> Interfaces | None:
    """The field with those materials as one whose difference is the smallest over its uncertainty (Wald's test).

    The better known of them stands for both. None where all differ beyond doubt.
    """
    field, names = kept.fit.field, kept.problem.basis.names
    turned = np.where([name in FIBRE_VECTOR for name in names], -1.0, 1.0)
    blocks = kept.fit.covariance.reshape(field.count, len(names), field.count, len(names)).swapaxes(1, 2)
    found = []
    for i in range(field.count):
        for j in range(i):
            covariance = blocks[i, i] + blocks[j, j] - blocks[i, j] - blocks[j, i]
            # Fibres have no sign.
            apart = [field.materials[i] - sign * field.materials[j] for sign in (1.0, turned)]
            found.append((min(float(each @ np.linalg.solve(covariance, each)) for each in apart), i, j))
    squared, i, j = min(found)
    if squared > thresholds.APART**2:
        return None
    merged = field.merged(i, j)
    known = min((i, j), key=lambda k: float(np.trace(blocks[k, k])))
    merged.materials[min(i, j)] = field.materials[known]
    return merged
