"""What fields on one rectilinear mesh are on another one of the same sheet."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int
from scipy.ndimage import distance_transform_edt

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
    x, y = source.lines
    row, column = np.divmod(source.places, len(x))
    # A cell is where its lower left node is; grid lines have one interval less than nodes.
    cell = np.full((len(y) - 1, len(x) - 1), -1)
    cell[row[source.cells[:, 0]], column[source.cells[:, 0]]] = np.arange(len(source.cells))
    node = np.full((len(y), len(x)), -1)
    node[row, column] = np.arange(len(source.nodes))
    place = [
        np.clip(np.searchsorted(line, centre, side="right") - 1, 0, len(line) - 2)
        for line, centre in zip((x, y), target.centres.T, strict=True)
    ]
    shares = [_shares(line, position) for line, position in zip((x, y), target.nodes.T, strict=True)]
    nearest, rows, columns, entries = _nearest(node), [], [], []
    for i, along_x in shares[0]:
        for j, along_y in shares[1]:
            rows.append(np.arange(len(target.nodes)))
            columns.append(nearest[j, i])
            entries.append(along_x * along_y)
    together = [np.concatenate(each) for each in (entries, rows, columns)]
    shape = len(target.nodes), len(source.nodes)
    nodes = scipy.sparse.csr_matrix((together[0], (together[1], together[2])), shape)
    return Transfer(_nearest(cell)[place[1], place[0]], nodes)


def _nearest(numbers: Int[np.ndarray, "row column"]) -> Int[np.ndarray, "row column"]:
    """The numbers of a grid, -1 where there is none, with that of the nearest place that has one."""
    if (numbers >= 0).all():
        return numbers
    rows, columns = distance_transform_edt(numbers < 0, return_distances=False, return_indices=True)
    return numbers[rows, columns]


def _shares(line: Float[np.ndarray, " line"], position: Float[np.ndarray, " node"]):
    """The two grid lines beside every position, each with its share."""
    before = np.clip(np.searchsorted(line, position, side="right") - 1, 0, len(line) - 2)
    share = (position - line[before]) / (line[before + 1] - line[before])
    return (before, 1.0 - share), (before + 1, share)
