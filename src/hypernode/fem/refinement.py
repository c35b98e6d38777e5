"""Meshes whose cells are divided into equal subcells."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse
from jaxtyping import Int

from hypernode.fem.mesh import Mesh, rectilinear


@dataclass(frozen=True)
class Refinement:
    """A mesh whose cells are divided into equal subcells.

    Attributes:
        mesh: of the subcells.
        subcells: their numbers by divided cell, row by row (cell, subcell).
        nodes: numbers of the divided mesh's own nodes (own node,).
        interpolation: bilinear, from values at those (node, own node).
    """

    mesh: Mesh
    subcells: Int[np.ndarray, "cell subcell"]
    nodes: Int[np.ndarray, " node"]
    interpolation: scipy.sparse.csr_matrix


def refine(mesh: Mesh, subcells: int) -> Refinement:
    """Divide every cell into ``subcells`` times ``subcells``."""
    coarse, place = mesh.lines, mesh.places
    lines = [np.interp(np.arange(subcells * (len(x) - 1) + 1) / subcells, np.arange(len(x)), x) for x in coarse]
    row, column = np.divmod(place, len(coarse[0]))
    # A cell is where its lower left node is; grid lines have one interval less than nodes.
    cell = np.full([len(x) - 1 for x in coarse[::-1]], -1)
    cell[row[mesh.cells[:, 0]], column[mesh.cells[:, 0]]] = np.arange(len(mesh.cells))
    parent = cell.repeat(subcells, axis=0).repeat(subcells, axis=1)
    fine = replace(rectilinear(*lines, parent >= 0), lower=mesh.lower, upper=mesh.upper)
    children = np.argsort(parent[parent >= 0], kind="stable").reshape(len(mesh.cells), -1)
    along = [
        scipy.sparse.csr_matrix(np.stack([np.interp(x, old, one) for one in np.eye(len(old))], axis=1))
        for x, old in zip(lines, coarse, strict=True)
    ]
    fine_place = fine.places
    interpolation = scipy.sparse.kron(along[1], along[0], format="csr")[fine_place][:, place]
    number = np.full(len(lines[0]) * len(lines[1]), -1)
    number[fine_place] = np.arange(len(fine.nodes))
    return Refinement(fine, children, number[subcells * (row * len(lines[0]) + column)], interpolation)
