"""Stage 1: equilibrium states of a synthetic sheet under its loads."""

import jax
import numpy as np

from hypernode.config.model import Config
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.mechanics.loads import make_load
from hypernode.progress import Progress
from hypernode.storage.netcdf import SYNTHETIC_UNITS, read, write
from hypernode.synthetic.forward import resultants, true_sheet


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
    fields = {k: [] for k in ("u", "F_quadrature", "P_quadrature", "edge_force", "edge_constrained", "load_case")}
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
            fields["load_case"].append(number)
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
        {**attributes, "units": SYNTHETIC_UNITS, "load_cases": case.loads, "thickness": 1.0},
        parents=[truth_file],
    )
