"""Numbers of every cell, on top of materials and lines: where a search sees what these lack."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import stiffness_of
from hypernode.identification.partition import differ_inside, parts
from hypernode.identification.problem import FieldProblem
from hypernode.identification.stiffness import ByCell, CellDescent


class Beside(NamedTuple):
    """Numbers of every cell, on top of what is known.

    Attributes:
        problem: with the law that has these numbers.
        known: materials and lines.
        columns: parameters of the materials that the numbers add to.
        descent: of the numbers.
        found: the numbers, None without equilibrium.
        steps: load steps that they explain.
        u: displacement of every load step before.
    """

    problem: FieldProblem
    known: Interfaces
    columns: list[int]
    descent: CellDescent
    found: ByCell | None
    steps: list[int]
    u: dict

    @property
    def reached(self) -> dict:
        """Displacement of every load step with the numbers."""
        return {**self.u, **{k: state[0] for k, state in zip(self.steps, self.found.states, strict=True)}}

    def parts(self, count: int, squared: bool = False):
        """(part of every cell, material of every part) of so many parts of about equal numbers.

        Args:
            squared: of :func:`~hypernode.identification.partition.levels`.
        """
        numbers = self._of_materials[self.known.labels()] + self.found.values
        return parts(numbers, count, self.known, self.columns, self._of_materials, squared)

    def cuts(self, count: int) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """(how, part of every cell, material of every part) by each rule that gives so many parts.

        Beside two parts stand those that three levels make, the middle one with either of the others. A penalty on
        jumps leaves a gentle slope around what is stiff, which a cut in two may take for a part of it. A cut that lines
        of one before may become is left out.
        """
        every = [("", *self.parts(count)), (", cut by squares", *self.parts(count, squared=True))]
        if count == 2 and len(self.columns) == 1:
            every += self._of_three()
        found, seen, mesh = [], [], self.known.lines.grid.mesh
        for how, labels, materials in every:
            # Parts are numbered by their size, which says nothing of which is which.
            ordered = np.argsort(self._softest_first(materials))[labels]
            if len(materials) == count and all(differ_inside(mesh, ordered, other) for other in seen):
                found.append((how, labels, materials))
                seen.append(ordered)
        return found

    def _of_three(self) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """Two parts of three levels, as in :meth:`cuts`."""
        labels, materials = self.parts(3)
        if len(materials) < 3:
            return []
        soft, _, stiff = self._softest_first(materials)
        found = []
        for alone, how in ((stiff, "the stiffest of three levels"), (soft, "the softest of three levels")):
            apart, larger = labels == alone, min(set(range(3)) - {alone})
            order = [larger, alone] if 2 * apart.sum() <= len(labels) else [alone, larger]
            found.append((f", {how}", (apart == (order[1] == alone)).astype(int), materials[order]))
        return found

    def _softest_first(self, materials: Float[np.ndarray, "material parameter"]) -> Int[np.ndarray, " material"]:
        """Numbers of materials in the order of their stiffness."""
        return np.argsort(stiffness_of(self.problem, materials), kind="stable")

    def towards(self, way: float) -> Int[np.ndarray, " cell"]:
        """The material towards which the numbers of every cell go at least so far of the way; else its own.

        Args:
            way: share of the distance between two materials.
        """
        numbers = self._of_materials[self.known.labels()] + 0.5 / way * self.found.values
        return np.linalg.norm(numbers[:, None] - self._of_materials, axis=2).argmin(axis=1)

    @property
    def _of_materials(self) -> Float[np.ndarray, "material number"]:
        """The stiffness of every material, and its own values of the other numbers."""
        numbers = self.known.materials[:, self.columns].copy()
        numbers[:, 0] = stiffness_of(self.problem, self.known.materials)
        return numbers
