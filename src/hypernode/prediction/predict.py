"""Equilibrium of a sheet whose phases follow known laws, and how uncertain it is by these laws and by its edges."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.config.methods import Constrained
from hypernode.data.measurement import correlation_window, relaxation
from hypernode.fem.factors import factorise
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.identification import numerics
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.observations import seen_points
from hypernode.identification.points import Points
from hypernode.identification.problem import FieldProblem, problem_of_basis
from hypernode.identification.sheet import Sheet
from hypernode.prediction.errors import PredictionError
from hypernode.prediction.laws import PhaseLaw
from hypernode.prediction.layout import Layout
from hypernode.prediction.switched import SwitchedLaw
from hypernode.progress import Progress

#: Numbers of equal parts in which a load step is reached, tried one after the other.
PARTS = (1, 2, 4, 8)


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """A sheet under the load steps of its test.

    Attributes:
        problem: the test, with finite elements.
        field: materials and lines.
        u: displacement of the grid, as the camera sees it, and its standard deviation (step, node, 2).
        force: outward resultant of every edge that is held, and its standard deviation (step, edge, 2), NaN elsewhere.
        F: deformation gradient at the centres of the grid's cells (step, cell, 2, 2).
        remarks: sentences on what limits the prediction.
    """

    problem: FieldProblem
    field: Interfaces
    u: Float[np.ndarray, "step node 2"]
    u_spread: Float[np.ndarray, "step node 2"]
    force: Float[np.ndarray, "step edge 2"]
    force_spread: Float[np.ndarray, "step edge 2"]
    F: Float[np.ndarray, "step cell 2 2"]
    remarks: list[str]


def problem_of(measurement: xr.Dataset, pools: Sequence[Sequence[PhaseLaw]], subcells: int = 2) -> FieldProblem:
    """The test of a sheet whose law is any of those of the phases.

    Args:
        measurement: opened, without a truth.
        pools: laws of every phase from different specimens, the softest phase first.
        subcells: finite elements along a side of a cell.
    """
    bases = tuple(dict.fromkeys(law.basis for pool in pools for law in pool))
    return problem_of_basis(measurement, Constrained(), SwitchedLaw(bases), subcells)


def predict(
    measurement: xr.Dataset, problem: FieldProblem, pools: Sequence[Sequence[PhaseLaw]], layout: Layout, name: str
) -> Prediction:
    """Forces and displacements of a sheet of known laws whose edges move as they were measured.

    Of several specimens each predicts by itself: the prediction is their mean, and how they differ is part of its
    spread. A specimen's own spread is that of its posterior samples, to first order, and of its level by what these do
    not know. Edges that move are known up to their noise, and the sheet's thickness up to its own error.

    Args:
        measurement, problem: of the sheet; see :func:`problem_of`.
        pools: laws of every phase from different specimens, the softest phase first.
        layout: where phases are.
        name: of the sheet, for progress.

    Raises:
        PredictionError: a load step finds no equilibrium.
    """
    members = max(len(pool) for pool in pools)
    progress = Progress("prediction", name, members * len(problem.observations.boundaries))
    seen = seen_points(problem.refinement, *correlation_window(measurement))
    each = [
        _Member(problem=problem, seen=seen, layout=layout, laws=[p[m % len(p)] for p in pools], progress=progress)
        for m in range(members)
    ]
    scale = float(measurement.attrs["thickness"]) * relaxation(measurement)
    of_thickness = float(measurement.attrs.get("thickness_uncertainty", 0.0))
    u, u_variance = _together([m.u for m in each], [m.u_variance for m in each])
    force, force_variance = _together([m.force for m in each], [m.force_variance for m in each])
    F = deformation_gradient(problem.observations.grid, u)
    return Prediction(
        problem=problem,
        field=each[0].field,
        u=u,
        u_spread=np.sqrt(u_variance),
        force=scale * force,
        force_spread=scale * np.sqrt(force_variance + (of_thickness * force) ** 2),
        F=F,
        remarks=_remarks(pools, F),
    )


def _together(means, variances):
    """Mean of several predictions, and the variance of one more: within each and between them."""
    means = np.stack(means)
    between = means.var(axis=0, ddof=1) if len(means) > 1 else 0.0
    return means.mean(axis=0), np.mean(variances, axis=0) + between


def _remarks(pools: Sequence[Sequence[PhaseLaw]], F) -> list[str]:
    laws = [law for pool in pools for law in pool]
    remarks = []
    for source in dict.fromkeys(law.source for law in laws):
        law = next(each for each in laws if each.source == source)
        beyond = law.seen.remark(F) if law.seen is not None else ""
        if beyond:
            remarks.append(f"{source}: {beyond}")
        if not len(law.samples):
            remarks.append(f"{source}: holds no posterior samples, so that the spread of its laws counts as none")
    return remarks


class _Member:
    """The prediction of one set of laws, one for each phase."""

    def __init__(self, *, problem: FieldProblem, seen, layout: Layout, laws: Sequence[PhaseLaw], progress: Progress):
        switched, observations = problem.basis, problem.observations
        of = [switched.laws.index(law.basis) for law in laws]
        self.field = layout.field(
            Lines.of(observations.grid, problem.refinement),
            np.stack([switched.of(k, law.best) for k, law in zip(of, laws, strict=True)]),
        )
        self._problem, self._seen = problem, seen
        self._sheet = Sheet(problem.mesh, Points(switched), observations.relative_thickness)
        self._changes = _changes(self.field, layout, switched, of, laws)
        self._edges = [
            (e, i, (problem.mesh.on_edge(edge)[:, None] & (np.arange(2) == i)).ravel())
            for e, edge in enumerate(EDGE_NAMES)
            for i in range(2)
        ]
        steps = [self._step(*each, progress) for each in zip(self._states(), observations.boundaries, strict=True)]
        self.u, self.u_variance, self.force, self.force_variance = map(np.stack, zip(*steps, strict=True))

    def _states(self):
        """(displacement, nodal forces, tangent) of every step, one after the other."""
        (of, _), u = self.field.cells(), np.zeros_like(self._problem.mesh.nodes)
        before, (_, at_rest) = u, self._sheet.response(u, of)
        for number, boundary in enumerate(self._problem.observations.boundaries):
            guess = _extended(at_rest, boundary)
            reached = self._reached(u, guess - before, boundary, of)
            if reached is None:
                raise PredictionError(
                    f"load step {number}: the sheet finds no equilibrium with these laws: leave that step out, or take "
                    "laws from a test that was stretched as far"
                )
            u, before = reached[0], guess
            yield reached

    def _reached(self, u, change, boundary, of):
        """Equilibrium after a change of the displacement, in as few parts as it takes; None where none suffices."""
        held, moved = boundary.mask, (boundary.values - u)[boundary.mask]
        for parts in PARTS:
            at = u
            for part in range(1, parts + 1):
                guess = at + change / parts
                guess[held] = u[held] + moved * part / parts
                reached = self._sheet.equilibrium(guess, boundary.free, of, numerics.NEWTON_TOLERANCE)
                if reached is None:
                    break
                at = reached[0]
            else:
                return reached
        return None

    def _step(self, state, boundary, progress: Progress):
        """(displacement that is seen, its variance, forces on edges, their variance) of a step."""
        u, force, K = state
        free, factor = boundary.free, factorise(K[boundary.free][:, boundary.free])
        load = self.field.loads(self._sheet, u, self.field.still) @ self._changes
        by_laws = np.zeros((u.size, load.shape[1]))
        by_laws[free] = -factor.solve(load[free])
        by_edges = boundary.errors.toarray()
        by_edges[free] = -factor.solve((K[free] @ boundary.errors).toarray())
        u_variance = _square(self._seen @ by_laws) + _square(self._seen @ by_edges)
        found, variance = np.full((2, len(EDGE_NAMES), 2), np.nan)
        for e, i, direction in self._edges:
            if boundary.mask.ravel()[direction].all():
                rows = np.asarray(K[np.flatnonzero(direction)].sum(axis=0)).ravel()
                found[e, i] = force[direction].sum()
                of_laws = load[direction].sum(axis=0) + rows @ by_laws
                variance[e, i] = (of_laws**2).sum() + ((rows @ by_edges) ** 2).sum()
        progress.advance()
        return (self._seen @ u.ravel()).reshape(-1, 2), u_variance.reshape(-1, 2), found, variance


def _extended(K, boundary) -> np.ndarray:
    """Prescribed displacements (node, 2), continued into the sheet by linear elasticity."""
    free, u = boundary.free, np.where(boundary.mask, boundary.values, 0.0).ravel()
    u[free] = -factorise(K[free][:, free]).solve((K @ u)[free])
    return u.reshape(-1, 2)


def _square(changes) -> np.ndarray:
    return (changes**2).sum(axis=1)


def _changes(field: Interfaces, layout: Layout, switched: SwitchedLaw, of, laws) -> Float[np.ndarray, "number error"]:
    """Changes of the materials' parameters, material by material, by each of several standard normal numbers.

    The first are those of posterior samples, which scatter about the best law. Then every specimen has one for its
    level.
    """
    count, sources = min(len(law.samples) for law in laws), list(dict.fromkeys(law.source for law in laws))
    by_phase = []
    for k, law in zip(of, laws, strict=True):
        samples = switched.of(k, law.samples[:count] - law.best) / max(count, 1) ** 0.5
        level = np.zeros((len(sources), samples.shape[1]))
        level[sources.index(law.source), 0] = law.level
        samples[:, 1] = 0.0
        by_phase.append(np.concatenate([samples, level]))
    changes = np.stack([by_phase[phase] for phase in layout.order])
    return changes.transpose(0, 2, 1).reshape(field.materials.size, count + len(sources))
