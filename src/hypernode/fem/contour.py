"""A line through the cells of a rectilinear mesh, as the zero line of signed distances at its nodes.

Distances are in sides of cells, so that an unequal grid counts as one of squares. In a cell the line is straight: it
has the slope of the distances at its corners and their mean in the middle.
"""

from functools import cached_property
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import scipy.ndimage
import scipy.sparse
from jaxtyping import Array, ArrayLike, Float, Int
from scipy.spatial import cKDTree
from skimage.measure import find_contours

from hypernode.fem.blocks import in_blocks
from hypernode.fem.mesh import Mesh

#: Slope that distances count as having at least. True ones have a slope of one, but where two lines meet.
SMALLEST_SLOPE = 0.5
#: What counts as nothing beside a side of a cell.
NOTHING = 1e-6
#: Points along a side of a cell by which the distance from a line is measured: off by a fiftieth at most.
POINTS = 12


def cut(distance: Float[ArrayLike, " 4"]) -> Float[Array, "3"]:
    """(share of a square where the distance is positive, unit normal towards there), of the distances at its corners.

    Args:
        distance: counterclockwise from the lower left.
    """
    p00, p10, p11, p01 = distance
    slope = 0.5 * jnp.array([p10 - p00 + p11 - p01, p01 - p00 + p11 - p10])
    squared = slope @ slope
    normal = jnp.where(squared > NOTHING**2, slope, jnp.array([1.0, 0.0]))
    normal = normal / jnp.sqrt(normal @ normal)
    low, high = jnp.sort(jnp.abs(normal))
    low = jnp.maximum(low, NOTHING)
    reach = low + high
    # Distance of the line from the farthest corner on the other side; the share is symmetric about the middle.
    depth = jnp.clip(
        0.25 * distance.sum() / jnp.sqrt(jnp.maximum(squared, SMALLEST_SLOPE**2)) + 0.5 * reach, 0.0, reach
    )
    nearer = jnp.minimum(depth, reach - depth)
    share = jnp.where(nearer < low, nearer**2 / (2.0 * low * high), (nearer - 0.5 * low) / high)
    return jnp.concatenate([jnp.where(depth > 0.5 * reach, 1.0 - share, share)[None], normal])


def _in_sheet(corners: Float[ArrayLike, " 4"], sides: Float[ArrayLike, " 2"]) -> Float[Array, "3"]:
    """As :func:`cut`, with the normal in the sheet, where cells have these sides."""
    found = cut(corners)
    normal = found[1:] / sides
    return jnp.concatenate([found[:1], normal / jnp.sqrt(normal @ normal)])


#: Of many cells at once, the last axis of what is given and found.
_CUT, _SLOPE = (jax.jit(jax.vmap(each, -1, -1)) for each in (_in_sheet, jax.jacrev(_in_sheet)))


class ContourLines:
    """Lines on a mesh by their signed distance at its nodes (node,).

    Args:
        mesh: rectilinear, cells may be missing.
    """

    def __init__(self, mesh: Mesh):
        self.mesh = mesh
        lines = mesh.lines
        self._shape = len(lines[1]), len(lines[0])
        self._place = np.divmod(mesh.places, self._shape[1])
        corners = mesh.nodes[mesh.cells]
        self._sides = np.ptp(corners, axis=1)

    def through(self, share: Float[np.ndarray, " cell"]) -> Float[np.ndarray, " node"]:
        """Distance from a line that leaves about these shares of the cells on its positive side."""
        cells, nodes = self.mesh.cells, len(self.mesh.nodes)
        each = np.repeat(2.0 * share - 1.0, cells.shape[1])
        mean = np.bincount(cells.ravel(), each, nodes) / np.bincount(cells.ravel(), minlength=nodes)
        return self.distance(np.where(mean == 0.0, NOTHING, mean))

    def cells(self, distance: Float[np.ndarray, " node"]):
        """(share of every cell where the distance is positive (cell,), unit normal towards there (cell, 2))."""
        found = in_blocks(_CUT, distance[self.mesh.cells].T, self._sides.T)
        return found[0], found[1:].T

    def slopes(self, distance: Float[np.ndarray, " node"], some: Int[np.ndarray, " some"]):
        """Derivatives of share and normal of :meth:`cells` by the distances at the corners (some, 4), (some, 2, 4).

        Args:
            some: numbers of cells.
        """
        found = np.moveaxis(in_blocks(_SLOPE, distance[self.mesh.cells[some]].T, self._sides[some].T), -1, 0)
        return found[:, 0], found[:, 1:]

    def distance(self, values: Float[np.ndarray, " node"], fewest: int = 1) -> Float[np.ndarray, " node"]:
        """Signed distance from the zero line of ``values``; that across the grid where there is none.

        Args:
            fewest: regions of fewer nodes than that join what is around them.
        """
        grid = self._on_grid(values)
        for sign in (1.0, -1.0):
            regions, count = scipy.ndimage.label(sign * grid > 0.0)
            size = np.bincount(regions.ravel(), minlength=count + 1)
            small = (regions > 0) & (size[regions] < fewest)
            grid[small] = -0.5 * sign
        signs = np.sign(grid[self._place])
        lines = find_contours(grid, 0.0)
        if not lines:
            return signs * np.hypot(*grid.shape)
        step = np.linspace(0.0, 1.0, POINTS, endpoint=False)[:, None]
        points = [one + step * (other - one) for line in lines for one, other in pairwise(line)]
        far, _ = cKDTree(np.concatenate(points)).query(np.stack(self._place, axis=1))
        return signs * far

    def along(self, distance: Float[np.ndarray, " node"], reach: float, apart: float) -> scipy.sparse.csr_matrix:
        """How distances follow when points of the line move along its normal (node, point of the line).

        Between points, what moves is linear along the line. A node follows the place of the line that is nearest to it.

        Args:
            reach: nodes farther than that from the line do not follow.
            apart: distance between points, about.
        """
        places, numbers, shares, count = [], [], [], 0
        for line in find_contours(self._on_grid(distance), 0.0):
            arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
            pieces, closed = max(round(arc[-1] / apart), 1), np.array_equal(line[0], line[-1])
            own = pieces if closed else pieces + 1
            at = np.linspace(0.0, arc[-1], POINTS * pieces, endpoint=False)
            first = np.minimum((at / arc[-1] * pieces).astype(int), pieces - 1)
            places.append(np.stack([np.interp(at, arc, axis) for axis in line.T], axis=1))
            numbers.append(count + np.stack([first, (first + 1) % own], axis=1))
            shares.append(at / arc[-1] * pieces - first)
            count += own
        near = np.flatnonzero(np.abs(distance) < reach)
        if not places or not len(near):
            return scipy.sparse.csr_matrix((len(distance), 0))
        _, nearest = cKDTree(np.concatenate(places)).query(np.stack(self._place, axis=1)[near])
        share, columns = np.concatenate(shares)[nearest], np.concatenate(numbers)[nearest]
        values = np.stack([1.0 - share, share], axis=1)
        entries = values.ravel(), (np.repeat(near, 2), columns.ravel())
        found = scipy.sparse.csc_matrix(entries, (len(distance), count))
        return found[:, np.flatnonzero(np.diff(found.indptr))].tocsr()

    def as_one(self, distance: Float[np.ndarray, " node"]) -> scipy.sparse.csr_matrix:
        """How distances follow when the line moves as a whole, along x and along y, in sides of cells (node, 2)."""
        by_y, by_x = np.gradient(self._on_grid(distance))
        moved = -np.stack([by_x[self._place], by_y[self._place]], axis=1)
        return scipy.sparse.csr_matrix(np.nan_to_num(moved))

    def length(self, distance: Float[np.ndarray, " node"]) -> float:
        """Length of the line."""
        lines = self.mesh.lines
        total = 0.0
        for line in find_contours(self._on_grid(distance), 0.0):
            y, x = (np.interp(line[:, k], np.arange(self._shape[k]), lines[1 - k]) for k in range(2))
            total += float(np.hypot(np.diff(x), np.diff(y)).sum())
        return total

    @cached_property
    def bends(self) -> scipy.sparse.csr_matrix:
        """Second differences of values at every three nodes in a row or a column (three, node), -2 in the middle."""
        number = np.full(self._shape, -1)
        number[self._place] = np.arange(len(self.mesh.nodes))
        threes = [np.stack([n[:-2], n[1:-1], n[2:]]).reshape(3, -1) for n in (number, number.T)]
        threes = np.concatenate(threes, axis=1)
        threes = threes[:, (threes >= 0).all(axis=0)]
        rows = np.tile(np.arange(threes.shape[1]), 3)
        weights = np.repeat([1.0, -2.0, 1.0], threes.shape[1])
        return scipy.sparse.csr_matrix((weights, (rows, threes.ravel())), (threes.shape[1], len(self.mesh.nodes)))

    def _on_grid(self, values):
        grid = np.full(self._shape, np.nan)
        grid[self._place] = values
        return grid
