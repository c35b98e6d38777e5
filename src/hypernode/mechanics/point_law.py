"""What finite elements ask of a law of stress whose parameters differ from point to point."""

from functools import partial
from typing import Protocol, runtime_checkable

import jax
import numpy as np
from jaxtyping import Array, ArrayLike, Float


@runtime_checkable
class PointLaw(Protocol):
    """A law of stress with a vector of parameters, the first of which is the logarithm of a factor on all of it."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in their order."""

    @property
    def start(self) -> Float[np.ndarray, " parameter"]:
        """Parameters of some plain material."""

    def stress(
        self, F: Float[ArrayLike, "2 2 ..."], params: Float[ArrayLike, "parameter ..."]
    ) -> Float[Array, "2 2 ..."]:
        """First Piola-Kirchhoff stress P[i, J, ...] of a sheet in plane stress.

        Args:
            F: in-plane deformation gradient F[i, J, ...].
            params: parameters, broadcastable to the batch shape.
        """


#: A stress whose operations are written down once for each shape, and not anew in each program that asks for it or for
#: its derivatives; they become part of that program as if they had been written there. The law itself is hashable.
traced_once = partial(jax.jit, static_argnums=0, inline=True)
