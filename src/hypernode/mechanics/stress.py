"""The one stress kernel: finite elements, training and evaluation all call it."""

import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from hypernode.mechanics.kinematics import Invariants


def first_piola_kirchhoff(
    F: Float[ArrayLike, "2 2 ..."], dPsi: Invariants, fibre_angle: Float[ArrayLike, "..."]
) -> Float[Array, "2 2 ..."]:
    """In-plane P = sum_k dPsi/dI_k dI_k/dF of a sheet in plane stress.

    Equation ``Node_constitutive_predicting`` of the paper with the pressure (or the thickness) eliminated by
    S33 = 0, which is the same as differentiating the energy after F33 has been inserted.

    Args:
        F: in-plane deformation gradient F[i, J, ...].
        dPsi: energy derivative with respect to each invariant, broadcastable to the batch shape.
        fibre_angle: angle of the first fibre direction from the x axis [rad].

    Returns:
        P[i, J, ...] in the units of dPsi.
    """
    # dI4/dF = 2 F (a x a): both families give the symmetric 2 x 2 matrix S.
    c, s = jnp.cos(fibre_angle), jnp.sin(fibre_angle)
    S11 = 2.0 * (dPsi.I4v * c**2 + dPsi.I4w * s**2)
    S22 = 2.0 * (dPsi.I4v * s**2 + dPsi.I4w * c**2)
    S12 = 2.0 * (dPsi.I4v - dPsi.I4w) * c * s
    return stress_with_structure(F, dPsi.I1, dPsi.I2, (S11, S22, S12), dPsi.J)


def stress_with_structure(F: Float[ArrayLike, "2 2 ..."], dI1, dI2, S, dJ=0.0) -> Float[Array, "2 2 ..."]:
    """The kernel itself, for fibres given as a tensor rather than by their angle.

    Args:
        F: in-plane deformation gradient F[i, J, ...].
        dI1, dI2: energy derivatives with respect to the isotropic invariants.
        S: (S11, S22, S12) of the symmetric tensor 2 sum_k dPsi/dI4k a_k x a_k.
        dJ: energy derivative with respect to the in-plane J.
    """
    (F11, F12), (F21, F22) = F
    J = F11 * F22 - F12 * F21
    trace = F11**2 + F12**2 + F21**2 + F22**2
    # dI1/dF = 2 F - 2 J^-3 cof F, dI2/dF = 2 F / J^2 + 2 (J - tr C / J^3) cof F and dJ/dF = cof F.
    on_F = 2.0 * (dI1 + dI2 / J**2)
    on_cofactor = -2.0 * dI1 / J**3 + 2.0 * dI2 * (J - trace / J**3) + dJ
    M11, M22, M12 = on_F + S[0], on_F + S[1], S[2]
    return jnp.stack(
        [
            jnp.stack([F11 * M11 + F12 * M12 + on_cofactor * F22, F11 * M12 + F12 * M22 - on_cofactor * F21]),
            jnp.stack([F21 * M11 + F22 * M12 - on_cofactor * F12, F21 * M12 + F22 * M22 + on_cofactor * F11]),
        ]
    )
