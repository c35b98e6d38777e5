"""A continuous deformation gradient (X, t) -> F for every load case."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.config.methods import Interpolant
from hypernode.fem.mesh import Mesh
from hypernode.networks.weights import from_arrays, make_network, split_trainable
from hypernode.training.loop import minimise

#: Variance of the interpolant in a cell that it meets, as a share of the mean one.
LEAST_VARIANCE = 0.1
#: Between the seeds of two load cases' networks.
SEEDS_APART = 100


class InterpolatedGradient:
    """F(X) at every load step, from one network a load case.

    Args:
        file: an interpolant file, opened.
    """

    def __init__(self, file):
        settings = Interpolant.model_validate_json(file.attrs["interpolant"])
        self._lower = jnp.asarray(file["corners"].values[0], jnp.float32)
        self._length = float(file.attrs["length_scale"])
        self._t = jnp.asarray(file["t"].values, jnp.float32)
        self._amplitude = jnp.asarray(file["amplitude"].values, jnp.float32)
        cases = file["load_case"].values
        self._steps = [np.flatnonzero(cases == k) for k in range(cases.max() + 1)]
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


class FittedInterpolant(NamedTuple):
    """Networks fitted to F at the cell centres.

    Attributes:
        networks: one a load case.
        t, amplitude: load parameter and root mean square of F - I of every step (step,).
        F: what they make of F (step, cell, 2, 2).
        losses, iterations: mean recorded loss, and the iteration of each record.
    """

    networks: list
    t: np.ndarray
    amplitude: np.ndarray
    F: np.ndarray
    losses: np.ndarray
    iterations: np.ndarray


def fit_interpolant(
    settings: Interpolant,
    seed: int,
    name: str,
    mesh: Mesh,
    load_case,
    F: Float[np.ndarray, "step cell 2 2"],
    normalised: bool = True,
) -> FittedInterpolant:
    """Fit one network a load case to F at the cell centres (equation ``eq_training_FDM_Fint``).

    The misfit of each load step is measured in units of that step's own F - I, and the network's output is scaled by
    it. So small steps are fitted as well as large ones.
    """
    amplitude = np.sqrt(np.mean((F - np.eye(2)) ** 2, axis=(1, 2, 3)))
    t = np.array([amplitude[k] / amplitude[load_case == load_case[k]].max() for k in range(len(load_case))])
    X = jnp.asarray((mesh.centres - mesh.lower) / float(mesh.size.max()), jnp.float32)
    if not normalised:
        amplitude = np.ones_like(amplitude)
    networks, losses, fitted = [], [], np.empty_like(F)
    for case in range(load_case.max() + 1):
        steps = np.flatnonzero(load_case == case)
        target = jnp.asarray((F[steps] - np.eye(2)) / amplitude[steps, None, None, None], jnp.float32)
        target, load = target.reshape(len(steps), -1, 4), jnp.asarray(t[steps, None, None], jnp.float32)
        params, apply = split_trainable(make_network(settings, 1, 4, seed + SEEDS_APART * case))
        count = min(settings.points or len(X), len(X))

        def loss(params, key, target=target, load=load, apply=apply, count=count):
            at = slice(None) if count == len(X) else jax.random.choice(key, len(X), (count,), replace=False)
            return jnp.mean((apply(params)(X[None, at], load) - target[:, at]) ** 2)

        label = f"{name}, load case {case}"
        fit = minimise(loss, params, settings, stage="interpolant", case=label, seed=seed).of(apply)
        networks.append(fit.params)
        values = np.asarray(fit.params(X[None], load), float).reshape(len(steps), -1, 2, 2)
        fitted[steps] = np.eye(2) + values * amplitude[steps, None, None, None]
        losses.append(fit.losses)
    return FittedInterpolant(networks, t, amplitude, fitted, np.mean(losses, axis=0), fit.iterations)


def relative_variance(mesh: Mesh, misfit: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, " cell"]:
    """How uncertain F is in a cell, over the mean of the sheet: the squared misfit there and in the cells around it."""
    squared = np.mean(np.sum(misfit**2, axis=(2, 3)), axis=0)
    nodal = np.bincount(mesh.cells.ravel(), np.repeat(squared, 4)) / np.bincount(mesh.cells.ravel())
    around = nodal[mesh.cells].mean(axis=1)
    variance = around / max(around.mean(), np.finfo(float).tiny) + LEAST_VARIANCE
    return variance / variance.mean()
