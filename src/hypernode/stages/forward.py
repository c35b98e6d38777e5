"""Stage 1: equilibrium states of a synthetic sheet under its loads."""

import json
from collections.abc import Callable

import jax
import numpy as np

from hypernode.config import Config
from hypernode.mechanics.equilibrium import EDGE_NAMES
from hypernode.mechanics.loads import Load, make_load
from hypernode.progress import Progress
from hypernode.stages.equilibrium_solver import EquilibriumSolver, closed_form_stress
from hypernode.stages.fields import mesh_of
from hypernode.storage.netcdf import SYNTHETIC_UNITS, read, write


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


def run(config: Config, name: str, truth_file: str, output: str, attributes: dict) -> None:
    """Solve every load case of a synthetic sheet with JAX-FEM in float64.

    Raises:
        ConvergenceError: Newton's method fails; no file is written.
    """
    truth = read(truth_file)
    solver, stress, parameters = true_sheet(truth)
    at_points = jax.jit(jax.vmap(jax.vmap(stress, (0, None)), (0, 0)))
    case = config.cases[name]
    loads = [make_load(config.loads[key].kind, config.loads[key].stretches) for key in case.loads]
    progress = Progress("forward", name, sum(len(load.H) for load in loads))
    fields = {k: [] for k in ("u", "F_quadrature", "P_quadrature", "edge_force", "edge_constrained", "test")}
    fields |= {k: [] for k in ("stretch", "H", "newton_residual")}
    for number, load in enumerate(loads):
        u, residual = solver.solve(load, lambda step, history: progress.advance(residual=history[-1]))
        constrained = np.zeros((len(EDGE_NAMES), 2))
        for edge, component in load.constrained:
            constrained[EDGE_NAMES.index(edge), component] = 1.0
        for step, field in enumerate(u):
            F = solver.deformation_gradient(field)
            fields["u"].append(field)
            fields["F_quadrature"].append(F)
            fields["P_quadrature"].append(np.asarray(at_points(F, parameters)))
            fields["edge_force"].append(resultants(solver, field, load))
            fields["edge_constrained"].append(constrained)
            fields["test"].append(number)
            fields["stretch"].append(load.stretch[step])
            fields["H"].append(load.H[step])
            fields["newton_residual"].append(residual[step])
    variables = {key: np.stack(value) for key, value in fields.items()}
    variables |= {key: truth[key].values for key in ("X", "cells", "corners", "phase")}
    variables["X_quadrature"] = solver.quadrature_points
    write(
        output,
        variables,
        f"finite-element solution of {name}",
        {**attributes, "units": SYNTHETIC_UNITS, "tests": case.loads, "thickness": 1.0},
        parents=[truth_file],
    )
