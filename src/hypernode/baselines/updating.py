"""Finite-element model updating of a few moduli (Kavanagh and Clough 1971).

The moduli mu_r of regions minimise

    sum |u(mu) - u_measured|^2 / (N s^2) + sum (f(mu) - f_measured)^2 / (M (p |f|)^2),

where u(mu) is in equilibrium under the measured displacements of the edges that are held. With s a hundredth of what
the displacements of a step come away from affine ones, and p a hundredth, misfits of one hundredth count as one. The
minimum is found by trust-region least squares, with derivatives by differences, since there are few moduli.
"""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import least_squares

from hypernode.baselines.equilibrium_gap import NEO_HOOKEAN, BaselineError
from hypernode.data.loading import Loading
from hypernode.fem.mesh import EDGE_NAMES, EDGES, Mesh, tied_edge
from hypernode.fem.solver import EquilibriumSolver

#: Misfits of one hundredth count as one.
PERCENT = 0.01


def _held(mesh: Mesh, constrained) -> np.ndarray:
    """Flat degrees of freedom that keep their measured displacement."""
    mask = np.zeros((len(mesh.nodes), 2), bool)
    for edge, name in enumerate(EDGE_NAMES):
        mask[mesh.on_edge(name)] |= constrained[edge]
    for i in range(2):
        if not mask[:, i].any():
            mask[np.argmin(np.abs(mesh.nodes - mesh.lower).sum(axis=1)), i] = True
    return np.flatnonzero(mask.ravel())


def updated_moduli(
    mesh: Mesh, loading: Loading, u: Float[np.ndarray, "step node 2"], region: Int[np.ndarray, " cell"], start: float
) -> Float[np.ndarray, " cell"]:
    """The coefficient of every cell, one for each region, from the same ``start``.

    Raises:
        BaselineError: the search does not converge, or no sheet of the start is in equilibrium.
    """
    solver = EquilibriumSolver(
        mesh, lambda F, p: NEO_HOOKEAN.stress(F, p["params"]), {"params": jnp.zeros((len(mesh.cells), 1))}
    )
    affine = np.concatenate([mesh.nodes, np.ones((len(mesh.nodes), 1))], axis=1)
    size = PERCENT * np.stack([np.linalg.norm(each - affine @ np.linalg.lstsq(affine, each)[0]) for each in u])

    def misfit(log_moduli):
        solver.set_parameters({"params": jnp.asarray(log_moduli)[region][:, None]})
        missed = []
        for step, case in enumerate(loading.load_case):
            found = solver.newton(u[step], _held(mesh, loading.constrained[case]))
            if found.u is None:
                raise BaselineError(f"load step {step}: a sheet with moduli {np.exp(log_moduli)} finds no equilibrium")
            missed.append((found.u - u[step]).ravel() / size[step])
            force = found.force.reshape(-1, 2)
            for i in range(2):
                edge = tied_edge(loading.constrained[case], loading.known[case], i)
                if edge is not None:
                    axis, _ = EDGES[edge]
                    unit = PERCENT * loading.scale[step] * mesh.size[1 - axis]
                    missed.append([(force[mesh.on_edge(edge), i].sum() - loading.resultant[step, i]) / unit])
        return np.concatenate(missed)

    found = least_squares(misfit, np.full(region.max() + 1, np.log(start)), x_scale=0.1, diff_step=1e-4, xtol=1e-5)
    if found.status <= 0:
        raise BaselineError(f"model updating stopped after {found.nfev} evaluations: {found.message}")
    return np.exp(found.x)[region]
