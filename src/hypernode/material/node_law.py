"""A neural-ODE material as a law that finite elements identify."""

import dataclasses

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial


@dataclasses.dataclass(frozen=True)
class NodeLaw:
    """A :class:`~hypernode.mechanics.point_law.PointLaw`: the level, zero of the material itself, then its parameters.

    Attributes:
        node: the material at a point.
    """

    node: NodeMaterial

    @property
    def names(self) -> tuple[str, ...]:
        """The level, and the neural-ODE parameters by their number."""
        return ("log_level", *(f"node_{k}" for k in range(self.node.size)))

    @property
    def start(self) -> Float[np.ndarray, " parameter"]:
        """A material whose functions are all zero, but for its constants."""
        return np.zeros(1 + self.node.size)

    def stress(self, F: Float[Array, "2 2 ..."], params: Float[Array, "parameter ..."]) -> Float[Array, "2 2 ..."]:
        """First Piola-Kirchhoff stress P[i, J, ...], parameters broadcastable to the batch shape."""
        if F.ndim == 2:
            return self.stress(F[..., None], params[:, None])[..., 0]
        return jnp.exp(params[0]) * node_stress(self.node, F, params[1:])
