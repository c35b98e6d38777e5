"""More pieces of materials, where a factor of the stiffness in every cell asks for them.

Where an inclusion just reaches the edge, its piece is smaller than a few cells. The cut into parts leaves it out, and
no line that moves finds it. What it leaves of the displacements may be most of what is no noise
(docs/decisions/0199).
"""

import dataclasses

import numpy as np
from jaxtyping import Float, Int

from hypernode.identification.candidate import EVIDENCE, Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.parting import Beside, Parting
from hypernode.identification.trials import FAR

#: How far towards another material the factor of a cell goes from which a part of the cell may be of that material.
WAY = 1.0 / 3.0
#: How far a piece begins to reach from the centre of its cell, in sides of cells: just beyond the corners.
REACHES = 0.8


def with_pieces(parting: Parting, kept: Candidate, beside: Beside) -> Candidate:
    """A candidate with more pieces of its materials, if it is better.

    A cell whose factor, on top of what is known, makes it nearly as stiff as another material becomes a piece of that
    one. All such pieces are tried together, and their lines move.

    Args:
        kept: on elements of the grid.
        beside: a factor in every cell on top of it.
    """
    field, trials = kept.fit.field, parting.trials
    labels = beside.towards(WAY)
    if (labels == field.labels()).all():
        return kept
    added, window = _added(field, labels), kept.fit.window
    # Distances that are measured anew have no regions of fewer nodes than a cell's.
    move, problem = "pieces of the same materials", kept.problem
    found = trials.descend(
        move, kept, problem, added, beside.reached, parting.steps, FAR, window, parting.finds_window, settled=True
    )
    if found is None:
        return kept
    gain = found.gain_over(kept)
    better, other, word = (found, kept, "with") if gain > EVIDENCE else (kept, found, "without")
    trials.passed_over(other, f"scores {abs(gain):+.1f} against the same {word} these pieces")
    return better


def _added(field: Interfaces, labels: Int[np.ndarray, " cell"]) -> Interfaces:
    """The field with pieces of materials in the cells whose label is another one."""
    before, distances = field.labels(), field.distances.copy()
    for cell in np.flatnonzero(labels != before):
        piece = REACHES - _from_centre(field, cell)
        for k in range(max(labels[cell], 1), field.count):
            # What is laid later would hide the piece.
            own = k == labels[cell]
            distances[k - 1] = np.maximum(distances[k - 1], piece) if own else np.minimum(distances[k - 1], -piece)
    return dataclasses.replace(field, distances=distances)


def _from_centre(field: Interfaces, cell: int) -> Float[np.ndarray, " node"]:
    """Distance of every node of the grid from the centre of a cell, in sides of cells."""
    mesh = field.lines.grid.mesh
    places = np.stack(np.divmod(mesh.places, len(mesh.lines[0])), axis=1)
    return np.linalg.norm(places - places[mesh.cells[cell]].mean(axis=0), axis=1)
