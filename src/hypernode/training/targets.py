"""Stresses that a network learns before equilibrium is asked for."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Int

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

    def misfit(self, node: NodeMaterial, node_params):
        """Mean squared relative error of the stress of the cells with the given parameters."""
        P = node_stress(node, self.F, node_params) / self.scale[:, None]
        return jnp.mean(self.known * (P - self.P) ** 2)

    def relative_error(self, node: NodeMaterial, node_params) -> float:
        """Relative L2 error of the stress of the cells with the given parameters, every case over its unit."""
        P = node_stress(node, self.F, node_params) / self.scale[:, None]
        return float(jnp.sqrt(jnp.sum(self.known * (P - self.P) ** 2) / jnp.sum(self.known * self.P**2)))

    def ordered(self, cells: Int[np.ndarray, " cell"]) -> "Target":
        """The target of these cells, in their order."""
        return dataclasses.replace(self, F=self.F[..., cells], P=self.P[..., cells])

    def following(self, first, count: int) -> "Target":
        """The target of the ``count`` cells from ``first`` on, which may be traced."""
        F, P = (jax.lax.dynamic_slice_in_dim(each, first, count, axis=-1) for each in (self.F, self.P))
        return dataclasses.replace(self, F=F, P=P)
