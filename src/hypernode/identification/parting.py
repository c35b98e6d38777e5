"""Into how many materials a sheet is parted, each step for a stated reason.

Where materials are is told by what a factor of the stiffness in every cell explains, on top of what is known. That
factor, cut into two, three and four levels, is where materials and lines begin. One more material is kept as long as it
explains more of the test than its numbers cost. One material that changes gradually stands beside them.
"""

import numpy as np

from hypernode.identification import budgets, priors, thresholds
from hypernode.identification.beside import Beside
from hypernode.identification.candidate import Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import turned
from hypernode.identification.merging import merged
from hypernode.identification.problem import FieldProblem
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.stiffness import ByCell, CellDescent
from hypernode.identification.trend import trend
from hypernode.identification.trials import Trials
from hypernode.mechanics.convex_basis import FIBRE_VECTOR
from hypernode.progress import say


class Parting:
    """The search for materials on one test.

    Args:
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
        small: whether steps are small, so that what is left says nothing of the law.
    """

    def __init__(self, trials: Trials, steps: list[int], finds_window: bool, small: bool = False):
        self.trials, self.steps, self.finds_window, self._small = trials, steps, finds_window, small
        #: What a factor in every cell on top of one material leaves of the displacements, once one was fitted.
        self.by_cell = np.inf
        #: One material that changes gradually, and two materials with lines, once these were tried.
        self.gradual: Candidate | None = None
        self.of_two: Candidate | None = None
        #: Materials that were more than those which were kept, once these were tried.
        self.one_more: Candidate | None = None

    def beside(self, begun: Candidate) -> Beside:
        """The factor of the stiffness in blocks of cells that explains more than a candidate, on top of its materials.

        The materials of the homogeneous fit take the place of one that was fitted to the whole sheet.
        """
        plain = begun.problem.homogeneous.params[None]
        known = begun.fit.field.with_law(plain) if begun.start is None else begun.fit.field
        return self._by_cell(begun, begun.problem, known, [0], np.zeros((1, 1)))

    def with_fibres(self, one: Candidate, beside: Beside) -> Beside | None:
        """A factor and fibres in blocks of cells, on top of one homogeneous material.

        Args:
            beside: the factor alone, from which both begin; None where they leave more than half of its squares.
        """
        problem = self.trials.problem([*one.terms, "fibre"])
        columns = [problem.basis.names.index(name) for name in ("log_level", *FIBRE_VECTOR)]
        plain = problem.homogeneous.params.copy()
        # Fibres have no slope where they vanish, so that they begin in some direction.
        plain[columns[1:]] = 0.0
        known = one.fit.field.with_law(plain[None])
        directions = [begun[0, columns[1:]] for begun in turned(problem.basis.start[None], problem, "fibre")]
        starts = np.c_[np.zeros(len(directions)), directions]
        directed = self._by_cell(one, problem, known, columns, starts, beside.found)
        halves = directed.found is not None and (beside.found is None or directed.found.halves(beside.found))
        return directed if halves else None

    def _largest(self, problem: FieldProblem) -> list[int]:
        """The largest step of every load case, of those that count."""
        loading = problem.observations.loading
        cases = {loading.load_case[k] for k in self.steps}
        of_case = ([k for k in self.steps if loading.load_case[k] == case] for case in sorted(cases))
        return [max(steps, key=lambda k: loading.t[k]) for steps in of_case]

    def smallest(self, one: Candidate) -> list[int]:
        """The smallest step of every load case of which one material leaves far more than noise, or the largest.

        The smaller a deformation is, the less it matters how materials stiffen.
        """
        problem, loading, found = one.problem, one.problem.observations.loading, []
        for largest in self._largest(problem):
            own = np.flatnonzero(loading.load_case == loading.load_case[largest])
            for step in own[np.argsort(loading.t[own], kind="stable")]:
                test = SeenTest(problem, [int(step)], priors.FIRST_WINDOW if self.finds_window else None)
                states = test.states(one.fit.field, [one.u[int(step)]])
                if step == largest or (states is not None and test.left(states) > thresholds.FAR_FROM_NOISE):
                    found.append(int(step))
                    break
        return found

    def _by_cell(
        self, begun: Candidate, problem: FieldProblem, known: Interfaces, columns, starts, others: ByCell | None = None
    ) -> Beside:
        """Numbers of every cell that explain the largest steps of a test."""
        trials, steps = self.trials, self._largest(problem)
        test = SeenTest(problem, steps, begun.fit.window if self.finds_window else None)
        descent = CellDescent(test, known, trials.settings, columns)
        found = Beside(problem, known, columns, descent, None, steps, begun.u)
        guesses = [begun.u[k] for k in steps] if others is None else [u for u, _, _ in others.states]
        found = found._replace(found=descent.of_blocks(guesses, starts, others))
        self._tell(found, "blocks of cells")
        return found

    def in_cells(self, beside: Beside) -> Beside:
        """The factor once cells near jumps have one of their own."""
        if beside.found is None:
            return beside
        found = beside._replace(found=beside.descent.of_cells(beside.found))
        self._tell(found, "cells near jumps")
        if beside.known.count == 1:
            self.by_cell = min(self.by_cell, found.found.misfit)
        return found

    def _tell(self, beside: Beside, where: str) -> None:
        words = "a factor of the stiffness" + " and fibres" * (len(beside.columns) > 1)
        left = "no equilibrium" if beside.found is None else f"missed by {beside.found.misfit:.3g}"
        say("constrained", self.trials.name, f"{words} in {where}: {left}")

    def parted(self, begun: Candidate, beside: Beside | None = None, most: int | None = None) -> Candidate | None:
        """As many materials, or more, as explain more than they cost; None without equilibrium.

        Args:
            begun: with a law.
            beside: of :meth:`beside`, where that is known.
            most: materials at most, other than usual.
        """
        first = begun.fit.field.count == 1
        beside = beside or self.in_cells(self.beside(begun))
        if beside.found is None:
            return None if first else begun
        kept = self._of_more(begun, beside, budgets.MOST_MATERIALS if most is None else most)
        if first:
            kept = self._gradual(begun, beside, kept)
        return kept if len(kept.fit.field.gradual) else merged(self.trials, kept, self.steps, self.finds_window)

    def _of_more(self, begun: Candidate, beside: Beside, most: int) -> Candidate:
        """Materials from cuts of numbers of every cell, as long as more of them explain more than they cost."""
        trials, first, kept = self.trials, begun.fit.field.count == 1, begun
        # On top of another law, as many materials may lie elsewhere.
        for count in range(beside.known.count + first, most + 1):
            found = self.of_parts(begun, beside, count)
            if found is None:
                continue
            if first and count == 2:
                self.of_two = found
            gain = found.gain_over(kept)
            if why := self._why_more(found, kept):
                trials.passed_over(kept, f"{why} {count} materials")
                kept, self.one_more = found, None
            else:
                trials.passed_over(found, f"scores {-gain:+.1f} against {kept.fit.field.count} materials")
                if kept is not begun:
                    self.one_more = self.one_more or found
                    # Small steps cost little, and two lines between three materials may go astray where three do not.
                    if not self._small:
                        break
            # Numbers of every cell leave what more materials might explain. Of small steps they leave no law.
            explained = kept.fit.misfit <= beside.found.misfit and not self._small
            if explained or not kept.leaves_more_than_noise:
                break
        return kept

    def _why_more(self, found: Candidate, kept: Candidate) -> str:
        """Why a candidate of more materials is kept, in words; empty where it is not.

        What small steps leave of one material says nothing of the law. Residuals of a law that lacks a term count as
        few independent numbers. So it may halve the squares instead of scoring better.
        """
        gain = found.gain_over(kept)
        if gain > thresholds.EVIDENCE:
            return f"scores {gain:+.1f} against"
        halves = (self._small or kept.fit.field.count > 1) and found.halves(kept)
        return "leaves twice the squares of" if halves else ""

    def of_parts(self, begun: Candidate, beside: Beside, count: int) -> Candidate | None:
        """So many materials with lines where numbers of every cell are cut; None where they cannot be."""
        labels, materials = beside.parts(count)
        if len(materials) < count:
            return None
        field = Interfaces.around(beside.known.lines, materials, labels)
        window = priors.FIRST_WINDOW if self.finds_window and begun.fit.field.count == 1 else begun.fit.window
        finds, u, steps, move = self.finds_window, beside.reached, self.steps, f"{count} materials and lines"
        return self.trials.descend(
            move, begun, beside.problem, field, u, steps, budgets.FAR, window, finds, settled=False
        )

    def _gradual(self, begun: Candidate, beside: Beside, kept: Candidate) -> Candidate:
        """One material that changes gradually, where few materials explain the test no better."""
        trials, u, known, factor = self.trials, beside.reached, beside.known, beside.found.values[:, 0]
        if len(beside.columns) > 1:
            # Fibres are those of most cells.
            _, materials = beside.parts(1)
            known, factor = known.with_law(materials), factor - np.mean(factor)
            begun = trials.descend(
                "one material with fibres", begun, beside.problem, known, u, self.steps, budgets.NEAR
            )
        best = begun and trend(trials, begun, known, factor, u, self.steps, False, kept)
        if best is None:
            return kept
        self.gradual, gain = best, best.gain_over(kept)
        if gain > -thresholds.EVIDENCE:
            trials.passed_over(kept, f"scores {gain:+.1f} against one material that changes gradually")
            return best
        trials.passed_over(best, f"scores {-gain:+.1f} against {kept.fit.field.count} materials")
        return kept
