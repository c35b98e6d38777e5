"""Which materials and lines a sheet is made of, each step for a stated reason.

One material comes first. What it leaves is put into a factor of the stiffness in every cell; that field, cut into two,
three and four levels, is where materials and lines begin. One more material is kept as long as it explains more of the
test than its numbers cost. Then come finer finite elements, and the law that the materials have in common.
"""

import dataclasses

import numpy as np
import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.believed_noise import BelievedNoise
from hypernode.data.believed_window import BelievedWindow
from hypernode.data.information import information_of
from hypernode.data.measurement import is_on_its_own_grid, window_uncertainty
from hypernode.identification.equilibrium import State
from hypernode.identification.force_course import check_forces
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interface_fit import Fit, InterfaceFit
from hypernode.identification.interface_noise import Left
from hypernode.identification.interfaces import Interfaces, Lines
from hypernode.identification.objective import Objective
from hypernode.identification.partition import cut_into
from hypernode.identification.problem import FieldProblem, field_problem
from hypernode.identification.regulariser import JumpCost
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.settings import Strategy
from hypernode.identification.stiffness import StiffnessDescent
from hypernode.progress import say
from hypernode.trace import Score, Trace, Trial

#: Materials at most.
MOST = 4
#: Side of a window that nobody stated, in points, where its search begins: subsets overlap by half.
WINDOW = 1.5
#: Rows and columns into which a cell is divided for the answer.
FINER = 2
#: Steps of a descent at most: of coarse elements, of finer ones, of a law alone, of all load steps.
STEPS, FINER_STEPS, LAW_STEPS, LAST_STEPS = 15, 8, 6, 2
#: Terms that say more of another one.
BELONGS = {"across": "fibre", "stiffening": "fibre", "I1_stiffening": "I1_squared"}
#: Gain of a score from which one more material or term is kept: odds of 20 to 1.
EVIDENCE = 3.0
#: Correlation of what different steps leave, up to which it is noise: the reference picture's is a half.
NOISE_SHARED = 0.6
#: Ratio of noise to what was believed beyond which it is told anew.
NOISE_KNOWN = 1.1


@dataclasses.dataclass(frozen=True)
class Candidate:
    """A fit and its place in the search.

    Attributes:
        move: what was tried.
        problem: with which law, on which finite elements.
        fit: where the descent ended.
    """

    move: str
    problem: FieldProblem
    fit: Fit

    @property
    def left(self) -> Left:
        """What displacements leave."""
        return self.fit.left

    @property
    def window(self) -> float:
        """Side of the window through which it was seen, in points."""
        return self.fit.window

    def score(self, independent: float) -> Score:
        """Parts of the score, where residuals of displacements are worth so many independent numbers."""
        fit, terms = self.fit, len(self.problem.basis.names)
        lines, places = len(fit.field.distances), np.log(len(fit.field.lines.grid.mesh.cells))
        return Score(
            displacements=independent * float(np.log(fit.misfit)),
            forces=0.5 * fit.force_squared,
            prior=fit.prior,
            noise=0.0,
            terms=0.5 * terms * float(np.log(max(independent, 2.0))),
            determined=fit.determined,
            places=lines * float(places),
        )


class Search:
    """The search on one test.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: of the case, for progress.
    """

    def __init__(self, measurement: xr.Dataset, settings: Constrained, name: str, strategy: Strategy):
        self._measurement, self._settings, self._name, self._strategy = measurement, settings, name, strategy
        self._problems: dict = {}
        self._tried: list[tuple[Candidate, str]] = []

    def end(self) -> InterfaceEstimate | None:
        """The field of few materials that explains the test; None where a field of cells may explain more."""
        check_forces(lambda *terms: self._problem(terms), self._settings, self._name)
        problem = self._problem(self._first)
        steps = self._steps(problem)
        one = self._one(problem, steps)
        if one is None:
            return None
        kept = one
        if self._leaves(one):
            kept = self._parts(one, steps)
        if kept is None:
            return None
        kept = self._finer(self._law(kept, steps), steps)
        return self._answer(kept)

    # The test with other laws and other finite elements.

    def _problem(self, terms, subcells: int = 1, floor: float | None = None) -> FieldProblem:
        key = tuple(terms), subcells, floor
        if key not in self._problems:
            settings = self._settings.model_copy(update={"terms": list(terms)})
            least = self._strategy.same_grid_floor * float(np.nanmax(np.abs(self._measurement["u_measured"].values)))
            self._problems[key] = field_problem(
                self._measurement, settings, subcells, self._strategy, max(floor or 0.0, least)
            )
        return self._problems[key]

    def _other(self, measurement: xr.Dataset) -> None:
        """Go on with another noise or window."""
        self._measurement = measurement
        self._problems.clear()

    @property
    def _first(self) -> tuple[str, ...]:
        return tuple(term for term in self._settings.terms if term == "J")

    @property
    def _unstated(self) -> bool:
        """Whether a window may be there that nobody stated."""
        stated = float(self._measurement.attrs["correlation_window"]) > 0.0
        return not stated and window_uncertainty(self._measurement) > 0.0

    def _steps(self, problem: FieldProblem) -> list[int]:
        """Two load steps of every load case: the largest, and one about half as large."""
        loading, found = problem.observations.loading, set()
        for case in np.unique(loading.load_case):
            own = np.flatnonzero(loading.load_case == case)
            largest = own[np.argmax(loading.t[own])]
            found |= {int(largest), int(own[np.argmin(np.abs(loading.t[own] - 0.5 * loading.t[largest]))])}
        return sorted(found)

    def _candidate(
        self,
        move: str,
        problem: FieldProblem,
        steps,
        field: Interfaces,
        guesses,
        iterations: int,
        window=None,
        **moving,
    ) -> Candidate | None:
        """The end of a descent, None without equilibrium; ``guesses`` by step then are its displacements."""
        lines = moving.get("move_lines", True) and len(field.distances) > 0
        find = self._finds and lines
        fit = InterfaceFit(SeenTest(problem, steps, window), find, **moving).descend(
            field, [guesses[k] for k in steps], iterations
        )
        if fit is None:
            say("constrained", self._name, f"{move}: no equilibrium")
            return None
        guesses.update({k: u for k, (u, _, _) in zip(steps, fit.states, strict=True)})
        say(
            "constrained",
            self._name,
            f"{move} ({', '.join(problem.basis.terms) or 'neo-Hookean'}): displacements missed by {fit.misfit:.3g}, "
            f"forces by {fit.forces:.3g} of their noise, {fit.determined:.0f} numbers"
            + (f", window of {fit.window:.2f} points" if find else ""),
        )
        found = Candidate(move, problem, fit)
        self._tried.append((found, ""))
        return found

    @staticmethod
    def _spacing(problem) -> float:
        return float(np.median(np.diff(problem.observations.grid.lines[0])))

    # The moves.

    def _one(self, problem: FieldProblem, steps) -> Candidate | None:
        self._finds = self._unstated
        params = problem.homogeneous.params
        everywhere = np.tile(params, (len(problem.mesh.cells), 1))
        self._guesses = dict(enumerate(problem.equilibrium.extension(everywhere)))
        lines = Lines.of(problem.observations.grid, problem.refinement)
        field = Interfaces.homogeneous(lines, params)
        return self._candidate("one material", problem, steps, field, self._guesses, FINER_STEPS)

    def _leaves(self, candidate: Candidate) -> bool:
        """Whether displacements leave more than their noise by chance."""
        scatter = candidate.problem.observations.scatter
        uncertain = candidate.problem.observations.noise_uncertainty
        return candidate.left.level / scatter > 1.0 + 3.0 * uncertain

    def _parts(self, one: Candidate, steps) -> Candidate | None:
        """As many materials as explain more than they cost; None where a free field explains far more than these."""
        problem = one.problem
        loading = problem.observations.loading
        last = [k for k in steps if loading.t[k] == loading.t[loading.load_case == loading.load_case[k]].max()]
        field = one.fit.field.with_law(problem.homogeneous.params[None])
        begun = StiffnessDescent(SeenTest(problem, last), field, self._settings.regulariser_weight)
        stiffness = begun.end([self._guesses[k] for k in last])
        if stiffness is None:
            return None
        say("constrained", self._name, f"a factor of the stiffness in every cell: missed by {stiffness.misfit:.3g}")
        for k, state in zip(last, stiffness.states, strict=True):
            self._guesses[k] = state[0]
        kept, guesses = one, self._guesses
        for count in range(2, MOST + 1):
            field = cut_into(stiffness.factor, count, one.fit.field.lines, problem.homogeneous.params)
            if field.count < count:
                break
            mine = dict(guesses)
            window = WINDOW if self._finds else None
            found = self._candidate(f"{count} materials and lines", problem, steps, field, mine, STEPS, window)
            if found is None:
                continue
            independent = found.left.independent
            gain = kept.score(independent).total - found.score(independent).total
            if gain <= EVIDENCE:
                self._against(found, f"scores {-gain:+.1f} against {kept.fit.field.count} materials")
                break
            self._against(kept, f"scores {gain:+.1f} against {count} materials")
            kept, self._guesses = found, mine
            if not self._leaves(kept):
                break
        if kept.fit.misfit > 1.0 and stiffness.misfit * 3.0 < kept.fit.misfit:
            say("constrained", self._name, "few materials do not explain what a factor in every cell does")
            return None
        return kept

    def _finer(self, coarse: Candidate, steps) -> Candidate:
        """The same on finer finite elements."""
        if len(coarse.fit.field.distances) == 0:
            return coarse
        if self._finds and coarse.window > 0.5:
            side = coarse.window * self._spacing(coarse.problem)
            self._other(BelievedWindow(side, 0.1 * side).of(self._measurement))
        elif self._finds:
            self._finds = False
        problem = self._problem(coarse.problem.basis.terms, FINER)
        field = coarse.fit.field.on(Lines.of(problem.observations.grid, problem.refinement))
        interpolation = problem.refinement.interpolation
        guesses = {k: interpolation @ u for k, u in self._guesses.items()}
        window = coarse.window if self._finds else None
        found = self._candidate("finer elements", problem, steps, field, guesses, FINER_STEPS, window)
        if found is None:
            return coarse
        self._guesses = guesses
        return found

    def _law(self, kept: Candidate, steps) -> Candidate:
        """Terms of the law, one after the other as long as one explains more than it costs; lines stay meanwhile."""
        while True:
            tried = [each for each in (self._with(kept, term, steps) for term in self._open(kept)) if each is not None]
            if not tried:
                return kept
            best, guesses = min(tried, key=lambda each: each[0].score(kept.left.independent).total)
            for other, _ in tried:
                if other is not best:
                    self._against(other, f"another term gains more: {best.problem.basis.terms[-1]}")
            gain = kept.score(best.left.independent).total - best.score(best.left.independent).total
            if gain <= EVIDENCE:
                self._against(best, f"scores {-gain:+.1f} against the law without")
                return kept
            self._against(kept, f"scores {gain:+.1f} against the law with {best.problem.basis.terms[-1]}")
            kept, self._guesses = best, guesses

    def _with(self, kept: Candidate, term: str, steps):
        """(candidate with one term more, displacements that it leads to), or None."""
        subcells = round(np.sqrt(kept.problem.refinement.subcells.shape[1]))
        problem = self._problem((*kept.problem.basis.terms, term), subcells)
        field, mine = kept.fit.field.with_law(self._translated(kept, problem)), dict(self._guesses)
        move = f"with {term}"
        found = self._candidate(move, problem, steps, field, mine, LAW_STEPS, kept.window, move_lines=False)
        return None if found is None else (found, mine)

    def _open(self, kept: Candidate) -> list[str]:
        """Terms that may join: those of the configuration which say nothing of a term that is not there."""
        settings, there = self._settings, kept.problem.basis.terms
        every = dict.fromkeys([*settings.isotropic_terms, *settings.terms, *settings.further_terms])
        return [term for term in every if term not in there and BELONGS.get(term, term) in (*there, term)]

    @staticmethod
    def _translated(found: Candidate, problem: FieldProblem) -> np.ndarray:
        """Materials of another law that has the parameters which both have, others as it begins with them."""
        names, old = problem.basis.names, found.problem.basis.names
        materials = np.tile(problem.basis.start, (found.fit.field.count, 1))
        for k, name in enumerate(names):
            if name in old:
                materials[:, k] = found.fit.field.materials[:, old.index(name)]
        # The same stiffness at the sheet's deformation.
        before, _ = found.problem.stiffness(found.fit.field.materials)
        after, _ = problem.stiffness(materials)
        materials[:, 0] += before - after
        return materials

    def _against(self, candidate: Candidate, reason: str) -> None:
        self._tried = [(each, reason if each is candidate else old) for each, old in self._tried]

    # The answer.

    def _answer(self, kept: Candidate) -> InterfaceEstimate:
        """All load steps, with the noise that is left."""
        problem, window = kept.problem, kept.window
        every = list(range(len(problem.observations.u)))
        many = len(kept.fit.field.distances) > 0
        final = self._candidate("all load steps", problem, every, kept.fit.field, self._guesses, LAST_STEPS, window)
        final = final or kept
        left, observations = final.left, problem.observations
        ratio = left.level / observations.scatter
        floor = None
        if ratio > NOISE_KNOWN and left.steps <= NOISE_SHARED:
            believed = BelievedNoise.read(self._measurement.attrs)
            self._other(dataclasses.replace(believed, factor=believed.factor * ratio).of(self._measurement))
        elif ratio > NOISE_KNOWN:
            # What is wrong in all steps is the description's, up to what finite elements are trusted with.
            trusted = self._strategy.description_error(False, FINER if many else 1, len(observations.grid.cells))
            floor = min(
                problem.sigma * float(np.sqrt(max(left.level**2 - 1.0, 0.0))),
                trusted * float(np.abs(observations.u).max()),
            )
        if self._finds and many and final.window > 0.0:
            side = final.window * self._spacing(problem)
            self._other(BelievedWindow(side, final.fit.window_error * self._spacing(problem)).of(self._measurement))
        subcells = round(np.sqrt(problem.refinement.subcells.shape[1]))
        problem = self._problem(problem.basis.terms, subcells, floor)
        lines = Lines.of(problem.observations.grid, problem.refinement)
        descent = InterfaceFit(SeenTest(problem, every))
        fit = descent.descend(final.fit.field.on(lines), [self._guesses[k] for k in every], LAST_STEPS)
        return self._estimate(descent, final.fit if fit is None else fit)

    def _estimate(self, descent: InterfaceFit, fit: Fit) -> InterfaceEstimate:
        test, near = descent.test, descent.near(fit.field)
        problem = test.problem
        score = Candidate("the answer", problem, fit).score(fit.left.independent)
        count = len(fit.field.numbers(near))
        objective = Objective(problem, None, 0.0, JumpCost(), np.zeros(count), np.zeros(count), self._strategy)
        each = zip(fit.states, problem.observations.boundaries, strict=True)
        states = [State(u, force, boundary.free) for (u, force, _), boundary in each]
        going, materials = np.ones(count, bool), fit.field.materials
        going[: materials.size] = (materials > problem.basis.lowest).ravel()
        start, trace = None, Trace()
        for each, reason in self._tried:
            trial = Trial(
                each.move,
                start,
                tuple(each.problem.basis.terms),
                each.fit.field.count,
                {"displacement": each.fit.misfit, "force": each.fit.forces},
                each.score(fit.left.independent),
                str(each.fit.ending),
            )
            trace = Trace({**trace.reasons, trial: reason})
            start = start if reason else trial
        misfits = {"displacement": fit.misfit / problem.observations.scatter, "force": fit.forces}
        trial = Trial("the answer", start, tuple(problem.basis.terms), fit.field.count, misfits, score, str(fit.ending))
        return InterfaceEstimate(
            objective,
            test.jacobian(fit.field, fit.states, near),
            fit.field.materials,
            states,
            np.array([*fit.history, fit.misfit]),
            fit.cost,
            fit.ending,
            None,
            trial=trial,
            trace=trace.with_trial(trial),
            field=fit.field,
            near=near,
            going=going,
            held=descent.held(fit.field, near),
            left=fit.left,
            scored=score,
        )


def of_parts(measurement: xr.Dataset, settings: Constrained, name: str, strategy: Strategy) -> InterfaceEstimate | None:
    """The few materials and lines that explain a test; None where they do not, or where they are not sought.

    They are not sought where the configuration asks for no layers, where displacements are known to be those of finite
    elements on the measured grid, so that no line cuts a cell, where grey levels are observed and no points, and on
    grids of more cells than are searched at once.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        ImpossibleForcesError: no sheet gives the forces.
    """
    sought = settings.layers and not is_on_its_own_grid(measurement) and information_of(measurement) is None
    if not sought or measurement.sizes["cell"] > strategy.most_cells_at_once:
        return None
    found = Search(measurement, settings, name, strategy).end()
    return None if found is None or found.unexplained > 1.0 else found
