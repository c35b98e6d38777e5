"""Finite-element computation of unseen loads with the identified field, compared with the true one."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from hypernode.fem.mesh import EDGE_NAMES, Mesh
from hypernode.fem.solver import ConvergenceError, EquilibriumSolver
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.loads import Load
from hypernode.progress import Progress
from hypernode.synthetic.forward import resultants


@dataclass(frozen=True)
class Response:
    """Response of a sheet to several loads, their steps in one sequence; NaN for a load without equilibrium.

    Attributes:
        u: displacement.
        edge_force: outward resultants per unit thickness.
    """

    u: Float[np.ndarray, "step node 2"]
    edge_force: Float[np.ndarray, "step edge 2"]


def identified_sheet(
    mesh: Mesh, node: NodeMaterial, node_params: Float[np.ndarray, "cell parameter"]
) -> EquilibriumSolver:
    """The sheet with the identified material in its cells."""
    return EquilibriumSolver(
        mesh,
        lambda F, p: node_stress(node, F[..., None], p["node"][:, None])[..., 0],
        {"node": jnp.asarray(node_params)},
    )


def respond(solver: EquilibriumSolver, loads: Sequence[Load], progress: Progress) -> Response:
    """Solve every load; a message on standard error names a load without equilibrium."""
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
    return Response(np.stack(u), np.stack(forces))


def worst_error(
    found: Float[np.ndarray, "step ..."], true: Float[np.ndarray, "step ..."], load_case: Int[np.ndarray, " step"]
) -> float:
    """Relative L2 error over all steps of a load, the largest of all loads; NaN if a load has no equilibrium."""
    errors = [
        np.linalg.norm(found[load_case == k] - true[load_case == k]) / np.linalg.norm(true[load_case == k])
        for k in range(load_case.max() + 1)
    ]
    return float(np.max(errors))


def compare(found: Response, true: Response, load_case: Int[np.ndarray, " step"]) -> dict[str, float]:
    """Summary of a validation: worst errors, and the number of loads without equilibrium."""
    without = np.isnan(found.u + true.u).any(axis=(1, 2))
    return {
        "unseen_displacement_error": worst_error(found.u, true.u, load_case),
        "unseen_force_error": worst_error(found.edge_force, true.edge_force, load_case),
        "unseen_without_equilibrium": len({int(k) for k in load_case[without]}),
    }
