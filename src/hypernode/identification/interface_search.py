"""Which materials and lines a sheet is made of, each step for a stated reason.

One material comes first. What it leaves is put into a factor of the stiffness in every cell. That field, cut into two,
three and four levels, is where materials and lines begin. One more material is kept as long as it explains more of the
test than its numbers cost. Then come the terms of the law that the materials have in common, finer finite elements, and
all load steps.
"""

import dataclasses

import numpy as np
import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.information import information_of
from hypernode.data.measurement import window_uncertainty
from hypernode.identification.candidate import EVIDENCE, MOSTLY_NO_NOISE, NOT_MADE_OF_FEW, Candidate
from hypernode.identification.force_course import check_forces
from hypernode.identification.gradual import BENDS
from hypernode.identification.interface_answer import answer
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interfaces import Interfaces, Lines
from hypernode.identification.law_search import LawSearch, stiffness_of
from hypernode.identification.mosaic import Mosaic
from hypernode.identification.mosaic_search import MosaicSearch
from hypernode.identification.partition import cut_into
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.settings import Strategy
from hypernode.identification.stiffness import StiffnessDescent
from hypernode.identification.trials import Trials, largest_and_half
from hypernode.progress import say

#: Materials at most.
MOST = 4
#: Side of a window that nobody stated, in points, where its search begins: subsets overlap by half. Below the second it
#: changes less than points apart do, and is none.
WINDOW, NO_WINDOW = 1.5, 0.5
#: Rows and columns into which a cell is divided for the answer.
FINER = 2
#: Distance between points of a line, in sides of cells, where more than noise is left.
CLOSER = 0.5
#: Steps of a descent at most: of few materials, of finer elements.
STEPS, FINER_STEPS = 15, 8
#: How often materials are sought again on top of another law.
ROUNDS = 2
#: Difference of the logarithms of stiffness up to which two materials are tried as one.
ALIKE = 0.15


def of_parts(measurement: xr.Dataset, settings: Constrained, name: str, strategy: Strategy) -> InterfaceEstimate | None:
    """The few materials and lines that explain a test; None where they do not, or where they are not sought.

    They are sought where the configuration asks for layers, and the grid has no more cells than are searched at once.
    Grey levels are not searched.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        ImpossibleForcesError: no sheet gives the forces.
    """
    sought = settings.layers and information_of(measurement) is None
    if not sought or measurement.sizes["cell"] > strategy.most_cells_at_once:
        return None
    found = Search(measurement, settings, name, strategy).end()
    if found is None or found.unexplained > 1.0 or found.misfits["displacement"] > MOSTLY_NO_NOISE:
        return None
    return found


class Search:
    """The search on one test."""

    def __init__(self, measurement: xr.Dataset, settings: Constrained, name: str, strategy: Strategy):
        self._trials = Trials(measurement, settings, name, strategy)
        #: What a factor in every cell leaves of the displacements, once one was fitted.
        self._by_cell = np.inf
        stated = float(measurement.attrs["correlation_window"]) > 0.0
        self._finds = not stated and window_uncertainty(measurement) > 0.0

    def end(self) -> InterfaceEstimate | None:
        """The field of few materials; None where a field of cells may explain more."""
        trials = self._trials
        check_forces(lambda *terms: trials.problem(terms), trials.settings, trials.name)
        problem = trials.problem([term for term in trials.settings.terms if term == "J"])
        self._steps = largest_and_half(problem)
        params = problem.homogeneous.params
        u = dict(enumerate(problem.equilibrium.extension(np.tile(params, (len(problem.mesh.cells), 1)))))
        field = Interfaces.homogeneous(Lines.of(problem.observations.grid, problem.refinement), params)
        one = trials.descend("one material", None, problem, field, u, self._steps, FINER_STEPS)
        if one is None:
            return None
        kept = one
        if one.leaves_more_than_noise:
            begun = self._begun(one)
            # Displacements of finite elements on the grid leave nothing between whole cells, unless noise hides it.
            mosaic = self._mosaic(one, begun) if problem.certain else None
            if mosaic is not None and not mosaic.leaves_more_than_noise:
                return self._answer(mosaic)
            kept = self._parts(one, begun)
        if kept is None:
            return None
        kept = self._merged(self._with_law(kept))
        if kept.leaves_more_than_noise and kept.fit.misfit > NOT_MADE_OF_FEW * self._by_cell:
            cells = self._whole_cells(kept, kept)
            if cells is kept or cells.fit.misfit > NOT_MADE_OF_FEW * max(self._by_cell, 1.0):
                say("constrained", trials.name, "few materials leave far more than a factor in every cell")
                return None
            return self._answer(cells)
        finer = self._finer(kept)
        for _ in range(ROUNDS):
            open_ = finer.misses_deformation or finer.leaves_mostly_no_noise
            more = self._parts(kept) if open_ and not len(kept.fit.field.gradual) else kept
            if more is kept:
                break
            kept = self._merged(self._with_law(more))
            finer = self._finer(kept)
        return self._answer(self._whole_cells(kept, finer))

    def _whole_cells(self, kept: Candidate, finer: Candidate) -> Candidate:
        """The same materials of whole cells, if these explain more than lines do; else what lines ended with."""
        if kept.fit.field.count == 1:
            return finer
        trials = self._trials
        found = MosaicSearch(trials, self._steps, MOST).near(kept, "whole cells of these materials")
        if found is None:
            return finer
        gain = found.gain_over(finer)
        best, other, word = (found, finer, "whole cells") if gain > 0.0 else (finer, found, "lines")
        trials.passed_over(other, f"scores {abs(gain):+.1f} against {word}")
        return best

    def _answer(self, kept: Candidate) -> InterfaceEstimate | None:
        if isinstance(kept.fit.field, Mosaic):
            every = list(range(len(kept.problem.observations.u)))
            kept = MosaicSearch(self._trials, every, MOST).near(kept, "all load steps") or kept
        return answer(self._trials, kept, self._finds)

    def _begun(self, found: Candidate):
        """(materials that are known, the factor in every cell beside them, displacements it leads to)."""
        plain = found.problem.homogeneous.params[None]
        known = found.fit.field.with_law(plain) if found.start is None else found.fit.field
        return known, *self._factor_of_cells(found, known)

    def _mosaic(self, one: Candidate, begun) -> Candidate | None:
        """The likeliest few materials of whole cells; None where the sheet is not made of them."""
        known, stiffness, u = begun
        if stiffness is None:
            return None
        return MosaicSearch(self._trials, self._steps, MOST).end(one, known, stiffness.factor, u, stiffness.misfit)

    def _parts(self, found: Candidate, begun=None) -> Candidate | None:
        """As many materials, or more, as explain more than they cost; None without equilibrium.

        Where they are is told by what a factor of the stiffness in every cell explains, on top of what is known.

        Args:
            begun: of :meth:`_begun`, where that is known.
        """
        trials, problem, first = self._trials, found.problem, found.fit.field.count == 1
        known, stiffness, u = begun or self._begun(found)
        if stiffness is None:
            return None if first else found
        begun = found
        level = stiffness_of(problem, known.materials)
        kept, window = begun, WINDOW if self._finds and first else begun.fit.window
        # On top of another law, as many materials may lie elsewhere.
        for count in range(known.count + first, MOST + 1):
            field = cut_into(level[known.labels()] + stiffness.factor, count, known, level)
            if field.count < count:
                break
            move = f"{count} materials and lines"
            found = trials.descend(
                move, begun, problem, field, u, self._steps, STEPS, window, self._finds, settled=False
            )
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
        return self._merged(kept)

    def _gradual(self, begun: Candidate, known: Interfaces, factor, u, kept: Candidate) -> Candidate:
        """One material that changes gradually, where few materials explain the test no better.

        A change that bends less is of fewer numbers. It is tried as long as what they cost may decide.
        """
        trials, best = self._trials, None
        for bend in BENDS:
            move, field = f"a gradual change, bends of {bend:g}", known.changing(factor, bend)
            found = trials.descend(move, begun, begun.problem, field, u, self._steps, STEPS)
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

    def _factor_of_cells(self, begun: Candidate, known: Interfaces):
        """(the factor in every cell beside what is known, None without equilibrium; displacements it leads to)."""
        trials, loading = self._trials, begun.problem.observations.loading
        last = [k for k in self._steps if loading.t[k] == loading.t[loading.load_case == loading.load_case[k]].max()]
        window = begun.fit.window if self._finds else None
        descent = StiffnessDescent(SeenTest(begun.problem, last, window), known, trials.settings.regulariser_weight)
        stiffness = descent.end([begun.u[k] for k in last])
        if stiffness is None:
            return None, begun.u
        say("constrained", trials.name, f"a factor of the stiffness in every cell: missed by {stiffness.misfit:.3g}")
        self._by_cell = min(self._by_cell, stiffness.misfit)
        return stiffness, {**begun.u, **{k: state[0] for k, state in zip(last, stiffness.states, strict=True)}}

    def _with_law(self, kept: Candidate) -> Candidate:
        return LawSearch(self._trials, self._steps, self._finds).end(kept)

    def _merged(self, kept: Candidate) -> Candidate:
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
                move, kept, kept.problem, field, kept.u, self._steps, FINER_STEPS, window, self._finds, settled=False
            )
            if found is None or kept.gain_over(found) > EVIDENCE:
                if found is not None:
                    trials.passed_over(found, f"scores {kept.gain_over(found):+.1f} against two")
                break
            trials.passed_over(kept, f"scores {kept.gain_over(found):+.1f} against one material less")
            kept = found
        return kept

    def _finer(self, coarse: Candidate) -> Candidate:
        """The same on finer finite elements."""
        if coarse.fit.field.count == 1:
            return coarse
        trials, window = self._trials, coarse.fit.window
        self._finds = self._finds and window > NO_WINDOW
        problem = trials.problem(coarse.terms, FINER)
        field = coarse.fit.field.on(Lines.of(problem.observations.grid, problem.refinement, coarse.fit.field.lines))
        u = {k: problem.refinement.interpolation @ each for k, each in coarse.u.items()}
        move, window = "finer elements", window if self._finds else None
        found = trials.descend(move, coarse, problem, field, u, self._steps, FINER_STEPS, window, self._finds)
        if found is None:
            return coarse
        if found.misses_deformation:
            closer = found.fit.field.on(dataclasses.replace(found.fit.field.lines, apart=CLOSER))
            move, window = "closer points of lines", found.fit.window
            found = (
                trials.descend(move, found, problem, closer, found.u, self._steps, FINER_STEPS, window, self._finds)
                or found
            )
        return found
