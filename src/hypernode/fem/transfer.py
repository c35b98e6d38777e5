"""What fields on one rectilinear mesh are on another one of the same sheet."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
from jaxtyping import Int
from scipy.ndimage import distance_transform_edt

from hypernode.fem.lines import intervals
from hypernode.fem.mesh import Mesh


@dataclass(frozen=True)
class Transfer:
    """From one mesh, the source, to another, the target.

    Attributes:
        cells: the source's cell at the centre of every cell of the target, the nearest one where there is none
            (target cell,).
        nodes: bilinear interpolation of nodal values (target node, source node); where the source lacks a crossing of
            its grid lines, by the nearest of its nodes.
    """

    cells: Int[np.ndarray, " target"]
    nodes: scipy.sparse.csr_matrix


def transfer(source: Mesh, target: Mesh) -> Transfer:
    """The transfer between two meshes of one sheet, whose grid lines may be any."""
    centre, node = (
        [intervals(line, position) for line, position in zip(source.lines, positions.T, strict=True)]
        for positions in (target.centres, target.nodes)
    )
    cells = _nearest(source.cell_numbers)[centre[1][0], centre[0][0]]
    nearest, columns, entries = _nearest(source.node_numbers), [], []
    (column, along_x), (row, along_y) = node
    for i, share_x in ((column, 1.0 - along_x), (column + 1, along_x)):
        for j, share_y in ((row, 1.0 - along_y), (row + 1, along_y)):
            columns.append(nearest[j, i])
            entries.append(share_x * share_y)
    rows = np.tile(np.arange(len(target.nodes)), len(entries))
    entries = np.concatenate(entries), (rows, np.concatenate(columns))
    nodes = scipy.sparse.csr_matrix(entries, (len(target.nodes), len(source.nodes)))
    nodes.eliminate_zeros()
    return Transfer(cells, nodes)


def _nearest(numbers: Int[np.ndarray, "row column"]) -> Int[np.ndarray, "row column"]:
    """The numbers of a grid, -1 where there is none, with that of the nearest place that has one."""
    if (numbers >= 0).all():
        return numbers
    rows, columns = distance_transform_edt(numbers < 0, return_distances=False, return_indices=True)
    return numbers[rows, columns]
