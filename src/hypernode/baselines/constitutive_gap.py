"""The constitutive equation gap: alternately a stress in equilibrium and the moduli that bring theirs closest to it.

The gap between a stress tau and that of the material (Geymonat and Pagano 2003; Florentin and Lubineau 2010),

    E(tau, mu) = sum of integrals |tau - mu U(F)|^2 / mu,   tau in equilibrium with the measured forces,

is minimised by turns. With mu fixed, tau = mu (U + grad v) is a linear problem. With tau fixed, mu^2 = |tau|^2 / |U|^2
in every cell. Both lower the gap, and it is convex in both: the alternation ends at its minimum.
"""

import numpy as np
from jaxtyping import Float

from hypernode.baselines.equilibrium_gap import SMALLEST_MODULUS, homogeneous_modulus, unit_stress
from hypernode.data.loading import Loading
from hypernode.fem.equilibrium_gap import balance_energy
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.fem.nodal_forces import nodal_force_matrices, stiffness_matrix

#: It ends where the moduli change by less than this, relative, or after so many alternations.
TOLERANCE, ITERATIONS = 1e-3, 400


def equilibrated_stress(mesh: Mesh, loading: Loading, P, moduli):
    """The stress [i, J, step, cell] in equilibrium with the forces that is closest to P in the norm of |.|^2 / mu."""
    D, gradient, K = nodal_force_matrices(mesh), mesh.gradient_operator(), stiffness_matrix(mesh, moduli)
    found = P.copy()
    for case in range(loading.load_case.max() + 1):
        steps = np.flatnonzero(loading.load_case == case)
        for i in range(2):
            T, energy, edge = balance_energy(mesh, K, i, loading.constrained[case], loading.known[case])
            missing = -(T.T @ sum(D[J] @ P[i, J][steps].T for J in range(2)))
            if edge is not None:
                missing[-1] += loading.resultant[steps, i]
            v = T @ factorise(energy).solve(missing)
            found[i][:, steps] += moduli * np.einsum("cas,caJ->Jsc", v[mesh.cells], gradient)
    return found


def constitutive_gap_moduli(mesh: Mesh, loading: Loading, F) -> tuple[Float[np.ndarray, " cell"], int]:
    """(modulus of every cell, number of alternations).

    Args:
        F: [i, J, step, cell].

    Raises:
        BaselineError: the forces are those of no material.
    """
    start = homogeneous_modulus(mesh, loading, F)
    unit, scale = unit_stress(F), loading.scale[:, None]
    moduli = np.full(len(mesh.cells), start)
    norm = np.sum((unit / scale) ** 2, axis=(0, 1, 2))
    change, alternations = np.inf, 0
    while change > TOLERANCE and alternations < ITERATIONS:
        stress = equilibrated_stress(mesh, loading, moduli * unit, moduli)
        new = np.sqrt(np.sum((stress / scale) ** 2, axis=(0, 1, 2)) / norm)
        new = np.maximum(new, SMALLEST_MODULUS * start)
        change = np.max(np.abs(np.log(new / moduli)))
        moduli, alternations = new, alternations + 1
    return moduli, alternations
