"""Of which materials whole cells are: counts, contours and law, each step for a stated reason."""

import dataclasses
from collections.abc import Callable

import numpy as np

from hypernode.fem.transfer import transfer
from hypernode.identification import budgets, thresholds
from hypernode.identification.beside import Beside
from hypernode.identification.candidate import Candidate
from hypernode.identification.law_search import LawSearch
from hypernode.identification.mosaic import Mosaic
from hypernode.identification.topological_derivative import with_other_cells
from hypernode.identification.trials import Trials
from hypernode.verdict import Ending

#: From how many materials there are to whole cells of them on a coarser grid.
Contours = Callable[[int], Candidate | None]
#: Name of the move that goes on with a descent.
MORE = "the same, more steps"


class MosaicSearch:
    """The search on one test.

    Args:
        steps: load steps that count.
    """

    def __init__(self, trials: Trials, steps: list[int]):
        self._trials, self._steps = trials, steps

    def end(self, begun: Candidate, beside: Beside, coarser: Contours | None = None) -> Candidate | None:
        """The likeliest few materials of whole cells; None where the sheet is not made of them.

        Args:
            begun: the candidate that leaves what a factor in every cell explains.
            beside: that factor, on top of its materials, on the same grid or a coarser one.
            coarser: where contours of so many materials settle on a coarser grid.
        """
        trials, known, kept = self._trials, beside.known, None
        if beside.found is None:
            return None
        for count in range(known.count + (known.count == 1), budgets.MOST_MATERIALS + 1):
            if len(beside.parts(count)[1]) < count:
                break
            found = self._of_count(begun, beside, count, coarser)
            if found is None:
                continue
            if found.fit.misfit > thresholds.NOT_MADE_OF_FEW * max(beside.found.misfit, 1.0):
                trials.passed_over(found, "leaves far more than a factor in every cell")
                continue
            found = self._lawful(found) if coarser is None else self._lawful(self._plainer(self._settled(found)))
            if kept is not None:
                gain = found.gain_over(kept)
                better, worse = (found, kept) if gain > thresholds.EVIDENCE else (kept, found)
                trials.passed_over(worse, f"scores {abs(gain):+.1f} against {better.fit.field.count} materials")
                if better is kept:
                    break
            kept = found
            if not kept.leaves_more_than_noise:
                break
        return kept

    def contours(self, begun: Candidate, beside: Beside, count: int, coarser: Contours | None) -> Candidate | None:
        """Whole cells of so many materials once their contours are settled; None where there are none.

        The coarsest grid tells the first term of the law. Further ones would pay for what its elements miss.

        Args:
            begun, beside, coarser: of :meth:`end`.
        """
        if beside.found is None or len(beside.parts(count)[1]) < count:
            return None
        found = self._of_count(begun, beside, count, coarser)
        if found is None:
            return None
        return self._lawful(found, 1) if coarser is None else self._settled(found)

    def _of_count(self, begun: Candidate, beside: Beside, count: int, coarser: Contours | None) -> Candidate | None:
        """Whole cells of so many materials, by what a coarser grid tells or by levels of the factor."""
        lines, problem, u = begun.fit.field.lines, begun.problem, begun.u
        known = coarser(count) if coarser else None
        if known is None:
            (labels, materials), grid = beside.parts(count), beside.known.lines.grid.mesh
        else:
            labels, materials, grid = known.fit.field.of_cells, known.fit.field.materials, known.problem.mesh
            problem, to_mesh = self._trials.with_terms(begun, known.terms), transfer(grid, problem.mesh).nodes
            u = {step: to_mesh @ each for step, each in known.u.items()}
        field = Mosaic.of(lines, materials, labels[transfer(grid, lines.grid.mesh).cells])
        move = f"cells of {count} materials"
        return self._trials.descend(move, begun, problem, field, u, self._steps, budgets.FAR, begun.fit.window)

    def _lawful(self, kept: Candidate, most: int | None = None) -> Candidate:
        """The same with the terms of the law that pay. Contours settle with every term that joins."""
        found = LawSearch(self._trials, self._steps, False, self._settled).end(kept, most)
        return self._settled(kept) if found is kept else found

    def _plainer(self, kept: Candidate) -> Candidate:
        """The same without terms that paid for what coarser elements miss."""
        return LawSearch(self._trials, self._steps, False).plainer(kept)

    def near(self, kept: Candidate, because: str) -> Candidate | None:
        """Whole cells of the materials that a candidate has there; None without equilibrium.

        Args:
            because: what is tried, in words.
        """
        before = kept.fit.field
        # Labels that lines tell cost what these lines cost.
        code = kept.fit.determined - kept.fit.of_materials + kept.fit.prior + before.places
        told = before if isinstance(before, Mosaic) else Mosaic.of(before.lines, before.materials, before.labels())
        field = told if told is before else dataclasses.replace(told, given=told.of_cells, code=code)
        if len(np.unique(field.of_cells)) < field.count:
            return None
        found = self._trials.descend(
            because, kept, kept.problem, field, kept.u, self._steps, budgets.FAR, kept.fit.window
        )
        far = thresholds.NEARLY if kept.problem.noisy else thresholds.NOT_MADE_OF_FEW
        if found is None or found.level > far * max(kept.level, 1.0):
            return found
        return self._settled(found)

    def instead_of(self, kept: Candidate, finer: Candidate) -> Candidate:
        """The same materials of whole cells, if these explain more than lines do; else what lines ended with.

        Where it is stated that displacements are those of finite elements on the grid, no line cuts a cell,
        unless whole cells leave more than noise.
        """
        field = kept.fit.field
        if field.count == 1 or len(field.gradual) or isinstance(field, Mosaic):
            return finer
        trials, found = self._trials, self.near(kept, "whole cells of these materials")
        if found is None:
            return finer
        if kept.problem.observations.own_grid and not found.leaves_more_than_noise:
            trials.passed_over(finer, "cuts cells of the mesh that displacements are stated to be of")
            return found
        gain = found.gain_over(finer)
        best, other, word = (found, finer, "whole cells") if gain > 0.0 else (finer, found, "lines")
        trials.passed_over(other, f"scores {abs(gain):+.1f} against {word}")
        return best

    def _settled(self, kept: Candidate) -> Candidate:
        """The same once no cell at a contour would rather be of another material, and its descent has ended."""
        for _ in range(budgets.OTHER_CELLS_ROUNDS):
            kept = with_other_cells(self._trials, kept, self._steps, False)
            if (more := self._further(kept)) is None:
                break
            kept = more
        return kept

    def _further(self, kept: Candidate) -> Candidate | None:
        """The same after more steps of a descent that was out of them; None where that was not, or is no better."""
        if kept.fit.ending is not Ending.OUT_OF_ITERATIONS:
            return None
        u, window = kept.u, kept.fit.window
        found = self._trials.descend(MORE, kept, kept.problem, kept.fit.field, u, self._steps, budgets.FAR, window)
        if found is None or found.gain_over(kept) <= 0.0:
            return None
        self._trials.passed_over(kept, "ended early")
        return found
