"""Two materials in layers, as they are in a cell that an interface cuts.

Of a cell, a share c is of material A and the rest of material B, with a plane of normal N between them. Its sides
deform as

F_A = F + (1 - c) a x N,   F_B = F - c a x N,

so that F is their mean and they stay together. The jump a is the one at which both have the same traction, (P_A - P_B)
N = 0, and the energy is least. The stress of the cell is c P_A + (1 - c) P_B. Such laminates take the place of mixtures
in cells of composites (Kabel, Merkert and Schneider, Computer Methods in Applied Mechanics and Engineering 294, 2015).
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hypernode.mechanics.point_law import PointLaw, traced_once

#: Steps of Newton's method for the jump at most: quadratic from where strains of the sides differ by some tenths.
NEWTON_STEPS = 8
#: Change of the jump from which on two steps more, which square it each, leave nothing but rounding.
SMALL_STEP = 1e-5
#: Largest change of the jump in a step, so that no side is turned inside out on the way.
LARGEST_STEP = 0.2


@dataclass(frozen=True)
class Layers:
    """The law of points with two materials of one law in layers.

    Attributes:
        law: of both materials.
    """

    law: PointLaw

    @property
    def names(self) -> tuple[str, ...]:
        """Logarithm of a factor on all of the stress, parameters of A and of B, share of A, and normal."""
        sides = (f"{side}.{name}" for side in "AB" for name in self.law.names)
        return ("log_factor", *sides, "share", "normal_x", "normal_y")

    @property
    def start(self) -> Float[np.ndarray, " parameter"]:
        """Layers of one material."""
        return np.array([0.0, *self.law.start, *self.law.start, 0.5, 1.0, 0.0])

    def field(
        self,
        materials: Float[np.ndarray, "2 parameter"],
        share: Float[np.ndarray, " cell"],
        normal: Float[np.ndarray, "cell 2"],
    ) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of cells whose layers are of the same two materials."""
        same = np.broadcast_to(np.concatenate([[0.0], *materials]), (len(share), 1 + materials.size))
        return np.concatenate([same, share[:, None], normal], axis=1)

    @traced_once
    def stress(self, F: Float[Array, "2 2 ..."], params: Float[Array, "parameter ..."]) -> Float[Array, "2 2 ..."]:
        """First Piola-Kirchhoff stress P[i, J, ...] of the layers together.

        Its first derivatives are exact: the jump is known to its second-last Newton step without them, and the last
        one has them.
        """
        count = len(self.law.names)
        factor, A, B = params[0], params[1 : 1 + count], params[1 + count : 1 + 2 * count]
        c, N = params[1 + 2 * count], params[2 + 2 * count :]

        def sides(a, F, A, B, c, N):
            across = a[:, None] * N[None]
            return self.law.stress(F + (1.0 - c) * across, A), self.law.stress(F - c * across, B)

        def difference(a, *given):
            P_A, P_B = sides(a, *given)
            return ((P_A - P_B) * given[-1][None]).sum(axis=1)

        def slopes(a, *given):
            units = (jnp.zeros_like(a).at[k].set(1.0) for k in range(2))
            return [jax.jvp(lambda a: difference(a, *given), (a,), (unit,))[1] for unit in units]

        given = F, A, B, c, N
        fixed = jax.lax.stop_gradient(given)

        def goes_on(reached):
            number, size, _ = reached
            return (number < NEWTON_STEPS) & (size.max() > SMALL_STEP)

        def step(reached):
            number, _, a = reached
            change = _solved(slopes(a, *fixed), difference(a, *fixed))
            size = jnp.sqrt((change**2).sum(axis=0))
            return number + 1, size, a - change * jnp.minimum(1.0, LARGEST_STEP / jnp.maximum(size, LARGEST_STEP))

        batch = jnp.broadcast_shapes(F.shape[2:], *(jnp.shape(p) for p in params))
        begun = 0, jnp.full(batch, jnp.inf, F.dtype), jnp.zeros((2, *batch), F.dtype)
        near = jax.lax.stop_gradient(jax.lax.while_loop(goes_on, step, begun)[-1])
        a = near - _solved(jax.lax.stop_gradient(slopes(near, *fixed)), difference(near, *given))
        P_A, P_B = sides(a, *given)
        return jnp.exp(factor) * (c * P_A + (1.0 - c) * P_B)


def _solved(columns, right):
    """x of [column 0, column 1] x = right, two by two."""
    (a, c), (b, d) = columns
    determinant = a * d - b * c
    return jnp.stack([d * right[0] - b * right[1], a * right[1] - c * right[0]]) / determinant
