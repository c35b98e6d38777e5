"""What lines make of the cells of a mesh when materials are laid one over the other, as coats of paint."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from hypernode.fem.contour import ContourLines
from hypernode.identification import numerics


class Cut(NamedTuple):
    """How a line cuts each cell.

    Attributes:
        line: its number, -1 where there is none (cell,).
        share: of the cell on its positive side (cell,).
        normal: unit vector towards there (cell, 2).
    """

    line: Int[np.ndarray, " cell"]
    share: Float[np.ndarray, " cell"]
    normal: Float[np.ndarray, "cell 2"]

    @classmethod
    def none(cls, count: int) -> "Cut":
        """Of no cell."""
        return cls(np.full(count, -1), np.zeros(count), np.tile([1.0, 0.0], (count, 1)))

    def where(self, some, other: "Cut") -> "Cut":
        """These in some cells, and others elsewhere."""
        return Cut(*(np.where(some.reshape(-1, *(1,) * (a.ndim - 1)), a, b) for a, b in zip(self, other, strict=True)))


@dataclass(frozen=True, kw_only=True)
class Pieces:
    """Pairs of layers of cells that lines cut.

    Attributes:
        cell: number of the cell of each pair of layers (piece,).
        first, second: materials on the positive and on the other side (piece,).
        share: of the first (piece,).
        normal: of the plane between them, towards the first (piece, 2).
        weight: of the pair in its cell; those of a cell add up to one (piece,).
    """

    cell: Int[np.ndarray, " piece"]
    first: Int[np.ndarray, " piece"]
    second: Int[np.ndarray, " piece"]
    share: Float[np.ndarray, " piece"]
    normal: Float[np.ndarray, "piece 2"]
    weight: Float[np.ndarray, " piece"]


class Cuts(NamedTuple):
    """Which lines decide pairs of layers (piece,).

    Attributes:
        line: the one between both layers, -1 where they are of one material.
        low, up: the lines that cut the cell, -1 where only the upper one does.
        weight_by_low, weight_by_up: derivative of the weight by the shares of both.
    """

    line: Int[np.ndarray, " piece"]
    low: Int[np.ndarray, " piece"]
    up: Int[np.ndarray, " piece"]
    weight_by_low: Float[np.ndarray, " piece"]
    weight_by_up: Float[np.ndarray, " piece"]


def laid(contours: ContourLines, distances) -> tuple[Int[np.ndarray, " cell"], Cut, Cut]:
    """(material under all lines of a cell, the lower and the upper line that cut it); of three the lowest is none."""
    count = len(contours.mesh.cells)
    base, low, up = np.zeros(count, int), Cut.none(count), Cut.none(count)
    for k, distance in enumerate(distances):
        share, normal = contours.cells(distance)
        whole = share > 1.0 - numerics.SMALLEST_LAYER
        cut = (share > numerics.SMALLEST_LAYER) & ~whole
        third = cut & (low.line >= 0)
        base = np.where(whole, k + 1, np.where(third & (low.share > 0.5), low.line + 1, base))
        low = Cut.none(count).where(whole, up.where(cut, low))
        up = Cut.none(count).where(whole, Cut(np.full(count, k), share, normal).where(cut, up))
    return base, low, up


def layers_of(base, low: Cut, up: Cut, once, twice) -> tuple[Pieces, Cuts]:
    """Pairs of layers of cells that one line cuts, and of those that two lines cut.

    Where two lines cut a cell, either may part it first. What lies on its two sides is then the mean of what the other
    line leaves there. Both answers count, each by how evenly its line parts the cell, so that nothing jumps where a
    line leaves a cell.
    """
    c, d = low.share[twice], up.share[twice]
    q, r = c * (1.0 - c), d * (1.0 - d)
    w, by_c, by_d = q / (q + r), (1.0 - 2.0 * c) * r / (q + r) ** 2, -q * (1.0 - 2.0 * d) / (q + r) ** 2
    lower, upper, below = low.line[twice] + 1, up.line[twice] + 1, base[twice]
    none = np.full(len(twice), -1)
    #: First and second material, line between them, weight, its derivatives by c and d.
    four = [
        (lower, below, low.line[twice], w * (1.0 - d), by_c * (1.0 - d), by_d * (1.0 - d) - w),
        (upper, upper, none, w * d, by_c * d, by_d * d + w),
        (upper, lower, up.line[twice], (1.0 - w) * c, 1.0 - w - by_c * c, -by_d * c),
        (upper, below, up.line[twice], (1.0 - w) * (1.0 - c), w - 1.0 - by_c * (1.0 - c), -by_d * (1.0 - c)),
    ]
    nothing, one = np.zeros(len(once)), np.ones(len(once))
    parts = [(up.line[once] + 1, base[once], up.line[once], one, nothing, nothing), *four]
    first, second, line, weight, by_low, by_up = (np.concatenate(each) for each in zip(*parts, strict=True))
    cell = np.concatenate([once, *4 * [twice]])
    share, normal = np.where(line == low.line[cell], low.share[cell], up.share[cell]), up.normal[cell]
    normal = np.where((line == low.line[cell])[:, None], low.normal[cell], normal)
    pieces = Pieces(cell=cell, first=first, second=second, share=share, normal=normal, weight=weight)
    return pieces, Cuts(line, low.line[cell], up.line[cell], by_low, by_up)
