"""Finite-element model updating of every cell's modulus, with a bound on roughness (Gokhale, Barbone and Oberai 2008).

The logarithms m of the moduli minimise the misfit of :mod:`hypernode.baselines.updating` and their total variation,

    T log(1 + misfit(m) / T) + sum l |m_a - m_b| / (L log 2),

over sides of length l that cells a and b of a sheet of side L share. T counts what is missed: a field a step, and each
force. A line across the sheet between moduli of one and two costs as much as a misfit of one hundredth. Without that
bound the problem is ill-posed. The logarithm is the profile likelihood of a misfit of unknown size, since a wrong law
leaves one. Roughness must lower it by a share. The minimum is found by Gauss-Newton's method, with sensitivities by
adjoint states (Oberai, Gokhale and Feijoo 2003).
"""

import numpy as np
import scipy.sparse
from jaxtyping import Float
from scipy.sparse.linalg import LinearOperator, cg

from hypernode.baselines.equilibrium_gap import BaselineError
from hypernode.baselines.updating import Sheet
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh

#: Jump of the logarithm across the whole sheet that costs as much as a misfit of one hundredth: a factor of two.
UNIT_JUMP = np.log(2.0)
#: Smaller jumps are smoothed rather than counted.
SMALLEST_JUMP = 0.01
#: The descent ends where an iteration lowers the cost by less than this share. It may take so many.
SMALLEST_GAIN, ITERATIONS = 1e-3, 100
#: Share of the gradient that the linear solution of an iteration leaves.
LINEAR_TOLERANCE, LINEAR_ITERATIONS = 0.03, 200
#: No logarithm of a modulus moves further in an iteration, and a step that does not lower the cost is halved so often.
LONGEST_STEP, HALVINGS = 0.7, 8


class Variation:
    """Total variation of a value of every cell, relative to :data:`UNIT_JUMP` across the sheet."""

    def __init__(self, mesh: Mesh):
        pairs, length, _ = mesh.neighbours()
        rows, signs = np.repeat(np.arange(len(pairs)), 2), np.tile([1.0, -1.0], len(pairs))
        self._jumps = scipy.sparse.csr_matrix((signs, (rows, pairs.ravel())), (len(pairs), len(mesh.cells)))
        self._share = length / (mesh.size.mean() * UNIT_JUMP)

    def cost(self, level: Float[np.ndarray, " cell"]) -> float:
        """The sum over sides, with small jumps smoothed."""
        return float(self._share @ (np.hypot(self._jumps @ level, SMALLEST_JUMP) - SMALLEST_JUMP))

    def curvature(self, level: Float[np.ndarray, " cell"]) -> scipy.sparse.csc_matrix:
        """W(m) with W m the derivative of :meth:`cost`, and in the place of its second one."""
        weight = self._share / np.hypot(self._jumps @ level, SMALLEST_JUMP)
        return (self._jumps.T @ scipy.sparse.diags(weight) @ self._jumps).tocsc()


def updated_field(sheet: Sheet, start: float) -> tuple[Float[np.ndarray, " cell"], int]:
    """(modulus of every cell, iterations), from one modulus ``start`` everywhere.

    Raises:
        BaselineError: the homogeneous sheet finds no equilibrium, or the descent does not converge.
    """
    level, variation = np.full(len(sheet.mesh.cells), np.log(start)), Variation(sheet.mesh)
    states = sheet.states(level)
    if states is None:
        raise BaselineError(f"a homogeneous sheet with the modulus {start:g} finds no equilibrium")
    cost = sheet.terms * np.log1p(_relative(sheet, states))
    for iteration in range(ITERATIONS):
        step = _step(sheet, level, states, variation.curvature(level))
        step *= LONGEST_STEP / max(LONGEST_STEP, np.abs(step).max())
        for halving in range(HALVINGS + 1):
            tried = level + 0.5**halving * step
            found = sheet.states(tried, near=states)
            reached = np.inf
            if found is not None:
                reached = sheet.terms * np.log1p(_relative(sheet, found)) + variation.cost(tried)
            if reached < cost:
                break
        if reached > (1.0 - SMALLEST_GAIN) * cost:
            return np.exp(level if reached > cost else tried), iteration
        level, states, cost = tried, found, reached
    raise BaselineError(f"model updating of cells did not converge within {ITERATIONS} iterations (cost {cost:.3g})")


def _relative(sheet: Sheet, states) -> float:
    """Mean square of what states miss, one hundredth of each term being one."""
    return float(np.sum(sheet.misfit(states) ** 2)) / sheet.terms


def _step(sheet: Sheet, level, states, W) -> Float[np.ndarray, " cell"]:
    """Gauss-Newton's step from a field, by conjugate gradients."""
    J = sheet.linearised(level, states)
    cells = len(level)
    weight = 2.0 / (1.0 + _relative(sheet, states))
    gradient = weight * J.rmatvec(sheet.misfit(states)) + W @ level
    probe = np.random.default_rng(0).choice([-1.0, 1.0], cells)
    # What the data say of a cell on average, in the place of what they say of each.
    told = weight * np.sum(J.matvec(probe) ** 2) / cells
    near = factorise(W + told * scipy.sparse.identity(cells, format="csc"))
    step, _ = cg(
        LinearOperator((cells, cells), matvec=lambda v: weight * J.rmatvec(J.matvec(v)) + W @ v, dtype=float),
        -gradient,
        rtol=LINEAR_TOLERANCE,
        maxiter=LINEAR_ITERATIONS,
        M=LinearOperator((cells, cells), matvec=near.solve, dtype=float),
    )
    return step
