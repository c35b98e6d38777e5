"""One modulus from the forces, and the equilibrium gap: a neo-Hookean modulus in every cell.

A virtual-fields method with one hat function a node (Claire, Hild and Roux 2004). Baselines of this package assume that
the stress is mu_c U(F) in cell c, with U that of a neo-Hookean sheet of unit coefficient.
"""

import jax.numpy as jnp
import numpy as np
import scipy.sparse

from hypernode.data.loading import Loading
from hypernode.errors import ExpectedError
from hypernode.fem.factors import factorise
from hypernode.fem.gradient import mean_gradient
from hypernode.fem.mesh import EDGES, Mesh
from hypernode.fem.nodal_forces import nodal_force_matrices, virtual_fields
from hypernode.mechanics.convex_basis import ConvexBasis

#: Smoothness weights that cross-validation chooses from, over the mean diagonal of the data's normal matrix.
SMOOTHNESS = np.logspace(-8, 2, 21)
#: Random vectors that estimate the trace in the cross-validation.
PROBES = 4
#: A modulus is no smaller than this share of the homogeneous one: the linear problem knows no sign.
SMALLEST_MODULUS = 0.02
NEO_HOOKEAN = ConvexBasis((), 1.0)


class BaselineError(ExpectedError, RuntimeError):
    """No material follows from the data; the message says why."""


def unit_stress(F):
    """U(F) [i, J, step, cell] of a neo-Hookean sheet of coefficient 1."""
    return np.asarray(NEO_HOOKEAN.stress(jnp.asarray(F), jnp.zeros((1, 1, 1))))


def homogeneous_modulus(mesh: Mesh, loading: Loading, F) -> float:
    """The coefficient of one neo-Hookean material whose stress at the mean F fits force over cross-section.

    Args:
        F: [i, J, step, cell].

    Raises:
        BaselineError: the forces are those of no material.
    """
    unit = np.asarray(NEO_HOOKEAN.stress(jnp.asarray(mean_gradient(mesh, F)), jnp.zeros((1, 1))))[..., 0]
    known, scale = loading.measured, loading.scale[:, None, None]
    unit, target = ((P / scale)[known] for P in (np.moveaxis(unit, -1, 0), loading.P_average))
    modulus = float(unit @ target / (unit @ unit))
    if modulus <= 0:
        raise BaselineError(f"a homogeneous modulus of {modulus:g}: the measured forces do not pull where they should")
    return modulus


def _virtual_work(mesh: Mesh, loading: Loading, F):
    """((A, b) of the hat functions, (A, b) of virtual stretches of the whole sheet): A moduli = b in equilibrium.

    Rows are steps and functions, in units of the stress of the step; a stretch has a row where its force is known.
    """
    unit = unit_stress(F)
    D = nodal_force_matrices(mesh)
    hats, stretches = ([], []), ([], [])
    for step, case in enumerate(loading.load_case):
        for i in range(2):
            T, edge = virtual_fields(mesh, i, loading.constrained[case], loading.known[case])
            work = T.T @ sum(D[J] @ scipy.sparse.diags(unit[i, J, step]) for J in range(2))
            target = np.zeros(work.shape[0])
            if edge is not None:
                target[-1] = loading.resultant[step, i]
                axis, sign = EDGES[edge]
                stretches[0].append(mesh.areas * unit[i, axis, step] / mesh.size[axis] / loading.scale[step])
                stretches[1].append(sign * target[-1] / loading.scale[step])
            hats[0].append(work / loading.scale[step])
            hats[1].append(target / loading.scale[step])
    return (scipy.sparse.vstack(hats[0]).tocsr(), np.concatenate(hats[1])), tuple(map(np.array, stretches))


def equilibrium_gap_moduli(mesh: Mesh, loading: Loading, F, seed: int):
    """Coefficients (cell,) for which P(F) is closest to equilibrium with the forces, and their smoothness weight.

    P is linear in the moduli, and so are the virtual works. Squared differences of neighbours are added, with the
    weight of the smallest generalised cross-validation score, its trace estimated after Hutchinson. Noise in F shrinks
    the moduli: the forces have the last word on their scale.
    """
    start = homogeneous_modulus(mesh, loading, F)
    (A, b), (stretch, mean) = _virtual_work(mesh, loading, F)
    pairs = mesh.neighbours()[0]
    L = scipy.sparse.csr_matrix(
        (np.tile([1.0, -1.0], len(pairs)), (np.repeat(np.arange(len(pairs)), 2), pairs.ravel())),
        (len(pairs), len(mesh.cells)),
    )
    normal, smooth = (A.T @ A).tocsc(), (L.T @ L).tocsc()
    probes = np.random.default_rng(seed).choice([-1.0, 1.0], (PROBES, len(b)))
    best = (np.inf, None, None)
    for weight in SMOOTHNESS * normal.diagonal().mean():
        factor = factorise(normal + weight * smooth)
        moduli = factor.solve(A.T @ b)
        trace = np.mean([z @ (A @ factor.solve(A.T @ z)) for z in probes])
        score = np.sum((A @ moduli - b) ** 2) / max(len(b) - trace, 1.0) ** 2
        if score < best[0]:
            best = (score, moduli, weight)
    moduli = np.maximum(best[1], SMALLEST_MODULUS * start)
    predicted = stretch @ moduli
    return moduli * (predicted @ mean) / (predicted @ predicted), float(best[2])
