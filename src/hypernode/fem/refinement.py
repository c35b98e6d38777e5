"""Meshes whose cells are divided into equal subcells."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse
from jaxtyping import Int

from hypernode.fem.mesh import Mesh, rectilinear
from hypernode.fem.transfer import transfer


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
    lines = [np.interp(np.arange(subcells * (len(x) - 1) + 1) / subcells, np.arange(len(x)), x) for x in mesh.lines]
    parent = mesh.cell_numbers.repeat(subcells, axis=0).repeat(subcells, axis=1)
    fine = replace(rectilinear(*lines, parent >= 0), lower=mesh.lower, upper=mesh.upper)
    children = np.argsort(parent[parent >= 0], kind="stable").reshape(len(mesh.cells), -1)
    row, column = np.divmod(mesh.places, len(mesh.lines[0]))
    nodes = fine.node_numbers[subcells * row, subcells * column]
    return Refinement(fine, children, nodes, transfer(mesh, fine).nodes)
