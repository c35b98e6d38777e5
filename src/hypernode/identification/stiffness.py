"""A stiffness factor in every cell that multiplies a field of materials and explains its residual.

The logarithm of the factor is found by Gauss-Newton steps on all cells at once. The penalty on jumps is total variation
first, then its logarithm, so jumps stay sharp. The residual of the displacements serves as their noise, so steps far
from the solution are small. Cells far from jumps share one value, which keeps the systems small.
"""

from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.mesh import Mesh
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.regulariser import CORNER_SHARE, SIDE_SHARE
from hypernode.identification.seen_test import SeenTest

#: Size below which a jump costs its square, and above which a larger one costs hardly more.
SMALLEST_JUMP, LARGEST_JUMP = 0.02, 0.05
#: Steps with total variation before larger jumps stop costing more, and at most in all.
CONVEX_STEPS, STEPS = 4, 12
#: Times that weights of jumps follow a step.
ROUNDS = 2
#: A step that gains less than this share of the cost ends the descent.
GAIN = 2e-3
#: Fractions of a step that are tried, and its largest change.
FRACTIONS, LARGEST_STEP = (1.0, 0.5, 0.2, 0.05), 1.0
#: Cells along a side of the blocks that move together at first.
BLOCK = 2


class Stiffness(NamedTuple):
    """What a descent left.

    Attributes:
        factor: logarithm of the factor (cell,).
        states: equilibrium of every step.
        misfit: root mean square of the displacements' misfit over their noise.
    """

    factor: Float[np.ndarray, " cell"]
    states: list
    misfit: float


def blocks(mesh: Mesh) -> Int[np.ndarray, " cell"]:
    """Number of the block of neighbouring cells of each."""
    row, column = np.divmod(mesh.places[mesh.cells[:, 0]], len(mesh.lines[0]))
    return np.unique(np.stack([row // BLOCK, column // BLOCK]), axis=1, return_inverse=True)[1].ravel()


def divided_near_jumps(mesh: Mesh, factor: Float[np.ndarray, " cell"], groups) -> Int[np.ndarray, " cell"]:
    """The same blocks, those that touch a jump divided into cells."""
    pairs = mesh.touching()
    jump = np.abs(factor[pairs[:, 0]] - factor[pairs[:, 1]]) > LARGEST_JUMP
    beside = np.zeros(groups.max() + 1, bool)
    beside[groups[pairs[jump]].ravel()] = True
    alone = beside[groups]
    finer = np.where(alone, groups.max() + 1 + np.arange(len(groups)), groups)
    return np.unique(finer, return_inverse=True)[1]


class StiffnessDescent:
    """Descents of factors on top of a field.

    Args:
        weight: cost of a jump of one along a side of a cell.
    """

    def __init__(self, test: SeenTest, field: Interfaces, weight: float):
        self._test, self._field, self._weight = test, field, weight
        self._of, _ = field.cells()
        mesh = test.sheet.mesh
        sides, length, _ = mesh.neighbours()
        corners, across = mesh.diagonal_neighbours()
        pairs, number = np.concatenate([sides, corners]), len(sides) + len(corners)
        entries = np.repeat([1.0, -1.0], number), (np.tile(np.arange(number), 2), pairs.T.ravel())
        self._difference = scipy.sparse.csr_matrix(entries, (number, len(mesh.cells)))
        self._length = np.concatenate([SIDE_SHARE * length, CORNER_SHARE * across]) / np.sqrt(mesh.areas.mean())

    def end(self, guesses) -> Stiffness | None:
        """Where descents of blocks, then of cells near jumps end; None without equilibrium."""
        mesh = self._test.sheet.mesh
        found = self._descend(np.zeros(len(mesh.cells)), guesses, blocks(mesh))
        if found is None:
            return None
        groups = divided_near_jumps(mesh, found.factor, blocks(mesh))
        return self._descend(found.factor, [u for u, _, _ in found.states], groups)

    def _cost(self, factor, convex: bool):
        """(cost of the jumps, weights of their squares)."""
        size = np.sqrt((self._difference @ factor) ** 2 + SMALLEST_JUMP**2)
        each = size if convex else LARGEST_JUMP * np.log1p(size / LARGEST_JUMP)
        weights = self._weight * self._length / size / (1.0 if convex else 1.0 + size / LARGEST_JUMP)
        return self._weight * float(self._length @ each), weights

    def _loads(self, test: SeenTest, states, members):
        """Derivative of the nodal forces by the factor of every group, by step."""
        mesh, found = test.sheet.mesh, []
        for u, _, _ in states:
            force = test.sheet.cell_forces(u, self._of)
            entries = force.ravel(), (mesh.dofs.ravel(), np.repeat(np.arange(len(force)), 8))
            found.append(scipy.sparse.csr_matrix(entries, (mesh.nodes.size, len(force))) @ members)
        return found

    def _descend(self, factor, guesses, groups) -> Stiffness | None:
        members = scipy.sparse.csr_matrix((np.ones(len(groups)), (np.arange(len(groups)), groups)))
        test = self._test.stiffer(np.exp(factor))
        states, sigma = test.states(self._field, guesses), np.inf
        if states is None:
            return None
        for number in range(STEPS):
            convex = number < CONVEX_STEPS
            sigma = test.sigma_of(states, sigma)
            shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
            curvature, gradient = shared.normal(
                test.answers(states, self._loads(test, states, members), sigma), residuals
            )
            before = 0.5 * shared.squared(residuals) + self._cost(factor, convex)[0]
            change = self._step(curvature, gradient, factor, members, convex)
            moved = None
            for fraction in FRACTIONS:
                trial = factor + fraction * np.clip(change, -LARGEST_STEP, LARGEST_STEP)
                there = self._test.stiffer(np.exp(trial))
                reached = there.states(self._field, [u for u, _, _ in states])
                if reached is None:
                    continue
                after = 0.5 * shared.squared(there.residuals(reached, sigma)) + self._cost(trial, convex)[0]
                if after < before:
                    moved = before - after
                    break
            if moved is None:
                break
            factor, states, test = trial, reached, there
            if moved < GAIN * before and not convex:
                break
        return Stiffness(factor, states, test.left(states))

    def _step(self, curvature, gradient, factor, members, convex):
        """Change of the factors of all cells."""
        step = np.zeros(members.shape[1])
        held = 1e-3 * np.diag(curvature).mean() * np.eye(len(step))
        for _ in range(ROUNDS):
            _, weights = self._cost(factor + members @ step, convex)
            R = self._difference.T @ scipy.sparse.diags(weights) @ self._difference
            matrix = curvature + held + (members.T @ R @ members).toarray()
            factors = scipy.linalg.cho_factor(matrix, overwrite_a=True, check_finite=False)
            step = -scipy.linalg.cho_solve(factors, gradient + members.T @ (R @ factor))
        return members @ step
