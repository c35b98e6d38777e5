"""The one stress kernel: finite elements, training and evaluation all call it."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hypernode.mechanics.kinematics import Invariants


def first_piola_kirchhoff(
    F: Float[Array, "2 2 ..."], dPsi: Invariants, fibre_angle: Float[Array, "..."]
) -> Float[Array, "2 2 ..."]:
    """In-plane P = sum_k dPsi/dI_k dI_k/dF of an incompressible sheet in plane stress.

    Equation ``Node_constitutive_predicting`` of the paper with the pressure eliminated by S33 = 0,
    which is the same as differentiating the energy after F33 = 1/J has been inserted.

    Args:
        F: in-plane deformation gradient F[i, J, ...].
        dPsi: energy derivative with respect to each invariant, broadcastable to the batch shape.
        fibre_angle: angle of the first fibre direction from the x axis [rad].

    Returns:
        P[i, J, ...] in the units of dPsi.
    """
    (F11, F12), (F21, F22) = F
    J = F11 * F22 - F12 * F21
    trace = F11**2 + F12**2 + F21**2 + F22**2
    # dI1/dF = 2 F - 2 J^-3 cof F and dI2/dF = 2 F / J^2 + 2 (J - tr C / J^3) cof F.
    on_F = 2.0 * (dPsi.I1 + dPsi.I2 / J**2)
    on_cofactor = -2.0 * dPsi.I1 / J**3 + 2.0 * dPsi.I2 * (J - trace / J**3)
    # dI4/dF = 2 F (a x a): both families give the symmetric 2 x 2 matrix M.
    c, s = jnp.cos(fibre_angle), jnp.sin(fibre_angle)
    M11 = on_F + 2.0 * (dPsi.I4v * c**2 + dPsi.I4w * s**2)
    M22 = on_F + 2.0 * (dPsi.I4v * s**2 + dPsi.I4w * c**2)
    M12 = 2.0 * (dPsi.I4v - dPsi.I4w) * c * s
    return jnp.stack(
        [
            jnp.stack([F11 * M11 + F12 * M12 + on_cofactor * F22, F11 * M12 + F12 * M22 - on_cofactor * F21]),
            jnp.stack([F21 * M11 + F22 * M12 - on_cofactor * F12, F21 * M12 + F22 * M22 + on_cofactor * F11]),
        ]
    )
