"""A level for the stress of a sheet whose forces nobody recorded: displacements tell the material up to one factor."""

import numpy as np
from jaxtyping import Float

#: Shear modulus of the neo-Hookean sheet that stands for the whole [MPa].
UNIT_MODULUS = 1.0


def assumed_force(H: Float[np.ndarray, "step 2 2"], section: Float[np.ndarray, " 2"]) -> tuple[int, int, float]:
    """(step, axis, force [N]) of the one resultant that sets the level.

    The sheet as a whole is taken for a neo-Hookean one of :data:`UNIT_MODULUS` under its mean deformation F. In plane
    stress P = mu (F - F^-T / det(F)^2). The resultant is that at the largest deformation, along its larger stretch. No
    second resultant is assumed, for it would say something of the law.

    Args:
        H: mean displacement gradient of every step.
        section: areas of the sections normal to x and to y [mm^2].
    """
    F = np.eye(2) + H
    P = UNIT_MODULUS * (F - np.linalg.inv(F).transpose(0, 2, 1) / np.linalg.det(F)[:, None, None] ** 2)
    normal = np.abs(P[:, (0, 1), (0, 1)])
    step, axis = np.unravel_index(int(np.argmax(normal)), normal.shape)
    return int(step), int(axis), float(P[step, axis, axis] * section[axis])
