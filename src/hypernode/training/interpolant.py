"""Stage 4: a continuous deformation gradient (X, t) -> F for every test."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.config.methods import Interpolant
from hypernode.fem.mesh import Mesh
from hypernode.networks.weights import from_arrays

#: Variance of the interpolant in a cell that it meets, as a share of the mean one.
LEAST_VARIANCE = 0.1


class InterpolatedGradient:
    """F(X) at every load step, from one network a test.

    Args:
        file: an interpolant file, opened.
    """

    def __init__(self, file):
        settings = Interpolant.model_validate_json(file.attrs["interpolant"])
        self._lower = jnp.asarray(file["corners"].values[0], jnp.float32)
        self._length = float(file.attrs["length_scale"])
        self._t = jnp.asarray(file["t"].values, jnp.float32)
        self._amplitude = jnp.asarray(file["amplitude"].values, jnp.float32)
        tests = file["load_case"].values
        self._steps = [np.flatnonzero(tests == k) for k in range(tests.max() + 1)]
        self._order = np.argsort(np.concatenate(self._steps), kind="stable")
        self._networks = [from_arrays(settings, 1, 4, file, f"interpolant{k}") for k in range(len(self._steps))]

    def __call__(self, X):
        """F[i, J, step, point] at the positions X (point, 2)."""
        scaled = (X - self._lower) / self._length
        values = [
            network(scaled[None], self._t[steps, None, None]) * self._amplitude[steps, None, None]
            for network, steps in zip(self._networks, self._steps, strict=True)
        ]
        H = jnp.concatenate(values)[self._order].reshape(len(self._t), -1, 2, 2)
        return jnp.moveaxis(H + jnp.eye(2), (2, 3), (0, 1))


def relative_variance(mesh: Mesh, misfit: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, " cell"]:
    """How uncertain F is in a cell, over the mean of the sheet: the squared misfit there and in the cells around it."""
    squared = np.mean(np.sum(misfit**2, axis=(2, 3)), axis=0)
    nodal = np.bincount(mesh.cells.ravel(), np.repeat(squared, 4)) / np.bincount(mesh.cells.ravel())
    around = nodal[mesh.cells].mean(axis=1)
    variance = around / max(around.mean(), np.finfo(float).tiny) + LEAST_VARIANCE
    return variance / variance.mean()
