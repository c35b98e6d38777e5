"""Stress of a law at many points, and its derivatives, compiled once for blocks of one size."""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.mechanics.point_law import PointLaw

#: Points in a compiled call: enough that a call costs more than to begin it, and few where lines cut few cells.
BLOCK = 512


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
        P, along = jax.linearize(lambda F: law.stress(F, params), F)
        return P, jax.vmap(lambda unit: along(jnp.broadcast_to(unit, F.shape)))(units)

    def by_params(F, params):
        units = jnp.eye(len(params))[:, :, None]
        _, along = jax.linearize(lambda params: law.stress(F, params), params)
        return jax.vmap(lambda unit: along(jnp.broadcast_to(unit, params.shape)))(units)

    return jax.jit(tangent), jax.jit(by_params), jax.jit(law.stress)


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
        P, by_F = self._blocks(self._tangent, F, params)
        return P, np.moveaxis(by_F, 0, 2).reshape(2, 2, 2, 2, -1)

    def stress_alone(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]):
        """``P`` of :class:`PointStress`."""
        (P,) = self._blocks(lambda *given: (self._alone(*given),), F, params)
        return P

    def by_parameters(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]):
        """``by_params`` of :class:`PointStress`."""
        (by_params,) = self._blocks(lambda *given: (self._by_params(*given),), F, params)
        return np.moveaxis(by_params, 0, 2)

    def all(self, F: Float[np.ndarray, "2 2 point"], params: Float[np.ndarray, "parameter point"]) -> PointStress:
        """Stress with both derivatives."""
        return PointStress(*self.stress(F, params), self.by_parameters(F, params))

    @staticmethod
    def _blocks(function, F, params):
        """Results of a compiled function whose last axis are points, block by block."""
        count, found = F.shape[-1], []
        for first in range(0, count, BLOCK):
            given = [each[..., first : first + BLOCK] for each in (F, params)]
            if missing := BLOCK - given[0].shape[-1]:
                # What fills the last block is its last point again.
                given = [np.concatenate([each, np.repeat(each[..., -1:], missing, axis=-1)], axis=-1) for each in given]
            found.append(function(*given))
        return [
            np.concatenate([np.asarray(each) for each in part], axis=-1)[..., :count]
            for part in zip(*found, strict=True)
        ]
