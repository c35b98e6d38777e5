"""Cells that would rather be of another material: a topological derivative of the misfit.

A line moves along its normal. So no descent makes a region, closes a gap, or parts two regions that touch. A cell of
another material loads its nodes with the difference of both stresses. Its deformation follows: in a disc that is m
times as stiff, shear is 2 / (1 + m) of what is around it (Eshelby, 1957). The materials, lines and their numbers follow
as well: what they explain is no gain.
"""

import numpy as np
import scipy.sparse
from jaxtyping import Int

from hypernode.identification import budgets, numerics
from hypernode.identification.candidate import Candidate
from hypernode.identification.contours import ContourModel, Options, relabelled
from hypernode.identification.interface_numbers import numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.promising import promising
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.trials import Trials


def with_other_cells(trials: Trials, kept: Candidate, steps: list[int], finds_window: bool) -> Candidate:
    """A candidate once no cell would rather be of another of its materials.

    All cells that would are tried together, and the lines move. What is left of displacements that is no more than the
    solver leaves says nothing of cells.

    Args:
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """
    for _ in range(budgets.OTHER_CELLS_ROUNDS):
        if kept.leaves_nothing:
            break
        problem, field, window = kept.problem, kept.fit.field, kept.fit.window
        test = SeenTest(problem, steps, window, kept.edges(problem, steps))
        labels = rather(test, field, test.with_tangents(field, kept.fit.states))
        changed = int((labels != field.labels()).sum())
        if not changed:
            break
        move, other = f"{changed} cells of another material", field.with_labels(labels)
        found = trials.descend(
            move, kept, problem, other, kept.u, steps, budgets.FAR, window, finds_window, settled=True
        )
        if found is None:
            break
        gain = found.gain_over(kept)
        better, worse = (found, kept) if gain > 0.0 else (kept, found)
        trials.passed_over(worse, f"scores {abs(gain):+.1f} against other cells")
        if better is kept:
            break
        kept = better
    return kept


def rather(test: SeenTest, field: Interfaces, states) -> Int[np.ndarray, " cell"]:
    """The material that every cell of the grid would rather be of.

    Args:
        states: equilibrium of every step of the test.
    """
    options, moves = field.options(), field.moves(numerics.LINE_REACH)
    each = [(loads_of_changes(test, field, u, options), field.loads(test.sheet, u, moves)) for u, _, _ in states]
    loads = [scipy.sparse.hstack(both, format="csc") for both in each]
    numbers = numbers_of(test.problem, field, moves, None)
    of_lines = np.arange(len(numbers.y)) >= numbers.of_materials
    held = numbers.held.toarray() + np.diag(of_lines * numbers.floor)
    dear = field.dearer(options)
    some = promising(test, states, loads, dear, held)
    columns, sigma = np.append(some, np.ones(len(held), bool)), test.sigma_of(states)
    jacobians = test.jacobians(states, [load[:, columns] for load in loads], sigma)
    normal = test.shared(states, sigma).normal(jacobians, test.residuals(states, sigma))
    options = options.those(some)
    model = ContourModel.followed(options, *normal, held, dear[some], field.sides)
    return relabelled(field.labels(), model)


def loads_of_changes(test: SeenTest, field: Interfaces, u, options: Options) -> scipy.sparse.csr_matrix:
    """Derivative of the nodal forces by changes of cells (degree of freedom, option).

    Args:
        u: displacement of a step in equilibrium.
    """
    of, mesh, inside = field.cells()[0], field.lines.fine.mesh, test.problem.refinement.subcells
    now = test.sheet.cell_forces(u, of)
    change = np.empty((field.count, *now.shape))
    for k in range(field.count):
        other = test.sheet.cell_forces(u, of.all_of(k))
        stiffer = np.linalg.norm(other, axis=1) / np.maximum(np.linalg.norm(now, axis=1), np.finfo(float).tiny)
        change[k] = (other - now) * (2.0 / (1.0 + stiffer))[:, None]
    cells = inside[options.cell]
    values, rows = change[options.label[:, None], cells], mesh.dofs[cells]
    columns = np.broadcast_to(np.arange(len(cells))[:, None, None], rows.shape)
    return scipy.sparse.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), (u.size, len(cells)))
