"""Numbers of every cell that explain what a field of materials leaves: a factor of the stiffness, and fibres.

They add to parameters of the materials and are found by Gauss-Newton steps on all cells at once. The penalty on jumps
is total variation first, then its logarithm, so jumps stay sharp. A jump costs once, whichever numbers make it. The
residual of the displacements serves as their noise, so steps far from the solution are small. Cells far from jumps
share their numbers, which keeps the systems small.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.config.methods import Constrained
from hypernode.fem.mesh import Mesh
from hypernode.identification import budgets, numerics
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.regulariser import JumpCost, Jumps
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.sheet import CellMaterials


class ByCell(NamedTuple):
    """What a descent left.

    Attributes:
        values: added to parameters of the materials of every cell (cell, number).
        states: equilibrium of every step.
        misfit: root mean square of the displacements' misfit over their noise.
        groups: number of the group of cells that share numbers, of each (cell,).
    """

    values: Float[np.ndarray, "cell number"]
    states: list
    misfit: float
    groups: Int[np.ndarray, " cell"]

    def halves(self, other: "ByCell") -> bool:
        """Whether these numbers leave less than half of the squares that others leave of the same steps."""
        return bool(self.misfit**2 < 0.5 * other.misfit**2)


class Shifted:
    """A field whose materials differ from cell to cell.

    Args:
        of: the materials of cells.
        columns: parameters that differ.
        values: by how much (cell, number).
    """

    def __init__(self, of: CellMaterials, columns: list[int], values: Float[np.ndarray, "cell number"]):
        cells, pieces = np.arange(len(of.one)), np.arange(len(of.cell))
        material = np.concatenate([of.one, of.first, of.second])
        materials = of.materials[material]
        materials[:, columns] += values[np.concatenate([cells, of.cell, of.cell])]
        first = len(cells) + pieces
        self._of = replace(of, materials=materials, one=cells, first=first, second=first + len(pieces))

    def cells(self) -> tuple[CellMaterials, None]:
        """(what every cell is of, no lines that move)."""
        return self._of, None


def blocks(mesh: Mesh, side: int) -> Int[np.ndarray, " cell"]:
    """Number of the block of so many cells along a side that each belongs to."""
    row, column = np.divmod(mesh.places[mesh.cells[:, 0]], len(mesh.lines[0]))
    return np.unique(np.stack([row // side, column // side]), axis=1, return_inverse=True)[1].ravel()


def divided_near_jumps(mesh: Mesh, found: ByCell, least: float) -> Int[np.ndarray, " cell"]:
    """The same groups, those that touch a jump of more than this size divided into cells."""
    pairs, groups = mesh.touching(), found.groups
    jump = np.linalg.norm(found.values[pairs[:, 0]] - found.values[pairs[:, 1]], axis=1) > least
    beside = np.zeros(groups.max() + 1, bool)
    beside[groups[pairs[jump]].ravel()] = True
    finer = np.where(beside[groups], groups.max() + 1 + np.arange(len(groups)), groups)
    return np.unique(finer, return_inverse=True)[1]


class CellDescent:
    """Descents of numbers of every cell on top of a field.

    Args:
        settings: configuration of the stage, which says what jumps cost.
        columns: parameters that the numbers add to.
    """

    def __init__(self, test: SeenTest, field: Interfaces, settings: Constrained, columns: list[int]):
        self._test, self._weight, self._columns = test, settings.regulariser_weight, columns
        self._of, _ = field.cells()
        mesh = test.sheet.mesh
        self._jumps, self._jump_scale = Jumps(mesh, np.sqrt(mesh.areas.mean())), settings.jump_scale

    def of_blocks(
        self, guesses, starts: Float[np.ndarray, "start number"], others: ByCell | None = None
    ) -> ByCell | None:
        """Where a descent of blocks ends; None without equilibrium.

        Args:
            starts: numbers from which all cells may begin; one is kept, that of which a few steps leave least.
            others: fewer numbers of every cell, at which these begin. Small blocks follow only if large ones leave less
                than half of their squares.
        """
        mesh, best = self._test.sheet.mesh, None
        groups = blocks(mesh, numerics.BLOCKS[0])
        for start in starts:
            values = np.tile(start, (len(mesh.cells), 1))
            if others is not None:
                values[:, : others.values.shape[1]] += others.values
            found = self._descend(values, guesses, groups, budgets.CONVEX_FACTOR_STEPS)
            if found is not None and (best is None or found.misfit < best.misfit):
                best = found
        if best is None:
            return None
        if others is not None and not best.halves(others):
            return best
        return self._on(best, blocks(mesh, numerics.BLOCKS[1]), budgets.FACTOR_STEPS, budgets.CONVEX_FACTOR_STEPS // 2)

    def of_cells(self, found: ByCell) -> ByCell:
        """Where a descent goes on once cells near jumps have numbers of their own."""
        groups = divided_near_jumps(self._test.sheet.mesh, found, self._jump_scale)
        return self._on(
            found, groups, budgets.CONVEX_FACTOR_STEPS + budgets.CELL_FACTOR_STEPS, budgets.CONVEX_FACTOR_STEPS
        )

    def _on(self, found: ByCell, groups, most: int, done: int) -> ByCell:
        """Where a descent goes on with other groups."""
        guesses = [u for u, _, _ in found.states]
        further = self._descend(found.values, guesses, groups, most, done)
        return found if further is None else further

    def _cost(self, values, jump_cost: JumpCost) -> float:
        """Cost of the jumps."""
        return self._weight * self._jumps.value(values, jump_cost)

    def _loads(self, field: Shifted, states, members):
        """Derivative of the nodal forces by the numbers of every group, number by number, by step."""
        mesh, (of, _), found = self._test.sheet.mesh, field.cells(), []
        for u, _, _ in states:
            response = self._test.sheet.cell_response(u, of)
            force = response.by_one[:, :, self._columns]
            np.add.at(force, of.cell, (response.by_first + response.by_second)[:, :, self._columns])
            rows, columns = mesh.dofs.ravel(), np.repeat(np.arange(len(force)), 8)
            shape = mesh.nodes.size, len(force)
            each = (
                scipy.sparse.csr_matrix((part.ravel(), (rows, columns)), shape) for part in np.moveaxis(force, 2, 0)
            )
            found.append(scipy.sparse.hstack([part @ members for part in each], format="csr"))
        return found

    def _descend(self, values, guesses, groups, most: int, done: int = 0) -> ByCell | None:
        members = scipy.sparse.csr_matrix((np.ones(len(groups)), (np.arange(len(groups)), groups)))
        test, field = self._test, Shifted(self._of, self._columns, values)
        states, sigma = test.states(field, guesses), np.inf
        if states is None:
            return None
        for number in range(done, most):
            convex = number < budgets.CONVEX_FACTOR_STEPS
            jump_cost = JumpCost(scale=None if convex else self._jump_scale, isotropic=True)
            sigma = test.sigma_of(states, sigma)
            shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
            answers = list(test.answers(states, self._loads(field, states, members)))
            curvature, gradient = shared.normal((answer.over(sigma) for answer in answers), residuals)
            before = 0.5 * shared.squared(residuals) + self._cost(values, jump_cost)
            step = self._step(curvature, gradient, values, members, jump_cost)
            step = np.clip(step, -numerics.LARGEST_STEP, numerics.LARGEST_STEP)
            moved = None
            for fraction in numerics.FACTOR_FRACTIONS:
                trial = values + fraction * step[groups]
                there = Shifted(self._of, self._columns, trial)
                reached = test.followed(there, states, answers, fraction * step.T.ravel())
                if reached is None:
                    continue
                after = 0.5 * shared.squared(test.residuals(reached, sigma)) + self._cost(trial, jump_cost)
                if after < before:
                    moved = before - after
                    break
            if moved is None:
                break
            values, states, field = trial, reached, there
            if moved < numerics.FACTOR_GAIN * before and not convex:
                break
        return ByCell(values, states, test.left(states), groups)

    def _step(self, curvature, gradient, values, members, jump_cost):
        """Change of the numbers of every group of cells (group, number)."""
        count = len(self._columns)
        every = scipy.sparse.block_diag([members] * count, format="csr")
        step = np.zeros(every.shape[1])
        held = 1e-3 * np.diag(curvature).mean() * np.eye(len(step))
        for _ in range(budgets.WEIGHT_ROUNDS):
            D, _ = self._jumps.roots(values + (every @ step).reshape(count, -1).T, jump_cost)
            R = self._weight * (D.T @ D)
            of_blocks = scipy.sparse.block_diag([members.T @ R @ members] * count).toarray()
            factors = scipy.linalg.cho_factor(curvature + held + of_blocks, overwrite_a=True, check_finite=False)
            pull = np.concatenate([members.T @ (R @ column) for column in values.T])
            step = -scipy.linalg.cho_solve(factors, gradient + pull)
        return step.reshape(count, -1).T
