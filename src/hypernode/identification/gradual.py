"""A property that changes gradually over a sheet: splines with a penalty on their second differences.

The logarithm of a factor is a tensor product of cubic B-splines. Second differences of neighbouring coefficients cost
their square (Eilers and Marx, Flexible smoothing with B-splines and penalties, Statistical Science 11, 1996).
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from jaxtyping import Float
from scipy.interpolate import BSpline

from hypernode.fem.mesh import Mesh
from hypernode.identification import priors
from hypernode.identification.sheet import CellResponse

DEGREE = 3


@dataclass(frozen=True)
class Splines:
    """Splines at the centres of cells.

    Attributes:
        fine, grid: values in the cells of the finite elements and of the measured grid, by coefficient (cell, spline).
        held: inverse covariance of the coefficients without data (spline, spline).
        bend: expected second difference of neighbouring coefficients.
    """

    fine: scipy.sparse.csr_matrix
    grid: scipy.sparse.csr_matrix
    held: scipy.sparse.csr_matrix
    bend: float

    @classmethod
    def of(cls, grid: Mesh, fine: Mesh, bend: float) -> "Splines":
        """On a measured grid and the mesh that divides it."""
        counts = [max(round((len(line) - 1) / priors.CELLS_BETWEEN_KNOTS), 1) for line in grid.lines]
        x, y = (scipy.sparse.identity(count + DEGREE) for count in counts)
        across, up = (_second_differences(count + DEGREE) for count in counts)
        bends = scipy.sparse.vstack([scipy.sparse.kron(y, across), scipy.sparse.kron(up, x)]) / bend
        held = bends.T @ bends + scipy.sparse.identity(bends.shape[1]) / priors.GRADUAL_SIZE**2
        return cls(_values(fine, grid, counts), _values(grid, grid, counts), held.tocsr(), bend)

    def fitted(self, values: Float[np.ndarray, " cell"]) -> Float[np.ndarray, " spline"]:
        """Coefficients of the penalised fit to values in the cells of the grid."""
        return scipy.sparse.linalg.spsolve((self.grid.T @ self.grid + self.held).tocsc(), self.grid.T @ values)


def of_mixture(log_factor: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """What a law turns by where the level has a factor: one over the level falls by it."""
    return -np.expm1(-log_factor)


def turned(log_factor: Float[np.ndarray, " cell"], turn: Float[np.ndarray, " turned"]):
    """What is added to the parameters of every cell, beside its factor (cell, parameter); zero where no law turns.

    Energies of a mixture are linear in its shares. So coefficients over the level are linear in one over the level.

    Args:
        turn: of every parameter but the level, what is added to it where the level is much larger, or none.
    """
    return np.outer(of_mixture(log_factor), np.append(0.0, turn)) if len(turn) else 0.0


def loads_of_change(response: CellResponse, mesh: Mesh, splines: Splines, gradual, turn) -> list:
    """Derivatives of the nodal forces of a mesh by the coefficients of splines, and by what laws turn by."""
    by_turned, log_factor = response.by_one[:, :, 1 : 1 + len(turn)], (splines.fine @ gradual)[:, None]
    by_factor = response.by_factor + np.exp(-log_factor) * (by_turned @ turn)
    entries = by_factor.ravel(), (mesh.dofs.ravel(), np.repeat(np.arange(len(mesh.cells)), 8))
    by_cell = scipy.sparse.csr_matrix(entries, (mesh.nodes.size, len(mesh.cells)))
    by_turn = np.zeros((mesh.nodes.size, len(turn)))
    np.add.at(by_turn, mesh.dofs, by_turned * of_mixture(log_factor)[:, None])
    return [by_cell @ splines.fine, scipy.sparse.csr_matrix(by_turn)]


def _values(mesh: Mesh, grid: Mesh, counts) -> scipy.sparse.csr_matrix:
    """Values of all splines at the centres of the cells of a mesh (cell, spline)."""
    centres, found = mesh.nodes[mesh.cells].mean(axis=1), []
    for axis, (line, count) in enumerate(zip(grid.lines, counts, strict=True)):
        knots = np.linspace(line[0], line[-1], count + 1)
        padded = np.concatenate([np.repeat(knots[0], DEGREE), knots, np.repeat(knots[-1], DEGREE)])
        found.append(BSpline.design_matrix(centres[:, axis], padded, DEGREE).tocsr())
    x, y = (each.toarray() for each in found)
    return scipy.sparse.csr_matrix(np.einsum("cb,ca->cba", y, x).reshape(len(centres), -1))


def _second_differences(count: int) -> scipy.sparse.csr_matrix:
    return scipy.sparse.diags([1.0, -2.0, 1.0], [0, 1, 2], shape=(max(count - 2, 0), count), format="csr")
