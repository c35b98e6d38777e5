"""Which materials and lines a sheet is made of, each step for a stated reason.

One material comes first. What it leaves is put into a factor of the stiffness in every cell. That field, cut into two,
three and four levels, is where materials and lines begin. One more material is kept as long as it explains more of the
test than its numbers cost. Then come the terms of the law that the materials have in common, finer finite elements, and
all load steps.
"""

import dataclasses

import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.coarsening import coarsened
from hypernode.data.information import information_of
from hypernode.data.measurement import window_sought
from hypernode.identification.bent_edges import with_bent_edges
from hypernode.identification.beside import Beside
from hypernode.identification.candidate import EVIDENCE, MOSTLY_NO_NOISE, NOT_MADE_OF_FEW, Candidate
from hypernode.identification.common_trend import with_common_trend
from hypernode.identification.finer_grid import on_measured_grid
from hypernode.identification.force_course import check_forces
from hypernode.identification.interface_answer import answer
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interfaces import Interfaces, Lines
from hypernode.identification.law_search import LawSearch
from hypernode.identification.merging import merged
from hypernode.identification.missing import with_what_is_missing
from hypernode.identification.mosaic import Mosaic
from hypernode.identification.mosaic_search import MosaicSearch
from hypernode.identification.parting import FAR_FROM_NOISE, Parting
from hypernode.identification.problem import FieldProblem
from hypernode.identification.settings import Strategy
from hypernode.identification.small_steps import from_smallest
from hypernode.identification.trials import NEAR, Trials, homogeneous_displacement, largest_and_half
from hypernode.identification.volume import of_likelier_volume
from hypernode.progress import say

#: Side of a window, in points, below which it changes less than points apart do, and is none.
NO_WINDOW = 0.5
#: Distance between points of a line, in sides of cells, where more than noise is left.
CLOSER = 0.5
#: How often materials are sought again on top of another law.
ROUNDS = 2


class Search:
    """The search on one test.

    Attributes:
        keeps_volume: of :class:`~hypernode.identification.volume.Parts`.
    """

    def __init__(self, measurement: xr.Dataset, settings: Constrained, name: str, strategy: Strategy):
        self.keeps_volume = False
        self._trials = Trials(measurement, settings, name, strategy)
        self._finds = information_of(measurement) is None and window_sought(measurement)

    def end(self) -> InterfaceEstimate | None:
        """The field of few materials; None where a field of cells may explain more."""
        found = self.found()
        return None if found is None else self._answer(MosaicSearch(self._trials, self._steps).instead_of(*found))

    def found(self) -> tuple[Candidate, Candidate] | None:
        """(candidate that few load steps speak for, the same on finer elements); None where cells may explain more."""
        trials = self._trials
        problem = trials.plainest()
        self._steps = largest_and_half(problem)
        if len(problem.mesh.cells) > trials.strategy.most_cells_at_once:
            return self._from_coarser_grid()
        check_forces(lambda *terms: trials.problem(terms), trials.settings, trials.name)
        one = self._one_material(problem)
        if one is None:
            return None
        kept, parting = one, Parting(trials, self._steps, self._finds)
        if one.leaves_more_than_noise:
            # Beside clamps coarse elements miss more than a good camera does, but not far more.
            alone = self._finer(one) if one.level < FAR_FROM_NOISE else None
            if alone is not None and not alone.leaves_more_than_noise:
                alone = self._of_one(alone)
                return alone, alone
            beside = parting.in_cells(parting.beside(one))
            # Displacements of finite elements on the grid leave nothing between whole cells. Noise hides that, and so
            # does a window.
            hidden = problem.noisy or problem.observations.window > 0.0
            mosaic = None if hidden else MosaicSearch(trials, self._steps).end(one, beside)
            if mosaic is not None and not mosaic.leaves_more_than_noise:
                return mosaic, mosaic
            kept = self._parted(one, beside, parting)
        if kept is None:
            return None
        kept = self._merged(self._with_law(kept))
        if cells := self._of_whole_cells(kept):
            return cells, cells
        asked, more = kept, kept if kept.fit.field.count == 1 else with_what_is_missing(parting, one, beside, kept)
        if more is not kept:
            kept = self._merged(self._with_law(more))
        before, (kept, self.keeps_volume) = kept, of_likelier_volume(trials, kept, self._steps, self._finds)
        if kept is not before and kept.leaves_mostly_no_noise:
            say("constrained", trials.name, "materials are sought again with a law that says otherwise of the volume")
            return None
        kept, finer = with_bent_edges(trials, *self._finer_and_plainer(kept), self._steps, self._finds)
        finer = self._merged(finer)
        if finer.leaves_mostly_no_noise and finer.fit.field.count > 1:
            common = with_common_trend(parting, one, beside, kept)
            if common is not kept:
                kept, finer = self._finer_and_plainer(self._merged(self._with_law(common)))
        elif len(kept.fit.field.gradual) and (alone := self._without_change(finer, one)):
            return alone, alone
        if finer.leaves_more_than_noise and finer.fit.misfit > NOT_MADE_OF_FEW * parting.by_cell:
            cells = MosaicSearch(trials, self._steps).instead_of(kept, finer)
            if cells is finer or cells.fit.misfit > NOT_MADE_OF_FEW * max(parting.by_cell, 1.0):
                say("constrained", trials.name, "few materials leave far more than a factor in every cell")
                return None
            return cells, cells
        if gradual := self._gradual_instead(finer, parting):
            return gradual, gradual
        return self._parted_again(kept, finer, parting, {one, asked} if asked.leaves_mostly_no_noise else {one})

    def _parted_again(self, kept: Candidate, finer: Candidate, parting: Parting, asked: set[Candidate]):
        """Both candidates, or those of other materials on top of them where they leave more than noise.

        Args:
            asked: candidates on top of which nothing was found.
        """
        for _ in range(ROUNDS):
            open_ = finer.misses_deformation or finer.leaves_mostly_no_noise
            again = open_ and kept not in asked and not len(kept.fit.field.gradual)
            more = parting.parted(kept) if again else kept
            if more is kept:
                break
            kept, finer = self._finer_and_plainer(self._merged(self._with_law(more)))
        return kept, finer

    def _of_whole_cells(self, kept: Candidate) -> Candidate | None:
        """The same materials of whole cells, where lines leave mostly no noise, and these no more than noise."""
        if not kept.leaves_mostly_no_noise:
            return None
        cells = MosaicSearch(self._trials, self._steps).instead_of(kept, kept)
        if not cells.leaves_more_than_noise:
            return cells
        if cells is not kept:
            self._trials.passed_over(cells, "leaves more than noise")
        return None

    def _without_change(self, gradual: Candidate, one: Candidate) -> Candidate | None:
        """One material on finer elements, where it explains the test without a gradual change."""
        problem, trials, (material,) = gradual.problem, self._trials, gradual.fit.field.materials
        plain = Interfaces.homogeneous(Lines.of(problem.observations.grid, problem.refinement), material)
        without = trials.descend("without the change", gradual, problem, plain, gradual.u, self._steps, NEAR)
        if without is not None:
            trials.passed_over(without, f"scores {gradual.gain_over(without):+.1f} against a gradual change")
        # Where the change explains most of what its law alone leaves, no other law is sought.
        if without is None or gradual.halves(without):
            return None
        alone = self._of_one(self._finer(one))
        gain = alone.gain_over(gradual)
        if gain > -EVIDENCE or not alone.leaves_more_than_noise:
            why = f"scores {gain:+.1f} against" if gain > -EVIDENCE else "is not needed beside"
            trials.passed_over(gradual, f"{why} one material on finer elements")
            return alone
        trials.passed_over(alone, f"scores {-gain:+.1f} against a gradual change")
        return None

    def _gradual_instead(self, finer: Candidate, parting: Parting) -> Candidate | None:
        """One material that changes gradually, though it scored less: where few materials alone are refuted.

        What few materials leave is the same in all steps, and no noise. What it leaves is less, and differs.
        """
        if parting.gradual is None or not finer.misses_deformation or len(finer.fit.field.gradual):
            return None
        found = self._finer(self._with_law(parting.gradual))
        if found.misses_deformation or found.fit.misfit > finer.fit.misfit:
            self._trials.passed_over(found, "leaves as much of the deformation as few materials do")
            return None
        self._trials.passed_over(finer, "leaves the same in all steps; a gradual change does not")
        return found

    def _one_material(self, problem: FieldProblem) -> Candidate | None:
        lines, u = Lines.of(problem.observations.grid, problem.refinement), homogeneous_displacement(problem)
        field = Interfaces.homogeneous(lines, problem.homogeneous.params)
        return self._trials.descend("one material", None, problem, field, u, self._steps, NEAR)

    def _finer_and_plainer(self, kept: Candidate) -> tuple[Candidate, Candidate]:
        """(a candidate, the same on finer elements), without terms that paid for what coarse elements miss."""
        finer = self._finer(kept)
        law = LawSearch(self._trials, self._steps, self._finds and finer.fit.field.count > 1)
        if finer is kept or not (kept.misses_deformation or law.doubts(finer)):
            return kept, finer
        plainer = law.plainer(finer)
        if plainer is not finer:
            kept = law.with_law_of(kept, plainer) or kept
        return kept, plainer

    def _of_one(self, alone: Candidate) -> Candidate:
        """One material with the likeliest law and volume."""
        return of_likelier_volume(self._trials, self._with_law(alone), self._steps, self._finds)[0]

    def _parted(self, one: Candidate, beside: Beside, parting: Parting) -> Candidate | None:
        """Materials from the largest load steps, or from the smallest where law and direction matter in the largest.

        They do where a factor in every cell leaves more than noise of the largest steps.
        """
        if beside.found is None or beside.found.misfit < MOSTLY_NO_NOISE:
            return parting.parted(one, beside)
        return from_smallest(parting, one) or parting.parted(one, beside)

    def _from_coarser_grid(self) -> tuple[Candidate, Candidate] | None:
        """What every second line of a grid of many cells tells, on the whole grid."""
        trials = self._trials
        coarse = coarsened(trials.measurement)
        say("constrained", trials.name, f"{coarse.sizes['cell']} cells of every second grid line first")
        search = Search(coarse, trials.settings, trials.name, trials.strategy)
        found, self.keeps_volume = search.found(), search.keeps_volume
        if found is None:
            return None
        trials.after(search._trials)
        fine = on_measured_grid(trials, found[1], self._steps, self._finds)
        return None if fine is None else (fine, fine)

    def _answer(self, kept: Candidate) -> InterfaceEstimate | None:
        if isinstance(kept.fit.field, Mosaic):
            every = list(range(len(kept.problem.observations.u)))
            kept = MosaicSearch(self._trials, every).near(kept, "all load steps") or kept
        return answer(self._trials, kept, self._finds)

    def _merged(self, kept: Candidate) -> Candidate:
        return merged(self._trials, kept, self._steps, self._finds)

    def _with_law(self, kept: Candidate) -> Candidate:
        return LawSearch(self._trials, self._steps, self._finds).end(kept)

    def _finer(self, coarse: Candidate) -> Candidate:
        """The same on finer finite elements."""
        trials, window, of_lines = self._trials, coarse.fit.window, coarse.fit.field.count > 1
        if not of_lines and not coarse.leaves_more_than_noise:
            return coarse
        if of_lines:
            self._finds = self._finds and window > NO_WINDOW
        finds = self._finds and of_lines
        begun, window = trials.on_finer_elements(coarse), window if finds else None
        found = trials.descend("finer elements", coarse, *begun, self._steps, NEAR, window, finds)
        if found is None:
            return coarse
        if of_lines and found.misses_deformation:
            closer = found.fit.field.on(dataclasses.replace(found.fit.field.lines, apart=CLOSER))
            begun, window = (found.problem, closer, found.u), found.fit.window
            move = "closer points of lines"
            found = trials.descend(move, found, *begun, self._steps, NEAR, window, finds) or found
        return found
