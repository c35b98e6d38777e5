"""Moves from one candidate to another: elements, law, volume, cells, and whether a change is gradual."""

import dataclasses

import numpy as np

from hypernode.identification import budgets, numerics, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import LawSearch
from hypernode.identification.lines import Lines
from hypernode.identification.merging import merged
from hypernode.identification.mosaic_search import MosaicSearch
from hypernode.identification.parting import Parting
from hypernode.identification.problem import FieldProblem
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.topological_derivative import with_other_cells
from hypernode.identification.trials import Trials, homogeneous_displacement
from hypernode.identification.volume import of_likelier_volume


class Moves:
    """Moves on one test.

    Attributes:
        trials: of the test, which keep the record.
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """

    def __init__(self, trials: Trials, steps: list[int], finds_window: bool):
        self.trials, self.steps, self.finds_window = trials, steps, finds_window

    def one_material(self, problem: FieldProblem) -> Candidate | None:
        """The homogeneous sheet; None without equilibrium."""
        lines, u = Lines.of(problem.observations.grid, problem.refinement), homogeneous_displacement(problem)
        field = Interfaces.homogeneous(lines, problem.homogeneous.params)
        return self.trials.descend("one material", None, problem, field, u, self.steps, budgets.NEAR)

    def with_law(self, kept: Candidate) -> Candidate:
        """The same with the terms of the law that pay."""
        return LawSearch(self.trials, self.steps, self.finds_window).end(kept)

    def turned(self, kept: Candidate) -> Candidate:
        """The same, whose law changes together with its gradual stiffness where that explains more of the test."""
        field = kept.fit.field
        explained = not (kept.leaves_more_than_noise or kept.misses_forces)
        if field.count > 1 or not len(field.gradual) or explained or not kept.terms:
            return kept
        turning = dataclasses.replace(field, turn=np.zeros(field.materials.shape[1] - 1))
        move = "a law that changes with the stiffness"
        found = self.trials.descend(move, kept, kept.problem, turning, kept.u, self.steps, budgets.FAR)
        if found is None or found.gain_over(kept) <= thresholds.EVIDENCE:
            if found is not None:
                self.trials.passed_over(found, f"scores {kept.gain_over(found):+.1f} against one law")
            return kept
        self.trials.passed_over(kept, f"scores {found.gain_over(kept):+.1f} against a law that changes")
        return found

    def merged(self, kept: Candidate) -> Candidate:
        """The same, two materials of which are one where data hardly tell them apart."""
        return merged(self.trials, kept, self.steps, self.finds_window)

    def lawful(self, kept: Candidate) -> Candidate:
        """The same with the terms that pay, of no more materials than data tell apart, each cell of the likeliest."""
        kept = self.merged(self.with_law(kept))
        other = self.with_other_cells(kept)
        return kept if other is kept else self.merged(self.with_law(other))

    def with_other_cells(self, kept: Candidate) -> Candidate:
        """The same once no cell would rather be of another material, where none of them changes gradually."""
        field = kept.fit.field
        several = field.count > 1 and not len(field.gradual)
        return with_other_cells(self.trials, kept, self.steps, self.finds_window) if several else kept

    def of_one(self, alone: Candidate) -> Candidate:
        """One material with the likeliest law and volume."""
        return of_likelier_volume(self.trials, self.with_law(alone), self.steps, self.finds_window).kept

    def finer(self, coarse: Candidate) -> Candidate:
        """The same on finer finite elements."""
        trials, window, of_lines = self.trials, coarse.fit.window, coarse.fit.field.count > 1
        if not of_lines and not coarse.leaves_more_than_noise:
            return coarse
        if of_lines:
            self.finds_window = self.finds_window and window > thresholds.NO_WINDOW
        finds = self.finds_window and of_lines
        begun, window = trials.on_finer_elements(coarse), window if finds else None
        found = trials.descend("finer elements", coarse, *begun, self.steps, budgets.NEAR, window, finds)
        if found is None:
            return coarse
        if of_lines and found.misses_deformation:
            closer = found.fit.field.on(dataclasses.replace(found.fit.field.lines, apart=numerics.CLOSER_POINTS))
            begun, window = (found.problem, closer, found.u), found.fit.window
            move = "closer points of lines"
            found = trials.descend(move, found, *begun, self.steps, budgets.NEAR, window, finds) or found
        return found

    def finer_and_plainer(self, kept: Candidate) -> tuple[Candidate, Candidate]:
        """(a candidate, the same on finer elements), without terms that paid for what coarse elements miss."""
        finer = self.finer(kept)
        plainer = finer if finer is kept else self.plainer(finer)
        if plainer is not finer:
            kept = LawSearch(self.trials, self.steps, False).with_law_of(kept, plainer) or kept
        return kept, plainer

    def with_law_and_finer(self, kept: Candidate) -> tuple[Candidate, Candidate]:
        """(a candidate with the terms that pay, the same on finer elements), two materials as one where hardly told."""
        kept, finer = self.finer_and_plainer(self.lawful(kept))
        return kept, self.merged(finer)

    def plainer(self, finer: Candidate) -> Candidate:
        """The same without terms that data hardly tell from none."""
        return LawSearch(self.trials, self.steps, self.finds_window and finer.fit.field.count > 1).plainer(finer)

    def law_on_finer_elements(self, kept: Candidate) -> tuple[Candidate, Candidate] | None:
        """(a candidate with a law sought on finer elements, the same there); None where elements are not to blame.

        They may be where no more is left than finer ones change. Terms that pay for that say nothing of the law. What
        elements beside a line miss falls as their size does.
        """
        if kept.fit.field.count == 1 or not kept.leaves_more_than_noise:
            return None
        missed = self._missed_by_elements(kept)
        if kept.level > missed:
            return None
        finer = self.lawful(self.finer(kept))
        finer = of_likelier_volume(self.trials, finer, self.steps, self.finds_window).kept
        if not finer.leaves_more_than_noise or finer.level <= missed / numerics.FINER:
            law = LawSearch(self.trials, self.steps, self.finds_window)
            return law.with_law_of(kept, finer) or kept, finer
        self.trials.passed_over(finer, "leaves more than noise and elements do; coarse elements are asked first")
        return None

    def _missed_by_elements(self, kept: Candidate) -> float:
        """How far finer elements move what is seen of a candidate, over noise (root mean square): what its own miss."""
        problem, field, u = self.trials.on_finer_elements(kept)
        own, finer = (SeenTest(each, self.steps, kept.fit.window) for each in (kept.problem, problem))
        states = finer.states(field, [u[k] for k in self.steps])
        if states is None:
            return 0.0
        seen = [
            np.concatenate(test.of_displacements(test.residuals(found, test.sigma)))
            for test, found in ((own, kept.fit.states), (finer, states))
        ]
        return float(np.sqrt(np.mean((seen[1] - seen[0]) ** 2))) / kept.problem.observations.scatter

    def of_volume_told_finer(self, kept: Candidate, finer: Candidate) -> tuple[Candidate, Candidate]:
        """Both candidates with the volume that finer elements speak for, where coarse ones tell it not."""
        asked = of_likelier_volume(self.trials, finer, self.steps, self.finds_window).kept
        if asked is finer:
            return kept, finer
        return LawSearch(self.trials, self.steps, self.finds_window).with_law_of(kept, asked) or kept, asked

    def likelier_on_finer_elements(self, found: Candidate, kept: Candidate) -> Candidate:
        """The first of two candidates where it is likelier on finer elements too, and the second elsewhere.

        A law may pay for what coarse elements miss.
        """
        finer, other = (self.finer(each) for each in (found, kept))
        gain = finer.gain_over(other)
        best, passed = (found, other) if gain > thresholds.EVIDENCE else (kept, finer)
        self.trials.passed_over(passed, f"scores {abs(gain):+.1f} against the other law on finer elements")
        return best

    def of_whole_cells(self, kept: Candidate) -> Candidate | None:
        """The same materials of whole cells, where lines leave mostly no noise, and these no more than noise."""
        if not kept.leaves_mostly_no_noise:
            return None
        cells = MosaicSearch(self.trials, self.steps).instead_of(kept, kept)
        if not cells.leaves_more_than_noise:
            return cells
        if cells is not kept:
            self.trials.passed_over(cells, "leaves more than noise")
        return None

    def without_change(self, gradual: Candidate, one: Candidate) -> Candidate | None:
        """One material on finer elements, where it explains the test without a gradual change of one."""
        problem, trials, field = gradual.problem, self.trials, gradual.fit.field
        if field.count > 1:
            return None
        plain = Interfaces.homogeneous(Lines.of(problem.observations.grid, problem.refinement), field.materials[0])
        without = trials.descend("without the change", gradual, problem, plain, gradual.u, self.steps, budgets.NEAR)
        if without is not None:
            trials.passed_over(without, f"scores {gradual.gain_over(without):+.1f} against a gradual change")
        # Where the change explains most of what its law alone leaves, no other law is sought.
        if without is None or gradual.halves(without):
            return None
        alone = self.of_one(self.finer(one))
        gain = alone.gain_over(gradual)
        if gain > -thresholds.EVIDENCE or not alone.leaves_more_than_noise:
            why = f"scores {gain:+.1f} against" if gain > -thresholds.EVIDENCE else "is not needed beside"
            trials.passed_over(gradual, f"{why} one material on finer elements")
            return alone
        trials.passed_over(alone, f"scores {-gain:+.1f} against a gradual change")
        return None

    def gradual_instead(self, finer: Candidate, parting: Parting) -> Candidate | None:
        """One material that changes gradually, though it scored less: where few materials alone are refuted.

        What few materials leave is the same in all steps, and no noise. What it leaves is less, and differs.
        """
        if parting.gradual is None or not finer.misses_deformation or len(finer.fit.field.gradual):
            return None
        found = self.finer(self.with_law(parting.gradual))
        if found.misses_deformation or found.fit.misfit > finer.fit.misfit:
            self.trials.passed_over(found, "leaves as much of the deformation as few materials do")
            return None
        self.trials.passed_over(finer, "leaves the same in all steps; a gradual change does not")
        return found
