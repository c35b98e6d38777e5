"""The numbers of a field of materials and lines: their values, what is known of them without data, their bounds."""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.identification.interfaces import Interfaces
from hypernode.identification.problem import FieldProblem

#: In sides of cells: how near a line its distances bend, and by how much they usually do.
BENT, BEND = 0.8, 0.3
#: Inverse variance of what a step changes of distances without data.
HELD = 3.0
#: Inverse variance of the window without data: none.
UNKNOWN = 1e-6


@dataclasses.dataclass(frozen=True)
class Numbers:
    """The numbers of a field, their prior and their bounds.

    Attributes:
        y: values.
        near: nodes of each line's distances.
        held, centre: inverse covariance and mean without data.
        lowest: least values.
        floor: added to the curvature, for what data do not tell.
    """

    y: Float[np.ndarray, " number"]
    near: list
    held: scipy.sparse.csr_matrix
    centre: Float[np.ndarray, " number"]
    lowest: Float[np.ndarray, " number"]
    floor: Float[np.ndarray, " number"]

    def prior(self, y) -> float:
        """What numbers cost without data."""
        return 0.5 * float((y - self.centre) @ (self.held @ (y - self.centre)))


def held_of(field: Interfaces, near, ridge: float) -> scipy.sparse.csr_matrix:
    """Inverse covariance of materials and distances without data.

    Args:
        near: nodes of which each line's distance is a number.
        ridge: inverse variance of a parameter of a material.
    """
    bends = field.lines.grid.bends
    blocks = [ridge * scipy.sparse.identity(field.materials.size)]
    middle, whole = np.asarray(bends.argmin(axis=1)).ravel(), np.asarray(abs(bends).sum(axis=1)).ravel()
    for row, nodes in zip(field.distances, near, strict=True):
        inside = np.zeros(len(row))
        inside[nodes] = 1.0
        rows = (whole - abs(bends) @ inside < 0.5) & (np.abs(row[middle]) < BENT)
        some = bends[np.flatnonzero(rows)][:, nodes] / BEND
        blocks.append(some.T @ some)
    return scipy.sparse.block_diag(blocks, format="csr")


def numbers_of(problem: FieldProblem, field: Interfaces, near, window: float | None) -> Numbers:
    """The numbers of a field, and the side of the window as the last where it is one."""
    strategy, law = problem.strategy, problem.basis
    y, held = field.numbers(near), held_of(field, near, strategy.ridge)
    centre = np.zeros(len(law.names))
    centre[0] = problem.homogeneous.params[0]
    extra = len(y) - field.materials.size
    centre = np.concatenate([np.tile(centre, field.count), np.zeros(extra)])
    lowest = np.concatenate([np.tile(law.lowest, field.count), np.full(extra, -np.inf)])
    known = strategy.largest_step**-2.0
    floor = np.concatenate([np.full(field.materials.size, known), np.full(extra, HELD)])
    if window is not None:
        y, centre = np.append(y, window), np.append(centre, window)
        held = scipy.sparse.block_diag([held, [[UNKNOWN]]], format="csr")
        lowest, floor = np.append(lowest, 0.0), np.append(floor, known)
    return Numbers(y, near, held, centre, lowest, floor)
