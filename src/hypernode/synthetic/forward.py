"""Stage 1: equilibrium states of a synthetic sheet under its loads."""

import json
from collections.abc import Callable

import numpy as np

from hypernode.data.measurement import mesh_of
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
from hypernode.mechanics.loads import Load


def true_sheet(truth) -> tuple[EquilibriumSolver, Callable, dict[str, np.ndarray]]:
    """(solver, stress law at a point, its parameters by cell) of an opened true-material file."""
    stress = closed_form_stress(tuple(json.loads(truth.attrs["models"])))
    parameters = {v.split(".", 1)[1]: truth[v].values for v in truth if v.startswith("material.")}
    return EquilibriumSolver(mesh_of(truth), stress, parameters), stress, parameters


def resultants(solver: EquilibriumSolver, u, load: Load) -> np.ndarray:
    """Outward force on each edge and component (edge, 2), zero where nothing is prescribed."""
    force = np.zeros((len(EDGE_NAMES), 2))
    for (edge, component), value in solver.edge_forces(u, load).items():
        force[EDGE_NAMES.index(edge), component] = value
    return force
