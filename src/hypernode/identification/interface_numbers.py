"""The numbers of a field of materials and lines: their values, what is known of them without data, their bounds."""

import dataclasses
from collections.abc import Iterator

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float

from hypernode.identification import numerics, priors
from hypernode.identification.answers import Answer
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.problem import FieldProblem
from hypernode.identification.straight_steps import straight
from hypernode.mechanics.convex_basis import ConvexBasis


@dataclasses.dataclass(frozen=True, kw_only=True)
class Numbers:
    """The numbers of a field, what they cost without data, and their bounds.

    Attributes:
        of_materials: how many are parameters of materials; they come first.
        y: values; lines have moved by nothing.
        moves: how the distances from each line follow when its points move.
        held, pull, base: the cost without data is y^T held y / 2 - pull^T y + base.
        bounds: least and largest values.
        floor: added to the curvature, for what data do not tell.
    """

    of_materials: int
    y: Float[np.ndarray, " number"]
    moves: list[scipy.sparse.csr_matrix]
    held: scipy.sparse.csr_matrix
    pull: Float[np.ndarray, " number"]
    base: float
    bounds: Float[np.ndarray, "2 number"]
    floor: Float[np.ndarray, " number"]

    @property
    def within(self) -> Bool[np.ndarray, " number"]:
        """Which numbers are at none of their bounds."""
        return (self.y > self.bounds[0]) & (self.y < self.bounds[1])

    def prior(self, y) -> float:
        """What numbers cost without data."""
        return 0.5 * float(y @ (self.held @ y)) - float(self.pull @ y) + self.base

    def after(self, change: Float[np.ndarray, " number"], law: ConvexBasis) -> Float[np.ndarray, " number"]:
        """Values after a change, which is straight in the coefficients of the law."""
        y, of = self.y + change, self.of_materials
        before, changed = (each[:of].reshape(-1, len(law.names)) for each in (self.y, change))
        y[:of] = np.clip(straight(law, before, changed).ravel(), *self.bounds[:, :of])
        return y

    def slope(self, y) -> Float[np.ndarray, " number"]:
        """Derivative of :meth:`prior`."""
        return self.held @ y - self.pull


@dataclasses.dataclass(frozen=True)
class Derivatives:
    """Derivatives of the residuals where they were last followed.

    Attributes:
        moves: how the distances from each line follow when its points move.
        answers: to the numbers of materials and lines, by step.
        by_window: derivatives of displacements by the side of the window, where it is a number, by step
            (residual, 1).
    """

    moves: list
    answers: list[Answer]
    by_window: list[np.ndarray] | None

    def over(self, sigma: float) -> Iterator[Float[np.ndarray, "residual number"]]:
        """Derivative of the residuals of one step after the other, of displacements over ``sigma``."""
        for k, answer in enumerate(self.answers):
            J = answer.over(sigma)
            yield J if self.by_window is None else np.concatenate([J, self.by_window[k] / sigma], axis=1)


def bends_of(field: Interfaces, moves) -> list[tuple[scipy.sparse.csr_matrix, Float[np.ndarray, " bend"]]]:
    """(how bends change with each number, the bends as they are) of every line, over how much lines usually bend."""
    bends, found = field.lines.grid.bends, []
    middle, whole = bends.indices[bends.data < 0.0], np.asarray(abs(bends).sum(axis=1)).ravel()
    for row, move in zip(field.distances, moves, strict=True):
        inside = (np.diff(move.indptr) > 0).astype(float)
        rows = np.flatnonzero((whole - abs(bends) @ inside < 0.5) & (np.abs(row[middle]) < priors.LINE_BENDS_WITHIN))
        # Bends of a shape that is known are no news.
        some = bends[rows[:0] if field.lines.as_one else rows] / priors.LINE_BEND
        found.append((some @ move, some @ row))
    return found


def held_of_materials(field: Interfaces) -> Float[np.ndarray, " parameter"]:
    """Inverse variance of every parameter of every material without data, material by material."""
    return np.tile(np.append(priors.LEVEL_HELD, np.full(field.materials.shape[1] - 1, priors.LAW_HELD)), field.count)


def held_of(field: Interfaces, bends) -> scipy.sparse.csr_matrix:
    """Inverse covariance of materials and moves without data.

    Args:
        bends: of :func:`bends_of`.
    """
    blocks = [scipy.sparse.diags(held_of_materials(field)), *(change.T @ change for change, _ in bends)]
    if field.lines.splines is not None:
        blocks += [field.lines.splines.held, priors.LAW_HELD * scipy.sparse.identity(len(field.turn))]
    return scipy.sparse.block_diag(blocks, format="csr")


def numbers_of(problem: FieldProblem, field: Interfaces, moves, window: float | None) -> Numbers:
    """The numbers of a field, and the side of the window as the last where it is one."""
    law = problem.basis
    y, bends = field.numbers(moves), bends_of(field, moves)
    held = held_of(field, bends)
    centre = np.zeros(len(law.names))
    centre[0] = problem.homogeneous.params[0]
    centre = np.tile(centre, field.count)
    pull = np.concatenate([held_of_materials(field) * centre, *(-(change.T @ bend) for change, bend in bends)])
    pull = np.append(pull, np.zeros(len(y) - len(pull)))
    base = 0.5 * float(held_of_materials(field) @ centre**2) + 0.5 * sum(float(bend @ bend) for _, bend in bends)
    extra = len(y) - field.materials.size
    free = np.array([[-np.inf], [np.inf]])
    bounds = np.concatenate([np.tile(problem.bounds, field.count), np.tile(free, extra)], axis=1)
    known = numerics.LARGEST_STEP**-2.0
    floor = np.concatenate([np.full(field.materials.size, known), np.full(extra, priors.DISTANCE_HELD)])
    if window is not None:
        y, pull = np.append(y, window), np.append(pull, priors.NOT_HELD * window)
        base += 0.5 * priors.NOT_HELD * window**2
        held = scipy.sparse.block_diag([held, [[priors.NOT_HELD]]], format="csr")
        bounds, floor = np.append(bounds, [[0.0], [np.inf]], axis=1), np.append(floor, known)
    return Numbers(
        of_materials=field.materials.size, y=y, moves=moves, held=held, pull=pull, base=base, bounds=bounds, floor=floor
    )
