"""Response of a material field to prescribed homogeneous deformations."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from hypernode.material.field import Material
from hypernode.mechanics.loads import tensile_axis

#: Difference over sum of the principal stresses above which a material has a fibre direction to find.
SMALLEST_ANISOTROPY = 0.05

#: Newton's method for the transverse stretch ends with a step below STEP, or after NEWTON_STEPS.
STEP, NEWTON_STEPS = 1e-7, 30

#: Largest step that may be rounding alone, in units of the last place of 1. It is one or two units where the tangent
#: across is as large as the stress along, and more in proportion where a sheet is softer across.
ROUNDING_UNITS = 100


def stress_at_common_F(material: Material, X, F) -> np.ndarray:
    """P[mode, stretch, cell, i, J] when every point undergoes the same F[mode, stretch]."""
    return np.asarray(material.stress(X, jnp.broadcast_to(F[:, :, None], (*F.shape[:2], len(X), 2, 2))), float)


def equibiaxial_stress(material: Material, X, stretches) -> np.ndarray:
    """P[stretch, point, i, J] when every point is stretched alike in both directions."""
    return stress_at_common_F(material, X, np.asarray(stretches)[None, :, None, None] * np.eye(2))[0]


def uniaxial_stress(material: Material, X, stretches, axis: int) -> Float[np.ndarray, "stretch point 2"]:
    """Normal stresses under a uniaxial *stress* along ``axis`` at the given stretches; NaN without a solution.

    The transverse stretch, between 0.3 and 3, follows from a vanishing transverse stress by Newton's method. A point
    has converged if its last step is below :data:`STEP`. In single precision steps never become that small, and the
    limit is :data:`ROUNDING_UNITS` of the stress's type.

    Args:
        X: positions (point, 2).
        stretches: stretches along ``axis`` (stretch,).
    """
    _, P, _, converged = uniaxial_states(material, X, stretches, axis)
    return np.where(converged[..., None], np.stack([P[..., 0, 0], P[..., 1, 1]], axis=-1), np.nan)


def uniaxial_states(material: Material, X, stretches, axis: int):
    """The states of :func:`uniaxial_stress`.

    Returns:
        F[stretch, point, i, J], and P of the same shape. Then two arrays (stretch, point): the derivative of the axial
        stress with respect to the transverse stress along the transverse stretch, and whether the state was found.
    """
    across = 1 - axis
    along = np.broadcast_to(np.asarray(stretches, float)[:, None], (len(stretches), len(X)))
    transverse = along**-0.5
    for _ in range(NEWTON_STEPS):
        F = np.zeros((*along.shape, 2, 2))
        F[..., axis, axis], F[..., across, across] = along, transverse
        stress = material.stress(X, F)
        P = np.asarray(stress, float)
        tangent = np.asarray(material.tangent(X, F), float)[..., across, across]
        slope = tangent[..., across, across]
        step = P[..., across, across] / np.where(np.abs(slope) > 0, slope, 1.0)
        transverse = np.clip(transverse - step, 0.3, 3.0)
        if np.abs(step).max() < STEP:
            break
    converged = np.abs(step) <= max(STEP, ROUNDING_UNITS * float(jnp.finfo(stress.dtype).eps))
    return F, P, tangent[..., axis, axis] / np.where(np.abs(slope) > 0, slope, 1.0), converged


def indicator(material: Material, X, kind: str, stretch: float) -> np.ndarray:
    """Stress that indicates the stiffness (cell,): tr P at equibiaxial stretch, or the axial stress for uniaxial
    tests."""
    axis = tensile_axis(kind)
    if axis is None:
        P = equibiaxial_stress(material, X, [stretch])[0]
        return P[:, 0, 0] + P[:, 1, 1]
    return uniaxial_stress(material, X, [stretch], axis)[0, :, axis]


def sampled_indicator(
    best: Material, samples: Material, X, count: int, kind: str, stretch: float
) -> Float[np.ndarray, "sample cell"]:
    """:func:`indicator` of materials close to ``best``, to first order in their difference.

    The transverse stretch of a sample follows from the tangent of ``best``, so a sample has a state wherever ``best``
    has one.

    Args:
        best: material about which the samples scatter.
        samples: ``count`` materials at the positions X, one after the other.
    """
    axis = tensile_axis(kind)
    if axis is None:
        return indicator(samples, np.tile(X, (count, 1)), kind, stretch).reshape(count, -1)
    return Probe.uniaxial(best, X, stretch, axis).read(samples, X, count)[:, 0]


@dataclass(frozen=True)
class Probe:
    """A deformation of every point, and how the stress is read there.

    Attributes:
        F: of every point.
        weights: of the components of P in every reading; NaN where a point has no such state.
    """

    F: Float[np.ndarray, "point 2 2"]
    weights: Float[np.ndarray, "reading point 2 2"]

    @classmethod
    def common(cls, F: Float[np.ndarray, "2 2"], points: int) -> "Probe":
        """The same F at all points; every component is read."""
        unit = np.broadcast_to(np.eye(4).reshape(4, 1, 2, 2), (4, points, 2, 2))
        return cls(np.broadcast_to(F, (points, 2, 2)), unit)

    @classmethod
    def uniaxial(cls, best: Material, X, stretch: float, axis: int) -> "Probe":
        """A pull with free sides of one material; the axial stress is read.

        The transverse stretch of a material close to it follows from the tangent of this one.
        """
        states, _, coupling, found = uniaxial_states(best, X, [stretch], axis)
        weights = np.zeros((1, len(X), 2, 2))
        weights[0, :, axis, axis] = np.where(found[0], 1.0, np.nan)
        weights[0, :, 1 - axis, 1 - axis] = -coupling[0]
        return cls(states[0], weights)

    @property
    def reached(self) -> Bool[np.ndarray, " point"]:
        """Which points have the state."""
        return np.isfinite(self.weights).all(axis=(0, 2, 3))

    def read(self, material: Material, X, count: int = 1) -> Float[np.ndarray, "sample reading point"]:
        """Readings of ``count`` materials at the positions X, one after the other."""
        P = np.asarray(material.stress(np.tile(X, (count, 1)), np.tile(self.F, (count, 1, 1))), float)
        return np.einsum("rpij,spij->srp", self.weights, P.reshape(count, len(X), 2, 2))


def preferred_direction(material: Material, X, stretch: float) -> tuple[np.ndarray, np.ndarray]:
    """(anisotropy (cell,), angle of the stiffest direction from x [degrees] (cell,)) at equibiaxial stretch.

    The anisotropy is the difference of the principal stresses over their sum, zero for every isotropic material. The
    angle, from -90 to 90, is arbitrary if the anisotropy vanishes.
    """
    P = equibiaxial_stress(material, X, [stretch])[0]
    difference, shear = P[:, 0, 0] - P[:, 1, 1], P[:, 0, 1] + P[:, 1, 0]
    anisotropy = np.hypot(difference, shear) / np.maximum(np.abs(P[:, 0, 0] + P[:, 1, 1]), 1e-300)
    return anisotropy, np.rad2deg(0.5 * np.arctan2(shear, difference))
