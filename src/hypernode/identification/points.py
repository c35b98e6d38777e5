"""Stress of a law at many points, and its derivatives, compiled once for blocks of one size."""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.fem.blocks import in_blocks
from hypernode.mechanics.point_law import PointLaw


class PointStress(NamedTuple):
    """What a law answers at points.

    Attributes:
        P: first Piola-Kirchhoff stress [i, J, point].
        by_F: its derivative by the deformation gradient [i, J, k, L, point].
        by_params: its derivative by the parameters [i, J, parameter, point].
    """

    P: Float[np.ndarray, "2 2 point"]
    by_F: Float[np.ndarray, "2 2 2 2 point"]
    by_params: Float[np.ndarray, "2 2 parameter point"]


@functools.cache
def _compiled(law: PointLaw):
    """(stress and derivative by F, derivative by parameters, stress) of one block."""

    def tangent(F, params):
        units = jnp.eye(4).reshape(4, 2, 2, 1)
        return _along(lambda F: law.stress(F, params), F, units)

    def by_params(F, params):
        units = jnp.eye(len(params))[:, :, None]
        return _along(lambda params: law.stress(F, params), params, units)[1]

    return jax.jit(tangent), jax.jit(by_params), jax.jit(law.stress)


def _along(function, point, units):
    """(value, its derivative along each unit), the same unit at all points."""
    return jax.vmap(
        lambda unit: jax.jvp(function, (point,), (jnp.broadcast_to(unit, point.shape),)), out_axes=(None, 0)
    )(units)


class Points:
    """A law at points.

    Args:
        law: of which no two that are equal are compiled.
    """

    def __init__(self, law: PointLaw):
        self.law = law
        self._tangent, self._by_params, self._alone = _compiled(law)

    def stress(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]):
        """(P, its derivative by F) of :class:`PointStress`."""
        P, by_F = in_blocks(self._tangent, F, params)
        return P, np.moveaxis(by_F, 0, 2).reshape(2, 2, 2, 2, -1)

    def stress_alone(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]):
        """``P`` of :class:`PointStress`."""
        return in_blocks(self._alone, F, params)

    def by_parameters(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]):
        """``by_params`` of :class:`PointStress`."""
        return np.moveaxis(in_blocks(self._by_params, F, params), 0, 2)

    def all(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]) -> PointStress:
        """Stress with both derivatives."""
        return PointStress(*self.stress(F, params), self.by_parameters(F, params))
