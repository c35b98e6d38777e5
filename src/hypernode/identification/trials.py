"""Descents of one test with one law after the other, each recorded."""

import dataclasses
from collections.abc import Mapping

import numpy as np
import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.identification import numerics, priors
from hypernode.identification.candidate import Candidate
from hypernode.identification.interface_fit import InterfaceFit
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.problem import FieldProblem, field_problem, with_law
from hypernode.identification.seen_test import SeenTest
from hypernode.progress import say
from hypernode.trace import Trace, Trial


class Trials:
    """All that was tried on a test.

    Attributes:
        measurement: the test, with the noise and the window that are believed by now.
        settings: configuration of the stage.
        name: of the case, for progress.
    """

    def __init__(self, measurement: xr.Dataset, settings: Constrained, name: str):
        self.measurement, self.settings, self.name = measurement, settings, name
        self._problems: dict[tuple, FieldProblem] = {}
        self._tried: list[Candidate] = []
        self._reasons: dict[Candidate, str] = {}
        self._promises: dict[Candidate, dict[str, float]] = {}

    def believe(self, measurement: xr.Dataset) -> None:
        """Go on with another noise or another window."""
        self.measurement = measurement
        self._problems.clear()

    def problem(self, terms, subcells: int = 1, floor: float = 0.0) -> FieldProblem:
        """The test of a sheet of a law.

        Args:
            terms: of the law.
            subcells: rows and columns into which every cell of the grid is divided.
            floor: what finite elements miss of the displacements beside lines, beside their noise.
        """
        key = tuple(terms), subcells, floor
        if key not in self._problems:
            settings = self.settings.model_copy(update={"terms": list(terms)})
            largest = float(np.nanmax(np.abs(self.measurement["u_measured"].values)))
            least = priors.SAME_GRID_FLOOR * largest
            self._problems[key] = field_problem(
                self.measurement, settings, subcells, max(floor, least), at_lines=floor > 0.0
            )
        return self._problems[key]

    def plainest(self) -> FieldProblem:
        """The test of a sheet of the plainest law: with J where all laws have it."""
        return self.problem([term for term in self.settings.terms if term == "J"])

    def on_finer_elements(self, candidate: Candidate) -> tuple[FieldProblem, Interfaces, dict[int, np.ndarray]]:
        """(problem, field, displacement of every load step) of a candidate on divided cells."""
        problem, before = self.problem(candidate.terms, numerics.FINER), candidate.fit.field
        field = before.on(Lines.of(problem.observations.grid, problem.refinement, before.lines))
        return problem, field, {k: problem.refinement.interpolation @ u for k, u in candidate.u.items()}

    def with_terms(self, candidate: Candidate, terms: tuple[str, ...]) -> FieldProblem:
        """The problem of a candidate with another law; what is homogeneous stays as it was fitted."""
        # Noise, elements and homogeneous fit are those of the observations, which problems of other laws share.
        key = terms, id(candidate.problem.observations)
        if key not in self._problems:
            law = dataclasses.replace(candidate.problem.basis, terms=terms)
            self._problems[key] = with_law(candidate.problem, law)
        return self._problems[key]

    def descend(
        self,
        move: str,
        start: Candidate | None,
        problem: FieldProblem,
        field: Interfaces,
        u: Mapping[int, np.ndarray],
        steps: list[int],
        iterations: int,
        window: float | None = None,
        find_window: bool = False,
        move_lines: bool = True,
        settled: bool = True,
    ) -> Candidate | None:
        """The candidate at the end of a descent; None without equilibrium.

        Args:
            move: what is tried, in words.
            start: what it begins from.
            u: displacement near equilibrium by load step, of these steps and of all others.
            steps: load steps that count.
            window, find_window, move_lines, settled: of :class:`SeenTest` and :class:`InterfaceFit`.
        """
        edges = None if start is None else start.edges(problem, steps)
        descent = InterfaceFit(SeenTest(problem, steps, window, edges), find_window, move_lines, settled)
        fit = descent.descend(field, [u[k] for k in steps], iterations)
        law = ", ".join(problem.basis.terms) or "neo-Hookean"
        if fit is None:
            say("constrained", self.name, f"{move} ({law}): no equilibrium")
            return None
        if not move_lines and start is not None:
            # Lines that stay are numbers all the same.
            lines = start.fit.determined - start.fit.of_materials
            fit = dataclasses.replace(fit, determined=fit.of_materials + lines)
        reached = {k: state[0] for k, state in zip(steps, fit.states, strict=True)}
        found = Candidate(move=move, start=start, problem=problem, fit=fit, u={**u, **reached})
        sought = f", window of {fit.window:.2f} points" if find_window else ""
        say(
            "constrained",
            self.name,
            f"{move} ({law}): displacements missed by {found.missed:.3g}, forces by {fit.forces:.3g} of their noise, "
            f"{fit.determined:.0f} numbers{sought}",
        )
        self._tried.append(found)
        return found

    def was_tried(self, move: str, start: Candidate) -> bool:
        """Whether a move from a candidate is on record."""
        return any(each.start is start and each.move == move for each in self._tried)

    def after(self, earlier: "Trials") -> None:
        """Go on with what was tried on a coarser grid."""
        self._tried = [*earlier._tried, *self._tried]
        self._reasons = earlier._reasons | self._reasons
        self._promises = earlier._promises | self._promises

    def passed_over(self, candidate: Candidate, reason: str) -> None:
        """Why a candidate is not the answer."""
        self._reasons[candidate] = reason

    def promised(self, candidate: Candidate, gains: dict[str, float]) -> None:
        """By how much each term that may join a candidate promises to improve its score."""
        self._promises[candidate] = gains

    def trace(self, independent: float) -> tuple[Trace, dict[Candidate | None, Trial | None]]:
        """(the record of all, the record of each).

        Args:
            independent: how many independent numbers residuals of displacements are worth.
        """
        trials: dict[Candidate | None, Trial | None] = {None: None}
        for each in self._tried:
            trials[each] = each.trial(trials[each.start], independent, self._promises.get(each, {}))
        return Trace({trials[each]: self._reasons.get(each, "") for each in self._tried}), trials


def largest_steps(problem: FieldProblem) -> list[int]:
    """The largest load step of every load case."""
    loading = problem.observations.loading
    each = (np.flatnonzero(loading.load_case == case) for case in np.unique(loading.load_case))
    return [int(own[np.argmax(loading.t[own])]) for own in each]


def largest_and_half(problem: FieldProblem) -> list[int]:
    """Two load steps of every load case: the largest, and the one that is closest to half of it."""
    loading, found = problem.observations.loading, set()
    for largest in largest_steps(problem):
        own = np.flatnonzero(loading.load_case == loading.load_case[largest])
        found |= {largest, int(own[np.argmin(np.abs(loading.t[own] - 0.5 * loading.t[largest]))])}
    return sorted(found)


def homogeneous_displacement(problem: FieldProblem) -> dict[int, np.ndarray]:
    """Displacement of the homogeneous sheet by load step, near equilibrium."""
    everywhere = np.tile(problem.homogeneous.params, (len(problem.mesh.cells), 1))
    return dict(enumerate(problem.equilibrium.extension(everywhere)))
