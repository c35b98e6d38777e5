"""Stress and energy of neural-ODE materials and of cells divided into subcells."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.kinematics import REFERENCE, Invariants, invariants
from hypernode.mechanics.stress import first_piola_kirchhoff

#: Gauss-Legendre points of the integral that turns dPsi/dI into an energy.
ENERGY_POINTS = 16


def node_stress(
    material: NodeMaterial, F: Float[Array, "2 2 ... point"], node_params: Float[Array, "size point"]
) -> Float[Array, "2 2 ... point"]:
    """P[i, J, ...] of a neural-ODE material (equation ``Node_constitutive_predicting``)."""
    angle = material.fibre_angle(node_params)
    return first_piola_kirchhoff(F, material.energy_derivatives(invariants(F, angle), node_params), angle)


def node_energy(
    material: NodeMaterial, F: Float[Array, "2 2 ... point"], node_params: Float[Array, "size point"]
) -> Float[Array, "... point"]:
    """Energy density of a neural-ODE material, integrated from its derivatives.

    Along the straight line from the undeformed invariants: Psi is a function of them, so any path would do.
    """
    points, weights = np.polynomial.legendre.leggauss(ENERGY_POINTS)
    I = invariants(F, material.fibre_angle(node_params))

    def along(s):
        between = Invariants(*(r + s * (v - r) for r, v in zip(REFERENCE, I, strict=True)))
        slope = material.energy_derivatives(between, node_params)
        return sum(d * (v - r) for d, v, r in zip(slope, I, REFERENCE, strict=True))

    at = jax.lax.map(along, jnp.asarray(0.5 * (points + 1.0), F.dtype))
    return jnp.tensordot(jnp.asarray(0.5 * weights, F.dtype), at, 1)


def mean_of_subcells(law):
    """Stress or energy of cells as the mean of their parts, whose parameters are (parameter, part, point)."""
    # One after the other: the compiler gets a mean along a middle axis wrong at some sizes (docs/decisions/0020).
    return lambda F, params: sum(law(F, params[:, k]) for k in range(params.shape[1])) / params.shape[1]
