"""Which materials and lines a sheet is made of, each step for a stated reason.

One material comes first. What it leaves is put into a factor of the stiffness in every cell. That field, cut into two,
three and four levels, is where materials and lines begin. One more material is kept as long as it explains more of the
test than its numbers cost. Then come the terms of the law that the materials have in common, finer finite elements, and
all load steps.
"""

import functools
from collections.abc import Iterator

import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.coarsening import coarsened
from hypernode.data.information import information_of
from hypernode.data.measurement import window_sought
from hypernode.identification import budgets, thresholds
from hypernode.identification.beside import Beside
from hypernode.identification.candidate import Candidate
from hypernode.identification.common_trend import with_common_trend
from hypernode.identification.finer_grid import on_measured_grid
from hypernode.identification.force_course import check_forces, unless_impossible
from hypernode.identification.interface_answer import answer
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.missing import with_what_is_missing
from hypernode.identification.mosaic import Mosaic
from hypernode.identification.mosaic_search import MosaicSearch
from hypernode.identification.moves import Moves
from hypernode.identification.parting import Parting
from hypernode.identification.small_steps import from_smallest, of_likeliest_cut
from hypernode.identification.trials import Trials, largest_and_half
from hypernode.identification.volume import of_likelier_volume, with_area
from hypernode.progress import say


class Search:
    """The search on one test.

    Args:
        coarse: whether the grid is coarser than the measured one, whose elements are the finer ones.

    Attributes:
        keeps_volume: of :class:`~hypernode.identification.volume.Parts`.
    """

    def __init__(self, measurement: xr.Dataset, settings: Constrained, name: str, *, coarse: bool = False):
        self.keeps_volume, self._coarse = False, coarse
        trials = self._trials = Trials(measurement, settings, name)
        self._finds = information_of(measurement) is None and window_sought(measurement)
        problem = self._problem = trials.plainest()
        self._moves = Moves(trials, largest_and_half(problem), self._finds)
        self._parting = Parting(trials, self._moves.steps, self._moves.finds_window)

    def end(self) -> InterfaceEstimate | None:
        """The field of few materials; None where a field of cells may explain more."""
        found = self.found()
        return None if found is None else self._answer(MosaicSearch(self._trials, self._moves.steps).instead_of(*found))

    def found(self) -> tuple[Candidate, Candidate] | None:
        """(candidate that few load steps speak for, the same on finer elements); None where cells may explain more."""
        trials, moves, parting = self._trials, self._moves, self._parting
        if self._many_cells:
            return self._from_coarser_grid()
        kept = one = self._one
        if one is None:
            return None
        if one.leaves_more_than_noise:
            # Beside clamps coarse elements miss more than a good camera does, but not far more.
            alone = moves.finer(one) if one.level < thresholds.FAR_FROM_NOISE else None
            if alone is not None and not alone.leaves_more_than_noise:
                alone = moves.of_one(alone)
                return alone, alone
            beside = self._beside
            if mosaic := self._mosaic(one, beside):
                return mosaic, mosaic
            kept = self._parted(one, beside, parting)
        if kept is None:
            return None
        if both := moves.law_on_finer_elements(kept):
            return both
        kept = of_likeliest_cut(moves, moves.turned(moves.lawful(kept)), self._others)
        if cells := moves.of_whole_cells(kept):
            return cells, cells
        asked, more = kept, kept if kept.fit.field.count == 1 else with_what_is_missing(parting, one, beside, kept)
        if more is not kept:
            kept = moves.lawful(more)
        before, volume = kept, of_likelier_volume(trials, kept, moves.steps, moves.finds_window)
        kept, self.keeps_volume = volume.kept, volume.far
        if kept is not before and kept.leaves_mostly_no_noise:
            kept = kept if self._coarse else moves.likelier_on_finer_elements(kept, before)
            if kept is not before and (again := self._again_with_volume(kept)):
                return again
        if self._coarse:
            return kept, kept
        kept, finer = moves.finer_and_plainer(kept)
        finer = moves.merged(finer)
        if volume.open and finer is not kept:
            kept, finer = moves.of_volume_told_finer(kept, finer)
        if finer.leaves_mostly_no_noise and finer.fit.field.count > 1:
            common = with_common_trend(parting, one, beside, kept)
            if common is not kept:
                kept, finer = moves.with_law_and_finer(common)
        elif len(kept.fit.field.gradual) and (alone := moves.without_change(finer, one)):
            return alone, alone
        if finer.leaves_more_than_noise and finer.fit.misfit > thresholds.NOT_MADE_OF_FEW * parting.by_cell:
            cells = MosaicSearch(trials, moves.steps).instead_of(kept, finer)
            if cells is finer or cells.fit.misfit > thresholds.NOT_MADE_OF_FEW * max(parting.by_cell, 1.0):
                say("constrained", trials.name, "few materials leave far more than a factor in every cell")
                return None
            return cells, cells
        if gradual := moves.gradual_instead(finer, parting):
            return gradual, gradual
        return self._parted_again(kept, finer, parting, {one, asked} if asked.leaves_mostly_no_noise else {one})

    @functools.cached_property
    def _one(self) -> Candidate | None:
        """The homogeneous sheet; None without equilibrium.

        Raises:
            ImpossibleForcesError: no sheet gives the forces.
        """
        trials = self._trials
        check_forces(lambda *terms: trials.problem(terms), trials.settings, trials.name)
        return self._moves.one_material(self._problem)

    @functools.cached_property
    def _beside(self) -> Beside | None:
        """The factor of the stiffness in every cell, or of a coarser grid; None without one material."""
        if self._many_cells:
            return self._coarser._beside
        return None if self._one is None else self._parting.in_cells(self._parting.beside(self._one))

    @property
    def _many_cells(self) -> bool:
        return len(self._problem.mesh.cells) > budgets.MOST_CELLS_AT_ONCE

    @functools.cached_property
    def _coarser(self) -> "Search":
        """The search on every second line of the grid."""
        trials = self._trials
        coarse = coarsened(trials.measurement)
        say("constrained", trials.name, f"{coarse.sizes['cell']} cells of every second grid line first")
        return Search(coarse, trials.settings, trials.name, coarse=True)

    def _mosaic(self, one: Candidate, beside: Beside | None) -> Candidate | None:
        """Whole cells of a few materials, where these leave nothing; None where they leave more.

        Displacements of finite elements on the grid leave nothing between whole cells. Noise hides that, and so do a
        window and coarser cells.
        """
        if self._coarse or not self._exact or beside is None:
            return None
        coarser = self._contours if self._many_cells else None
        mosaic = MosaicSearch(self._trials, self._moves.steps).end(one, beside, coarser)
        return None if mosaic is None or mosaic.leaves_more_than_noise else mosaic

    def _contours(self, count: int) -> Candidate | None:
        """Whole cells of so many materials on every second line of the grid, from coarser grids on."""
        search = self._coarser
        if search._one is None:
            return None
        cells, coarser = MosaicSearch(search._trials, search._moves.steps), search._many_cells
        return cells.contours(search._one, search._beside, count, search._contours if coarser else None)

    @property
    def _exact(self) -> bool:
        """Whether displacements are seen without noise, each at its point."""
        return not (self._problem.noisy or self._problem.observations.window > 0.0)

    def _again_with_volume(self, kept: Candidate) -> tuple[Candidate, Candidate] | None:
        """Materials sought from nothing with a law that says otherwise of the volume; None where they leave more.

        Args:
            kept: such a law between materials that were cut under the other volume.
        """
        trials = self._trials
        say("constrained", trials.name, "materials are sought again with a law that says otherwise of the volume")
        settings = with_area(trials.settings, "fibre" in kept.terms)
        search = Search(trials.measurement, settings, trials.name, coarse=self._coarse)
        found = unless_impossible(search.found)
        if found is None or found[1].fit.misfit > kept.fit.misfit:
            trials.after(search._trials)
            if found is not None:
                trials.passed_over(found[1], "leaves more than materials that were cut under the other volume")
            return None
        search._trials.after(trials)
        search._trials.passed_over(kept, "materials are sought again with a law that says otherwise of the volume")
        self._trials, self._moves = search._trials, search._moves
        return found

    def _parted_again(self, kept: Candidate, finer: Candidate, parting: Parting, asked: set[Candidate]):
        """Both candidates, or those of other materials on top of them where they leave more than noise.

        Args:
            asked: candidates on top of which nothing was found.
        """
        for _ in range(budgets.SEARCH_ROUNDS):
            # Where residuals differ from step to step, as many materials may lie elsewhere.
            open_ = finer.misses_deformation or finer.leaves_mostly_no_noise
            most = budgets.MOST_MATERIALS if open_ else kept.fit.field.count
            again = finer.leaves_more_than_noise and kept not in asked and not len(kept.fit.field.gradual)
            more = parting.parted(kept, most=most) if again else kept
            if more is kept:
                break
            kept, finer = self._moves.with_law_and_finer(more)
        return kept, finer

    def _parted(self, one: Candidate, beside: Beside, parting: Parting) -> Candidate | None:
        """Materials from the largest load steps, or from the smallest where law and direction matter in the largest.

        They do where a factor in every cell leaves more than noise of the largest steps.
        """
        if beside.found is None or beside.found.misfit < thresholds.MOSTLY_NO_NOISE:
            return parting.parted(one, beside)
        return next(self._others, None) or parting.parted(one, beside)

    @functools.cached_property
    def _others(self) -> Iterator[Candidate]:
        """Materials that the smallest load steps tell, which are asked once."""
        return from_smallest(self._parting, self._one)

    def _from_coarser_grid(self) -> tuple[Candidate, Candidate] | None:
        """What every second line of a grid of many cells tells, on the whole grid."""
        trials, search = self._trials, self._coarser
        if not self._coarse and self._exact and self._one is not None and self._one.leaves_more_than_noise:
            if mosaic := self._mosaic(self._one, self._beside):
                return mosaic, mosaic
            trials.passed_over(self._one, "a coarser grid is asked first")
        found, self.keeps_volume = search.found(), search.keeps_volume
        if found is None:
            return None
        trials.after(search._trials)
        fine = on_measured_grid(trials, found[1], self._moves.steps, self._finds)
        if fine is None:
            return None
        fine = self._moves.merged(self._moves.plainer(fine))
        return fine, fine

    def _answer(self, kept: Candidate) -> InterfaceEstimate | None:
        if isinstance(kept.fit.field, Mosaic):
            every = list(range(len(kept.problem.observations.u)))
            kept = MosaicSearch(self._trials, every).near(kept, "all load steps") or kept
        return answer(self._trials, kept, self._moves.finds_window)
