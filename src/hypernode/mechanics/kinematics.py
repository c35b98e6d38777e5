"""Kinematics of a thin sheet in plane stress.

Every array carries its tensor indices first and any batch axes after them: ``F[i, J, ...]``.
One material point is then the special case without batch axes, and a field keeps its points
contiguous in memory, which is what makes the training step fast.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float


class Invariants(NamedTuple):
    """Values of (or coefficients for) the invariants of a sheet; every leaf has the batch shape."""

    I1: Float[Array, "..."]
    I2: Float[Array, "..."]
    I4v: Float[Array, "..."]
    I4w: Float[Array, "..."]
    J: Float[Array, "..."]


#: The invariants of the undeformed state, F = I.
REFERENCE = Invariants(3.0, 3.0, 1.0, 1.0, 1.0)


def right_cauchy_green(F: Float[ArrayLike, "2 2 ..."]):
    """In-plane C = F^T F as its three components (C11, C22, C12), each of the batch shape."""
    C11 = F[0, 0] ** 2 + F[1, 0] ** 2
    C22 = F[0, 1] ** 2 + F[1, 1] ** 2
    C12 = F[0, 0] * F[0, 1] + F[1, 0] * F[1, 1]
    return C11, C22, C12


def invariants(F: Float[ArrayLike, "2 2 ..."], fibre_angle: Float[ArrayLike, "..."]) -> Invariants:
    """Invariants of the incompressible sheet, with F33 = 1/J eliminated, and its in-plane J.

    I1 = tr C + 1/J^2, I2 = J^2 + tr C / J^2, I4v = v.C v, I4w = w.C w. C and J belong to the in-plane F. The fibre
    directions v = (cos a, sin a) and w = (-sin a, cos a) are perpendicular. A compressible sheet has the same in-plane
    invariants, tr C = I1 - 1/J^2 and J; what its thickness does follows from them.

    Args:
        F: in-plane deformation gradient F[i, J, ...].
        fibre_angle: angle a of v from the x axis [rad], broadcastable to the batch shape.
    """
    C11, C22, C12 = right_cauchy_green(F)
    J2 = C11 * C22 - C12**2
    trace = C11 + C22
    c, s = jnp.cos(fibre_angle), jnp.sin(fibre_angle)
    return Invariants(
        I1=trace + 1.0 / J2,
        I2=J2 + trace / J2,
        I4v=c**2 * C11 + 2.0 * c * s * C12 + s**2 * C22,
        I4w=s**2 * C11 - 2.0 * c * s * C12 + c**2 * C22,
        J=F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0],
    )


def stretch_powers(I: Invariants) -> dict[str, tuple]:
    """Sums of powers of the principal stretches of an incompressible sheet, each with its derivatives by I1 and I2.

    They are (l1^6 + l2^6 + l3^6 - 3) / 9, (l1^4 + l2^4 + l3^4 - 3) / 4 and (l1^-4 + l2^-4 + l3^-4 - 3) / 4. All are
    polynomials of I1 and I2, polyconvex, and like I1 - 3 for small strains. With the powers 2 and -2, which are I1 and
    I2, most of Ogden's lie between them.
    """
    return {
        "ogden_6": ((I.I1**3 - 3.0 * I.I1 * I.I2) / 9.0, (I.I1**2 - I.I2) / 3.0, -I.I1 / 3.0),
        "ogden_4": ((I.I1**2 - 2.0 * I.I2 - 3.0) / 4.0, 0.5 * I.I1, -0.5),
        "ogden_minus_4": ((I.I2**2 - 2.0 * I.I1 - 3.0) / 4.0, -0.5, 0.5 * I.I2),
    }


def in_plane_trace(I: Invariants) -> Float[ArrayLike, "..."]:
    """tr C of the in-plane C: what I1 is without the thickness of an incompressible sheet."""
    return I.I1 - 1.0 / I.J**2


def largest_principal_strain(F: Float[ArrayLike, "2 2 ..."]) -> Float[Array, "..."]:
    """Largest in-plane eigenvalue of the Green-Lagrange strain E = (C - I)/2."""
    C11, C22, C12 = right_cauchy_green(F)
    mean = 0.5 * (C11 + C22)
    radius = jnp.sqrt(0.25 * (C11 - C22) ** 2 + C12**2)
    return 0.5 * (mean + radius - 1.0)
