"""The virtual fields method with sensitivity-based virtual fields.

The material is P = sum_r mu_r U 1_r, with the modulus mu_r in region r. The virtual field of a modulus is the one whose
gradient comes closest to the derivative of the stress by it (Marek, Davis and Pierron 2017),

    u*_r = argmin integral |grad u* - U(F) 1_r|^2,   integral P : grad u*_r = f . u*_r,

over finite-element fields that vanish where the reaction is not known and are constant along an edge whose force is.
Equations of all load steps are added, so that there are as many as moduli.
"""

import numpy as np
import scipy.linalg
from jaxtyping import Float, Int

from hypernode.baselines.equilibrium_gap import SMALLEST_MODULUS, homogeneous_modulus, unit_stress
from hypernode.data.loading import Loading
from hypernode.fem.equilibrium_gap import balance_energy
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.fem.nodal_forces import nodal_force_matrices, stiffness_matrix

#: Cost of squared differences between neighbouring regions that are single cells, over the mean diagonal of the
#: system: enough for a solution, since a pattern of alternating cells costs no virtual work.
SMOOTHNESS = 1e-4


def virtual_fields_moduli(
    mesh: Mesh, loading: Loading, F, region: Int[np.ndarray, " cell"]
) -> Float[np.ndarray, " cell"]:
    """The modulus of every cell, one for each region.

    Args:
        F: [i, J, step, cell].
        region: number of the region of each cell, from zero on.

    Raises:
        BaselineError: the forces are those of no material.
    """
    start, count = homogeneous_modulus(mesh, loading, F), region.max() + 1
    member = (region[:, None] == np.arange(count)).astype(float)
    D, K, unit = nodal_force_matrices(mesh), stiffness_matrix(mesh), unit_stress(F)
    A, b = np.zeros((count, count)), np.zeros(count)
    for case in range(loading.load_case.max() + 1):
        steps = np.flatnonzero(loading.load_case == case)
        for i in range(2):
            T, energy, edge = balance_energy(mesh, K, i, loading.constrained[case], loading.known[case])
            factor = factorise(energy)
            for step in steps:
                work = sum((T.T @ D[J]).multiply(unit[i, J, step]) for J in range(2)) @ member / loading.scale[step]
                field = factor.solve(work)
                A += field.T @ work
                if edge is not None:
                    b += field[-1] * loading.resultant[step, i] / loading.scale[step]
    if count == len(region):
        pairs = mesh.neighbours()[0]
        weight = SMOOTHNESS * np.trace(A) / count
        for one, other in ((0, 1), (1, 0)):
            np.add.at(A, (pairs[:, one], pairs[:, one]), weight)
            np.add.at(A, (pairs[:, one], pairs[:, other]), -weight)
    return np.maximum(scipy.linalg.solve(A, b, assume_a="sym"), SMALLEST_MODULUS * start)[region]
