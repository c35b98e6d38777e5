"""Homogeneous deformations in which materials are compared."""

import numpy as np

#: Homogeneous deformations in which materials are compared.
MODES = ("equibiaxial", "strip_x", "strip_y", "shear")


def mode_gradients(stretches) -> np.ndarray:
    """F[mode, stretch, i, J] of the judged homogeneous deformations (shear by stretch - 1)."""
    F = np.tile(np.eye(2), (len(MODES), len(stretches), 1, 1))
    extra = np.asarray(stretches) - 1.0
    F[0, :, 0, 0] += extra
    F[0, :, 1, 1] += extra
    F[1, :, 0, 0] += extra
    F[2, :, 1, 1] += extra
    F[3, :, 0, 1] += extra
    return F
