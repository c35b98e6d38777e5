"""Rectilinear meshes of bilinear quadrilaterals, with cells left out where there is no material."""

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float, Int

#: Edge name -> (axis of the outward normal, its sign).
EDGES = {"left": (0, -1), "right": (0, 1), "bottom": (1, -1), "top": (1, 1)}
EDGE_NAMES = tuple(EDGES)


@dataclass(frozen=True)
class Mesh:
    """Nodes, quadrilateral cells and the rectangle that bounds them.

    Attributes:
        nodes: coordinates (node, 2), in the length unit of the test.
        cells: four node numbers a cell (cell, 4), counter-clockwise from the lower left corner.
        lower, upper: corners of the bounding rectangle (2,).
    """

    nodes: Float[np.ndarray, "node 2"]
    cells: Int[np.ndarray, "cell 4"]
    lower: Float[np.ndarray, " 2"] = field(default=None)
    upper: Float[np.ndarray, " 2"] = field(default=None)

    def __post_init__(self):
        if self.lower is None:
            object.__setattr__(self, "lower", self.nodes.min(axis=0))
            object.__setattr__(self, "upper", self.nodes.max(axis=0))

    @property
    def size(self) -> Float[np.ndarray, " 2"]:
        """Side lengths of the bounding rectangle."""
        return self.upper - self.lower

    @property
    def centres(self) -> Float[np.ndarray, "cell 2"]:
        """Cell centres."""
        return self.nodes[self.cells].mean(axis=1)

    @property
    def step(self) -> float:
        """Usual distance between points of a grid."""
        return float(np.median(np.concatenate([np.diff(line) for line in self.lines])))

    @property
    def areas(self) -> Float[np.ndarray, " cell"]:
        """Cell areas."""
        corner = self.nodes[self.cells]
        d1, d2 = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
        return 0.5 * (d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0])

    @property
    def lines(self) -> tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]]:
        """Coordinates of the grid lines."""
        return np.unique(self.nodes[:, 0]), np.unique(self.nodes[:, 1])

    @property
    def places(self) -> Int[np.ndarray, " node"]:
        """Number of every node among all crossings of the grid lines, x fastest."""
        x, y = self.lines
        return np.searchsorted(y, self.nodes[:, 1]) * len(x) + np.searchsorted(x, self.nodes[:, 0])

    @property
    def node_numbers(self) -> Int[np.ndarray, "row column"]:
        """Number of the node on every crossing of the grid lines, -1 where there is none."""
        x, y = self.lines
        numbers = np.full(len(y) * len(x), -1)
        numbers[self.places] = np.arange(len(self.nodes))
        return numbers.reshape(len(y), len(x))

    @property
    def cell_numbers(self) -> Int[np.ndarray, "row column"]:
        """Number of the cell between every two grid lines, -1 where there is none."""
        x, y = self.lines
        # A cell is where its lower left node is; grid lines have one interval less than nodes.
        row, column = np.divmod(self.places[self.cells[:, 0]], len(x))
        numbers = np.full((len(y) - 1, len(x) - 1), -1)
        numbers[row, column] = np.arange(len(self.cells))
        return numbers

    @property
    def dofs(self) -> Int[np.ndarray, "cell 8"]:
        """Degrees of freedom of every cell, node by node, x before y."""
        return (2 * self.cells[:, :, None] + np.arange(2)).reshape(-1, 8)

    def on_edge(self, edge: str) -> Bool[np.ndarray, " node"]:
        """Which nodes lie on an edge of the bounding rectangle."""
        axis, sign = EDGES[edge]
        position = self.upper[axis] if sign > 0 else self.lower[axis]
        return np.abs(self.nodes[:, axis] - position) <= 1e-9 * self.size[axis]

    def neighbours(self) -> tuple[Int[np.ndarray, "face 2"], Float[np.ndarray, " face"], Float[np.ndarray, "face 2"]]:
        """(the two cells, length, midpoint) of every side that two cells share."""
        sides = np.sort(self.cells[:, [[0, 1], [1, 2], [2, 3], [3, 0]]], axis=-1).reshape(-1, 2)
        owner = np.repeat(np.arange(len(self.cells)), 4)
        order = np.lexsort(sides.T)
        shared = np.flatnonzero((sides[order][1:] == sides[order][:-1]).all(axis=1))
        ends = self.nodes[sides[order[shared]]]
        pairs = np.stack([owner[order[shared]], owner[order[shared + 1]]], axis=1)
        return pairs, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), ends.mean(axis=1)

    def diagonal_neighbours(self) -> tuple[Int[np.ndarray, "pair 2"], Float[np.ndarray, " pair"]]:
        """(the two cells, side of a square of their mean area) of every two cells that face each other at a node."""
        pairs = []
        for one, other in ((2, 0), (1, 3)):
            owner = np.full(len(self.nodes), -1)
            owner[self.cells[:, other]] = np.arange(len(self.cells))
            facing = owner[self.cells[:, one]]
            present = np.flatnonzero(facing >= 0)
            pairs.append(np.stack([present, facing[present]], axis=1))
        pairs = np.concatenate(pairs)
        return pairs, np.sqrt(self.areas[pairs].mean(axis=1))

    def touching(self) -> Int[np.ndarray, "pair 2"]:
        """The two cells of every pair that shares a side or a corner."""
        return np.concatenate([self.neighbours()[0], self.diagonal_neighbours()[0]])

    def around(self) -> scipy.sparse.csr_matrix:
        """Which nodes belong to a cell or to one that shares a node with it (cell, node), 1 where they do."""
        cells, vertices = self.cells.shape
        entries = np.ones(self.cells.size), (np.repeat(np.arange(cells), vertices), self.cells.ravel())
        own = scipy.sparse.csr_matrix(entries, shape=(cells, len(self.nodes)))
        around = own @ own.T @ own
        around.data[:] = 1.0
        return around

    def gradient_operator(self) -> Float[np.ndarray, "cell 4 2"]:
        """dN_a/dX_J at the cell centres: multiply nodal values and sum over a to differentiate."""
        corner = self.nodes[self.cells]
        local = 0.25 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
        jacobian = np.einsum("cai,aj->cij", corner, local)
        return np.einsum("aj,cjJ->caJ", local, np.linalg.inv(jacobian))


def tied_edge(constrained: Bool[np.ndarray, "edge 2"], measured: Bool[np.ndarray, "edge 2"], component: int):
    """Name of the edge whose nodes move together in a component, since their resultant is measured, or None.

    Of several the one with the larger coordinate; overall balance then implies the other.
    """
    tied = np.flatnonzero(constrained[:, component] & measured[:, component])
    return tuple(EDGES)[tied[-1]] if len(tied) else None


def rectilinear(x: Float[np.ndarray, " nx"], y: Float[np.ndarray, " ny"], keep=None) -> Mesh:
    """Mesh of the grid lines ``x`` and ``y``, nodes numbered with x fastest.

    Args:
        x, y: increasing grid coordinates.
        keep: which cells hold material (ny - 1, nx - 1); all when left out. Nodes that no kept
            cell touches are dropped.
    """
    nx, ny = len(x), len(y)
    grid_x, grid_y = np.meshgrid(x, y)
    nodes = np.stack([grid_x.ravel(), grid_y.ravel()], axis=1)
    number = np.arange(nx * ny).reshape(ny, nx)
    cells = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    if keep is not None:
        cells = cells[np.asarray(keep).ravel()]
        used = np.unique(cells)
        renumber = np.full(nx * ny, -1)
        renumber[used] = np.arange(len(used))
        nodes, cells = nodes[used], renumber[cells]
    lower, upper = np.array([x[0], y[0]], dtype=float), np.array([x[-1], y[-1]], dtype=float)
    return Mesh(nodes, cells, lower, upper)
