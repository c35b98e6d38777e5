"""Numbers of every cell, on top of materials and lines: where a search sees what these lack."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import stiffness_of
from hypernode.identification.partition import parts
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

    def parts(self, count: int):
        """(part of every cell, material of every part) of so many parts of about equal numbers."""
        numbers = self._of_materials[self.known.labels()] + self.found.values
        return parts(numbers, count, self.known, self.columns, self._of_materials)

    @property
    def _of_materials(self) -> Float[np.ndarray, "material number"]:
        """The stiffness of every material, and its own values of the other numbers."""
        numbers = self.known.materials[:, self.columns].copy()
        numbers[:, 0] = stiffness_of(self.problem, self.known.materials)
        return numbers
