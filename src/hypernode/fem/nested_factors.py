"""Cholesky factors of a sheet's tangent stiffness by nested dissection, for solves of many columns.

Lines of nodes halve the sheet again and again. What is on neither side of a line is eliminated last, so that the halves
meet nowhere else (George, Nested dissection of a regular finite element mesh, 1973). A sheet of n x n cells takes about
n^2 log n numbers instead of the 2 n^3 of its band. Each part has a dense front, so that a solve is products of
matrices.
"""

import functools
from typing import NamedTuple

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int
from scipy.linalg.lapack import dtrtri

#: Unknowns of a part that is not halved any more.
SMALLEST = 80


class Front(NamedTuple):
    """A part of the unknowns that are eliminated together.

    Attributes:
        first, last: which they are, in the order of elimination.
        above: those eliminated later that they meet, in rising order (later,).
        parts: numbers of the fronts whose elimination leaves something here.
    """

    first: int
    last: int
    above: Int[np.ndarray, " later"]
    parts: list[int]


class Order(NamedTuple):
    """An order of elimination.

    Attributes:
        unknowns: which unknown comes when (unknown,).
        fronts: in the order in which they are eliminated.
    """

    unknowns: Int[np.ndarray, " unknown"]
    fronts: list[Front]

    @classmethod
    def of(cls, matrix: scipy.sparse.csr_matrix, places: Float[np.ndarray, "unknown 2"]) -> "Order":
        """The order of the unknowns of a symmetric matrix by where they are."""
        groups: list[np.ndarray] = []
        below: list[list[int]] = []
        _halved(matrix, places, np.arange(len(places)), groups, below)
        unknowns = np.concatenate(groups)
        rank = np.empty(len(unknowns), int)
        rank[unknowns] = np.arange(len(unknowns))
        ends, fronts = np.cumsum([len(group) for group in groups]), []
        for group, end, parts in zip(groups, ends, below, strict=True):
            met = [rank[_rows(matrix, group)], *(fronts[part].above for part in parts)]
            met = np.unique(np.concatenate(met))
            fronts.append(Front(int(end) - len(group), int(end), met[np.searchsorted(met, end) :], parts))
        return cls(unknowns, fronts)


def _rows(matrix: scipy.sparse.csr_matrix, some: Int[np.ndarray, " some"]) -> Int[np.ndarray, " entry"]:
    """Columns of the entries of some rows."""
    return matrix[some].indices


def _halved(matrix, places, some, groups: list, below: list) -> list[int]:
    """Append the groups of some unknowns, and the groups that each stands on; returns the last ones."""
    if len(some) > SMALLEST:
        low, high = places[some].min(axis=0), places[some].max(axis=0)
        along = places[some, int(np.argmax(high - low))]
        near = along < np.median(along)
        # Of those beyond the middle, what meets those before it lies between.
        met = np.zeros(len(places), bool)
        met[_rows(matrix, some[near])] = True
        between = ~near & met[some]
        beyond = ~near & ~between
        if near.any() and beyond.any():
            ends = [end for half in (near, beyond) for end in _halved(matrix, places, some[half], groups, below)]
            if not between.any():
                return ends
            groups.append(some[between])
            below.append(ends)
            return [len(groups) - 1]
    groups.append(some)
    below.append([])
    return [len(groups) - 1]


class NestedFactors:
    """A = L L^T of a symmetric positive definite matrix.

    Args:
        places: of the unknowns in the sheet.

    Raises:
        numpy.linalg.LinAlgError: the matrix is not positive definite.
    """

    def __init__(self, matrix: scipy.sparse.spmatrix, places: Float[np.ndarray, "unknown 2"]):
        matrix = matrix.tocsr()
        self._order = _order(matrix, places)
        permuted = matrix[self._order.unknowns][:, self._order.unknowns].tocsr()
        #: (inverse of the diagonal block of L, block of L below it) of every front.
        self._blocks: list[tuple[np.ndarray, np.ndarray]] = []
        left: dict[int, np.ndarray] = {}
        place = np.empty(matrix.shape[0], int)
        for number, front in enumerate(self._order.fronts):
            own, rows = front.last - front.first, np.concatenate([np.arange(front.first, front.last), front.above])
            place[rows] = np.arange(len(rows))
            dense = np.zeros((len(rows), len(rows)))
            entries = permuted[front.first : front.last]
            column, row = entries.indices, np.repeat(np.arange(own), np.diff(entries.indptr))
            later = column >= front.first
            dense[place[column[later]], row[later]] = entries.data[later]
            for part in front.parts:
                where = place[self._order.fronts[part].above]
                dense[np.ix_(where, where)] += left.pop(part)
            half = np.linalg.cholesky(dense[:own, :own])
            pivot, _ = dtrtri(half, lower=1)
            under = dense[own:, :own] @ pivot.T
            left[number] = dense[own:, own:] - under @ under.T
            self._blocks.append((pivot, under))

    def solve(self, right: Float[np.ndarray, "unknown column"]) -> Float[np.ndarray, "unknown column"]:
        """A^-1 of every column."""
        x = np.ascontiguousarray(right[self._order.unknowns])
        each = list(zip(self._order.fronts, self._blocks, strict=True))
        for front, (pivot, under) in each:
            own = x[front.first : front.last]
            # Most parts bear no load of numbers that load a few nodes.
            if own.any():
                own[:] = pivot @ own
                x[front.above] -= under @ own
        for front, (pivot, under) in reversed(each):
            own = x[front.first : front.last]
            own[:] = pivot.T @ (own - under.T @ x[front.above])
        solved = np.empty_like(x)
        solved[self._order.unknowns] = x
        return solved


def _order(matrix: scipy.sparse.csr_matrix, places) -> Order:
    """The order of a matrix, computed once for tangents of one sheet, which have the same entries."""
    entries = (each.astype(np.int32).tobytes() for each in (matrix.indptr, matrix.indices))
    return _order_of(*entries, places.tobytes())


@functools.lru_cache(maxsize=1)
def _order_of(indptr: bytes, indices: bytes, places: bytes) -> Order:
    rows, columns = (np.frombuffer(each, np.int32) for each in (indptr, indices))
    pattern = scipy.sparse.csr_matrix((np.ones(len(columns)), columns, rows))
    return Order.of(pattern, np.frombuffer(places).reshape(-1, 2))
