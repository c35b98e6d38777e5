"""Equilibrium states of a synthetic sheet under its loads."""

import json
from collections.abc import Callable, Sequence

import jax
import numpy as np

from hypernode.data.measurement import mesh_of
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
from hypernode.mechanics.loads import Load
from hypernode.progress import Progress


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


def solve_loads(truth, loads: Sequence[Load], name: str) -> dict[str, np.ndarray]:
    """Equilibrium of every step of every load, as variables of a file.

    Args:
        truth: an opened true material.
        loads: load cases, whose steps follow one another.
        name: case, for progress.

    Raises:
        ConvergenceError: Newton's method fails.
    """
    solver, stress, parameters = true_sheet(truth)
    at_points = jax.jit(jax.vmap(jax.vmap(stress, (0, None)), (0, 0)))
    progress = Progress("forward", name, sum(len(load.H) for load in loads))
    steps = []
    for number, load in enumerate(loads):
        u, residual = solver.solve(load, lambda step, history: progress.advance(residual=history[-1]))
        constrained = np.zeros((len(EDGE_NAMES), 2))
        for edge, component in load.constrained:
            constrained[EDGE_NAMES.index(edge), component] = 1.0
        for step, field in enumerate(u):
            F = solver.deformation_gradient(field)
            steps.append(
                {
                    "u": field,
                    "F_quadrature": F,
                    "P_quadrature": np.asarray(at_points(F, parameters)),
                    "edge_force": resultants(solver, field, load),
                    "nodal_force": solver.internal_force(field),
                    "edge_constrained": constrained,
                    "load_case": number,
                    "stretch": load.stretch[step],
                    "H": load.H[step],
                    "newton_residual": residual[step],
                }
            )
    variables = {key: np.stack([each[key] for each in steps]) for key in steps[0]}
    return variables | {"X_quadrature": solver.quadrature_points}
