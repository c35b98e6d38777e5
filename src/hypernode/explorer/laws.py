"""Materials as the page holds them: a law as text, and its parameters in every cell in few bits."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.evaluation.spread import sample_spread
from hypernode.explorer.packing import BITS, Arrays, restored
from hypernode.explorer.tracing import trace
from hypernode.material.field import Material

#: Relative error of the stress, at any cell, that rounding the parameters may make: a fifth of the one in a hundred
#: within which the page promises to agree with the material.
STRESS_ERROR = 2e-3
#: The same of the standard deviation of the posterior samples, of which eight know no more than a quarter.
SPREAD_ERROR = 0.05
#: Bits of a parameter that are tried, the fewest first.
TRIED = (8, 10, 12, 14, BITS)
#: Directions and stretches, as shares of the largest, in which errors are measured.
DIRECTIONS, SHARES = np.arange(0.0, 180.0, 30.0), (0.1, 0.5, 1.0)


def probes(largest: float) -> Float[np.ndarray, "state 2 2"]:
    """Deformation gradients in which errors are measured: equibiaxial, and pulled and sheared along some directions."""
    angles = np.deg2rad(DIRECTIONS)
    along = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    states = []
    for extra in np.multiply(SHARES, largest - 1.0):
        states.append((1.0 + extra) * np.eye(2)[None])
        for a, b in zip(along, across, strict=True):
            pulled = (1.0 + extra) * np.outer(a, a) + (1.0 + extra) ** -0.5 * np.outer(b, b)
            states.append(np.stack([pulled, np.eye(2) + extra * np.outer(a, b)]))
    return np.concatenate(states)


def pack_material(material: Material, X: Float[np.ndarray, "cell 2"], largest: float, arrays: Arrays) -> dict:
    """A material at some positions.

    Args:
        material: what the page will evaluate.
        X: cell centres, in the length unit of the test.
        largest: largest stretch at which it is asked.
        arrays: where its parameters go.

    Returns:
        ``law``: text of a function (F, p); ``params``: entries of its parameters, which stand one after the other in p.

    Raises:
        ExplorerError: the law has no text.
    """
    stress, params = material.stress_law(X)
    leaves, tree = jax.tree.flatten(params)
    leaves = [np.asarray(leaf, float) for leaf in leaves]
    states = probes(largest)
    wanted = _stresses(stress, params, states, len(X))

    def error(rounded) -> float:
        found = _stresses(stress, tree.unflatten(rounded), states, len(X))
        return _largest(np.linalg.norm(found - wanted, axis=(1, 2)), np.linalg.norm(wanted, axis=(1, 2)))

    bits = _fewest_bits(leaves, error, STRESS_ERROR)
    law = trace(stress, jax.tree.map(lambda leaf: leaf[..., :1], params))
    return {"law": law.javascript, "params": [arrays.add(leaf, bits) for leaf in leaves]}


def pack_posterior(material: Material, X: Float[np.ndarray, "cell 2"], largest: float, arrays: Arrays) -> dict:
    """All posterior samples of a constrained field, to first order in their distance from it.

    Args:
        material: of :func:`~hypernode.material.files.posterior_material`: its parameters are those of the field, which
            are the same in every sample, and the change of each sample.
        X, largest, arrays: as of :func:`pack_material`.

    Returns:
        ``law`` and ``params`` of the field, as there; ``changes``: entry (parameter, sample, cell), which stand in p
        after those.
    """
    cells = len(X)
    stress, (best, change) = material.stress_law(X)
    shape = (*best.shape[:-1], -1, cells)
    best = np.asarray(best, float).reshape(shape)[..., 0, :]
    change = np.asarray(change, float).reshape(shape)
    samples = change.shape[-2]
    states = probes(largest)

    def spread(best, change):
        params = np.broadcast_to(best[..., None, :], change.shape), change
        flat = tuple(each.reshape(*each.shape[:-2], -1) for each in params)
        found = _stresses(stress, flat, states, samples * cells).reshape(len(states), 4, samples, cells)
        return sample_spread(np.moveaxis(found, 2, 0))

    wanted = spread(best, change)
    leaves = [best, change]
    bits = _fewest_bits(
        leaves,
        lambda rounded: _largest(np.linalg.norm(spread(*rounded) - wanted, axis=1), np.linalg.norm(wanted, axis=1)),
        SPREAD_ERROR,
    )
    one = tuple(jnp.asarray(each.reshape(*each.shape[: best.ndim - 1], -1)[..., :1], jnp.float32) for each in leaves)
    return {
        "law": trace(stress, one).javascript,
        "params": [arrays.add(best, bits)],
        "changes": arrays.add(change.reshape(-1, samples, cells), bits),
    }


def _stresses(stress: Callable, params, states, points: int) -> Float[np.ndarray, "state 2 2 point"]:
    """P[state, i, J, point] where all points undergo the same deformations."""
    params = jax.tree.map(lambda leaf: jnp.asarray(leaf, jnp.float32), params)
    each = (jnp.broadcast_to(jnp.asarray(F, jnp.float32)[..., None], (2, 2, points)) for F in states)
    return np.stack([np.asarray(stress(F, params), float) for F in each])


def _largest(error: np.ndarray, size: np.ndarray) -> float:
    """The largest relative error, of whatever has one."""
    known = np.isfinite(error) & (size > 0.0)
    return float((error[known] / size[known]).max(initial=0.0))


def _fewest_bits(leaves: list[np.ndarray], error: Callable[[list], float], allowed: float) -> int:
    """The fewest bits of a number with which the error is allowed, or else the most."""
    for bits in TRIED[:-1]:
        if error([restored(leaf, bits) for leaf in leaves]) <= allowed:
            return bits
    return TRIED[-1]
