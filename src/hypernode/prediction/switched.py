"""One law that is any of several, so that phases of different terms are parts of one sheet."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hypernode.mechanics.point_law import PointLaw, traced_once


@dataclass(frozen=True)
class SwitchedLaw:
    """A point follows the law whose number is its second parameter.

    Attributes:
        laws: the laws, each with parameters of its own.
    """

    laws: tuple[PointLaw, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The logarithm of a factor, the number of the law, and its parameters, as many as the longest has."""
        return ("log_factor", "which", *(f"p{k}" for k in range(max(len(law.names) for law in self.laws))))

    @property
    def start(self) -> Float[np.ndarray, " parameter"]:
        """The plain material of the first law."""
        return self.of(0, self.laws[0].start)

    def of(self, which: int, params: Float[np.ndarray, "... own"]) -> Float[np.ndarray, "... parameter"]:
        """Parameters of a law, by its number, as parameters of this one."""
        found = np.zeros((*params.shape[:-1], len(self.names)))
        found[..., 1] = which
        found[..., 2 : 2 + params.shape[-1]] = params
        return found

    @traced_once
    def stress(self, F: Float[Array, "2 2 ..."], params: Float[Array, "parameter ..."]) -> Float[Array, "2 2 ..."]:
        """First Piola-Kirchhoff stress P[i, J, ...]."""
        total = 0.0
        for number, law in enumerate(self.laws):
            chosen, own = params[1] == number, params[2 : 2 + len(law.names)]
            # A law that is not asked sees numbers that it can bear: what it answers is dropped, derivatives too.
            plain = jnp.asarray(law.start).reshape(-1, *[1] * (own.ndim - 1))
            total = total + jnp.where(chosen, law.stress(F, jnp.where(chosen, own, plain)), 0.0)
        return jnp.exp(params[0]) * total
