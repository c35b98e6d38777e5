"""A material as three functions of position and deformation."""

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from hypernode.material.domain import Domain


class Material:
    """A heterogeneous hyperelastic sheet.

    Attributes:
        units: what ``stress`` and ``energy`` (per reference volume) and ``length`` mean.
        seen: the deformations that the test has seen, beyond which the material warns once; None where it does not.
    """

    def __init__(self, params_at, stress, energy, units: dict[str, str]):
        self._params_at, self.units = params_at, units
        self.seen: Domain | None = None
        self._warned = False
        self._stress, self._energy = jax.jit(stress), jax.jit(energy)
        self._tangent = jax.jit(partial(_tangent, stress))

    def _evaluate(self, function, X, F):
        """``function`` of every state F [..., n, i, J], one after the other: it is compiled once for any number."""
        X, F = jnp.asarray(X), jnp.asarray(F)
        if X.ndim != 2 or X.shape[1] != 2 or F.shape[-3:] != (len(X), 2, 2):
            raise ValueError(f"X must be (n, 2) and F (..., n, 2, 2), not {X.shape} and {F.shape}")
        self._look(F)
        params = self._params_at(X)
        states = jnp.moveaxis(F.reshape(-1, *F.shape[-3:]), 1, -1)
        found = jnp.stack([jnp.moveaxis(function(state, params), -1, 0) for state in states])
        return found.reshape(*F.shape[:-2], *found.shape[2:])

    def _look(self, F):
        """Warn of deformations that the test has not seen, once; values that are being traced are no numbers yet."""
        if self.seen is None or self._warned or isinstance(F, jax.core.Tracer):
            return
        remark = self.seen.remark(F)
        if remark:
            self._warned = True
            warnings.warn(remark, UserWarning, stacklevel=4)

    def energy(self, X: Float[ArrayLike, "n 2"], F: Float[ArrayLike, "... n 2 2"]) -> Float[Array, "... n"]:
        """Energy density Psi(X, F), zero at F = I.

        Args:
            X: positions, in the length unit of the test.
            F: in-plane deformation gradients, of one or more states of all positions.
        """
        return self._evaluate(self._energy, X, F)

    def stress(self, X: Float[ArrayLike, "n 2"], F: Float[ArrayLike, "... n 2 2"]) -> Float[Array, "... n 2 2"]:
        """First Piola-Kirchhoff stress P[..., n, i, J]; arguments as in :meth:`energy`."""
        return self._evaluate(self._stress, X, F)

    def tangent(self, X: Float[ArrayLike, "n 2"], F: Float[ArrayLike, "... n 2 2"]) -> Float[Array, "... n 2 2 2 2"]:
        """dP_iJ/dF_kL as [..., n, i, J, k, L]; arguments as in :meth:`energy`."""
        return self._evaluate(self._tangent, X, F)

    def point_law(self, X: Float[ArrayLike, "n 2"]) -> tuple[Callable, Any]:
        """What a finite-element code needs that evaluates one point at a time, such as JAX-FEM.

        Args:
            X: positions, in the length unit of the test.

        Returns:
            (P(F[2, 2], values) of one point, values of all points: a pytree of arrays (n, ...)).
        """

        law, params = self.stress_law(X)

        def by_point(values):
            return jnp.moveaxis(jnp.broadcast_to(values, (*values.shape[:-1], len(X))), -1, 0)

        def stress(F, values):
            return law(F[..., None], jax.tree.map(lambda each: each[..., None], values))[..., 0]

        return stress, jax.tree.map(by_point, params)

    def stress_law(self, X: Float[ArrayLike, "n 2"]):
        """(P[i, J, point] as a function of (F[i, J, point], params), params at X).

        ``params`` is a tree of arrays; the last axis of each is that of the points, or has one entry that all share.
        """
        return self._stress, self._params_at(jnp.asarray(X))


def _tangent(stress, F, params):
    """dP_iJ/dF_kL as [i, J, k, L, n], by the derivative in each of the four directions at once."""
    _, derivative = jax.linearize(lambda F: stress(F, params), F)
    directions = jnp.broadcast_to(jnp.eye(4, dtype=F.dtype).reshape(4, 2, 2, 1), (4, *F.shape))
    return jnp.moveaxis(jax.vmap(derivative)(directions), 0, 2).reshape(2, 2, 2, 2, -1)
