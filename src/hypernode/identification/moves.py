"""Moves from one candidate to another: elements, law, volume, cells, and whether a change is gradual."""

import dataclasses

from hypernode.identification.candidate import EVIDENCE, Candidate
from hypernode.identification.interfaces import Interfaces, Lines
from hypernode.identification.law_search import LawSearch
from hypernode.identification.merging import merged
from hypernode.identification.mosaic_search import MosaicSearch
from hypernode.identification.parting import Parting
from hypernode.identification.problem import FieldProblem
from hypernode.identification.trials import NEAR, Trials, homogeneous_displacement
from hypernode.identification.volume import of_likelier_volume

#: Side of a window, in points, below which it changes less than points apart do, and is none.
NO_WINDOW = 0.5
#: Distance between points of a line, in sides of cells, where more than noise is left.
CLOSER = 0.5


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
        return self.trials.descend("one material", None, problem, field, u, self.steps, NEAR)

    def with_law(self, kept: Candidate) -> Candidate:
        """The same with the terms of the law that pay."""
        return LawSearch(self.trials, self.steps, self.finds_window).end(kept)

    def merged(self, kept: Candidate) -> Candidate:
        """The same, two materials of which are one where data hardly tell them apart."""
        return merged(self.trials, kept, self.steps, self.finds_window)

    def of_one(self, alone: Candidate) -> Candidate:
        """One material with the likeliest law and volume."""
        return of_likelier_volume(self.trials, self.with_law(alone), self.steps, self.finds_window).kept

    def finer(self, coarse: Candidate) -> Candidate:
        """The same on finer finite elements."""
        trials, window, of_lines = self.trials, coarse.fit.window, coarse.fit.field.count > 1
        if not of_lines and not coarse.leaves_more_than_noise:
            return coarse
        if of_lines:
            self.finds_window = self.finds_window and window > NO_WINDOW
        finds = self.finds_window and of_lines
        begun, window = trials.on_finer_elements(coarse), window if finds else None
        found = trials.descend("finer elements", coarse, *begun, self.steps, NEAR, window, finds)
        if found is None:
            return coarse
        if of_lines and found.misses_deformation:
            closer = found.fit.field.on(dataclasses.replace(found.fit.field.lines, apart=CLOSER))
            begun, window = (found.problem, closer, found.u), found.fit.window
            move = "closer points of lines"
            found = trials.descend(move, found, *begun, self.steps, NEAR, window, finds) or found
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
        kept, finer = self.finer_and_plainer(self.merged(self.with_law(kept)))
        return kept, self.merged(finer)

    def plainer(self, finer: Candidate) -> Candidate:
        """The same without terms that data hardly tell from none."""
        return LawSearch(self.trials, self.steps, self.finds_window and finer.fit.field.count > 1).plainer(finer)

    def law_on_finer_elements(self, kept: Candidate) -> tuple[Candidate, Candidate] | None:
        """(a candidate with a law sought on finer elements, the same there); None where that leaves more than noise.

        Coarse elements that leave little more than noise may leave what they miss themselves. Terms that pay for that
        say nothing of the law.
        """
        if kept.fit.field.count == 1 or not kept.misses_deformation or kept.leaves_mostly_no_noise:
            return None
        finer = self.merged(self.with_law(self.finer(kept)))
        finer = of_likelier_volume(self.trials, finer, self.steps, self.finds_window).kept
        if not finer.leaves_more_than_noise:
            law = LawSearch(self.trials, self.steps, self.finds_window)
            return law.with_law_of(kept, finer) or kept, finer
        self.trials.passed_over(finer, "leaves more than noise; coarse elements are asked first")
        return None

    def of_volume_told_finer(self, kept: Candidate, finer: Candidate) -> tuple[Candidate, Candidate]:
        """Both candidates with the volume that finer elements speak for, where coarse ones tell it not."""
        asked = of_likelier_volume(self.trials, finer, self.steps, self.finds_window).kept
        if asked is finer:
            return kept, finer
        return LawSearch(self.trials, self.steps, self.finds_window).with_law_of(kept, asked) or kept, asked

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
        without = trials.descend("without the change", gradual, problem, plain, gradual.u, self.steps, NEAR)
        if without is not None:
            trials.passed_over(without, f"scores {gradual.gain_over(without):+.1f} against a gradual change")
        # Where the change explains most of what its law alone leaves, no other law is sought.
        if without is None or gradual.halves(without):
            return None
        alone = self.of_one(self.finer(one))
        gain = alone.gain_over(gradual)
        if gain > -EVIDENCE or not alone.leaves_more_than_noise:
            why = f"scores {gain:+.1f} against" if gain > -EVIDENCE else "is not needed beside"
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
