"""Stresses that a network learns before equilibrium is asked for."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial


@dataclasses.dataclass(frozen=True)
class Target:
    """Stresses to be learnt before equilibrium is asked for.

    Attributes:
        F: deformations [i, J, case, cell].
        P: stresses over ``scale`` at them, of the same shape.
        known: 1 where a component is known, broadcastable to the same shape.
        scale: stress unit of each case.
    """

    F: jax.Array
    P: jax.Array
    known: jax.Array
    scale: jax.Array

    def missed(self, node: NodeMaterial, node_params):
        """What the stress of the cells with the given parameters misses, every case over its unit."""
        return self.known * (node_stress(node, self.F, node_params) / self.scale[:, None] - self.P)

    def misfit(self, node: NodeMaterial, node_params):
        """Mean squared relative error of the stress of the cells with the given parameters."""
        return jnp.mean(self.missed(node, node_params) ** 2)

    def errors(self, node: NodeMaterial, node_params) -> Float[jax.Array, " case"]:
        """Relative L2 error of the stress of the cells with the given parameters in every case."""
        sums = [jnp.sum(each**2, axis=(0, 1, 3)) for each in (self.missed(node, node_params), self.known * self.P)]
        return jnp.sqrt(sums[0] / sums[1])

    def of(self, cells: Int[np.ndarray, " cell"]) -> "Target":
        """The target of these cells, in their order."""
        return dataclasses.replace(self, F=self.F[..., cells], P=self.P[..., cells])

    def following(self, first, count: int) -> "Target":
        """The target of the ``count`` cells from ``first`` on, which may be traced."""
        F, P = (jax.lax.dynamic_slice_in_dim(each, first, count, axis=-1) for each in (self.F, self.P))
        return dataclasses.replace(self, F=F, P=P)
