"""Stage 10: the identified field in a finite-element computation of loads that were not in the test."""

import sys

import numpy as np

from hypernode.fem.mesh import EDGE_NAMES
from hypernode.fem.solver import ConvergenceError
from hypernode.synthetic.forward import resultants


def _solve(solver, loads, progress):
    """(u[step, node, i], edge forces[step, edge, i]) of every load, NaN for a load without equilibrium."""
    u, forces = [], []
    for load in loads:
        try:
            fields, _ = solver.solve(load, lambda step, history: progress.advance(residual=history[-1]))
        except ConvergenceError as error:
            print(f"no equilibrium: {error}", file=sys.stderr)
            u += [np.full(solver.mesh.nodes.shape, np.nan)] * len(load.H)
            forces += [np.full((len(EDGE_NAMES), 2), np.nan)] * len(load.H)
            continue
        for field in fields:
            u.append(field)
            forces.append(resultants(solver, field, load))
    return np.stack(u), np.stack(forces)
