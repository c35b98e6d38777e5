"""Transfer of materials and lines from a coarser grid to the measured one."""

import dataclasses

import numpy as np

from hypernode.fem.transfer import transfer
from hypernode.identification import budgets
from hypernode.identification.candidate import Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.mosaic import Mosaic
from hypernode.identification.trials import Trials

#: Sides of a coarse cell in those of a measured one.
SIDES = 2.0


def on_measured_grid(trials: Trials, coarse: Candidate, steps: list[int], finds_window: bool) -> Candidate | None:
    """The candidate of a coarser grid after a descent on the measured grid; None without equilibrium.

    Points of lines stay as far apart as on the coarser grid.

    Args:
        trials: on the measured grid; those of the coarser one join them.
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """
    problem, before = trials.problem(coarse.terms), coarse.fit.field
    grid, of_grid = problem.observations.grid, coarse.problem.observations.grid
    lines = Lines.of(grid, problem.refinement)
    to_grid, to_mesh = transfer(of_grid, grid), transfer(coarse.problem.mesh, problem.mesh)
    lines = dataclasses.replace(lines, apart=SIDES * before.lines.apart)
    if isinstance(before, Mosaic):
        field = Interfaces.around(lines, before.materials, before.of_cells[to_grid.cells])
    else:
        distances = np.array([SIDES * (to_grid.nodes @ row) for row in before.distances])
        field = Interfaces(lines, before.materials, distances.reshape(len(before.distances), len(grid.nodes)))
    if before.lines.splines is not None:
        field = field.changing(before.grid_factor()[to_grid.cells], before.lines.splines.bend)
        field = dataclasses.replace(field, turn=before.turn)
    u = {step: to_mesh.nodes @ each for step, each in coarse.u.items()}
    window = SIDES * coarse.fit.window if finds_window else None
    return trials.descend(
        "on the measured grid", coarse, problem, field, u, steps, budgets.FAR, window, finds_window, settled=False
    )
