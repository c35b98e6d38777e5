"""Into how many materials a sheet is parted, each step for a stated reason.

Where materials are is told by what a factor of the stiffness in every cell explains, on top of what is known. That
factor, cut into two, three and four levels, is where materials and lines begin. One more material is kept as long as it
explains more of the test than its numbers cost. One material that changes gradually stands beside them.
"""

from typing import NamedTuple

import numpy as np

from hypernode.identification.candidate import EVIDENCE, Candidate
from hypernode.identification.gradual import BENDS
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import stiffness_of
from hypernode.identification.partition import cut_into
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.stiffness import Stiffness, StiffnessDescent
from hypernode.identification.trials import FAR, NEAR, Trials
from hypernode.progress import say

#: Materials at most.
MOST = 4
#: Side of a window that nobody stated, in points, where its search begins: subsets overlap by half.
WINDOW = 1.5
#: Difference of the logarithms of stiffness up to which two materials are tried as one.
ALIKE = 0.15


class Beside(NamedTuple):
    """A factor of the stiffness in every cell, on top of what is known.

    Attributes:
        known: materials and lines.
        stiffness: the factor, None without equilibrium.
        u: displacement of every load step with it.
    """

    known: Interfaces
    stiffness: Stiffness | None
    u: dict


class Parting:
    """The search for materials on one test.

    Args:
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """

    def __init__(self, trials: Trials, steps: list[int], finds_window: bool):
        self._trials, self._steps, self._finds = trials, steps, finds_window
        #: What a factor in every cell leaves of the displacements, once one was fitted.
        self.by_cell = np.inf

    def beside(self, begun: Candidate) -> Beside:
        """The factor in every cell that explains more than a candidate, on top of its materials.

        The materials of the homogeneous fit take the place of one that was fitted to the whole sheet.
        """
        plain = begun.problem.homogeneous.params[None]
        known = begun.fit.field.with_law(plain) if begun.start is None else begun.fit.field
        trials, loading = self._trials, begun.problem.observations.loading
        last = [k for k in self._steps if loading.t[k] == loading.t[loading.load_case == loading.load_case[k]].max()]
        window = begun.fit.window if self._finds else None
        descent = StiffnessDescent(SeenTest(begun.problem, last, window), known, trials.settings.regulariser_weight)
        stiffness = descent.end([begun.u[k] for k in last])
        if stiffness is None:
            return Beside(known, None, begun.u)
        say("constrained", trials.name, f"a factor of the stiffness in every cell: missed by {stiffness.misfit:.3g}")
        self.by_cell = min(self.by_cell, stiffness.misfit)
        reached = {k: state[0] for k, state in zip(last, stiffness.states, strict=True)}
        return Beside(known, stiffness, {**begun.u, **reached})

    def parted(self, begun: Candidate, beside: Beside | None = None) -> Candidate | None:
        """As many materials, or more, as explain more than they cost; None without equilibrium.

        Args:
            begun: with a law.
            beside: of :meth:`beside`, where that is known.
        """
        trials, problem, first = self._trials, begun.problem, begun.fit.field.count == 1
        known, stiffness, u = beside or self.beside(begun)
        if stiffness is None:
            return None if first else begun
        level = stiffness_of(problem, known.materials)
        kept, window = begun, WINDOW if self._finds and first else begun.fit.window
        # On top of another law, as many materials may lie elsewhere.
        for count in range(known.count + first, MOST + 1):
            field = cut_into(level[known.labels()] + stiffness.factor, count, known, level)
            if field.count < count:
                break
            move = f"{count} materials and lines"
            found = trials.descend(move, begun, problem, field, u, self._steps, FAR, window, self._finds, settled=False)
            if found is None:
                continue
            gain = found.gain_over(kept)
            if gain > EVIDENCE:
                trials.passed_over(kept, f"scores {gain:+.1f} against {count} materials")
                kept = found
            else:
                trials.passed_over(found, f"scores {-gain:+.1f} against {kept.fit.field.count} materials")
                if kept is not begun:
                    break
            # A factor in every cell leaves what more materials might explain.
            if not kept.leaves_more_than_noise or kept.fit.misfit <= stiffness.misfit:
                break
        if first:
            kept = self._gradual(begun, known, stiffness.factor, u, kept)
        if len(kept.fit.field.gradual):
            return kept
        return self.merged(kept)

    def _gradual(self, begun: Candidate, known: Interfaces, factor, u, kept: Candidate) -> Candidate:
        """One material that changes gradually, where few materials explain the test no better.

        A change that bends less is of fewer numbers. It is tried as long as what they cost may decide.
        """
        trials, best = self._trials, None
        for bend in BENDS:
            move, field = f"a gradual change, bends of {bend:g}", known.changing(factor, bend)
            found = trials.descend(move, begun, begun.problem, field, u, self._steps, FAR)
            gain = -np.inf if found is None else np.inf if best is None else found.gain_over(best)
            if found is None or gain <= 0.0:
                if found is not None:
                    trials.passed_over(found, f"scores {-gain:+.1f} against larger bends")
                break
            if best is not None:
                trials.passed_over(best, f"scores {gain:+.1f} against smaller bends")
            best, factor, u = found, found.fit.field.grid_factor(), found.u
            if best.gain_over(kept) < -best.fit.determined:
                break
        if best is None:
            return kept
        gain = best.gain_over(kept)
        if gain > -EVIDENCE:
            trials.passed_over(kept, f"scores {gain:+.1f} against one material that changes gradually")
            return best
        trials.passed_over(best, f"scores {-gain:+.1f} against {kept.fit.field.count} materials")
        return kept

    def merged(self, kept: Candidate) -> Candidate:
        """Materials that are as stiff as one another as one, as long as two do not explain more."""
        trials = self._trials
        while kept.fit.field.count > 2:
            level = stiffness_of(kept.problem, kept.fit.field.materials)
            apart, one, other = min((abs(level[i] - level[j]), i, j) for i in range(len(level)) for j in range(i))
            if apart > ALIKE:
                break
            field, window = kept.fit.field.merged(one, other), kept.fit.window
            move = "two materials as one"
            found = trials.descend(
                move, kept, kept.problem, field, kept.u, self._steps, NEAR, window, self._finds, settled=False
            )
            if found is None or kept.gain_over(found) > EVIDENCE:
                if found is not None:
                    trials.passed_over(found, f"scores {kept.gain_over(found):+.1f} against two")
                break
            trials.passed_over(kept, f"scores {kept.gain_over(found):+.1f} against one material less")
            kept = found
        return kept
