"""Weights of a network as named arrays, and back."""

import jax.numpy as jnp
import numpy as np
from flax import nnx
from jaxtyping import Array

from hypernode.networks.fourier_mlp import FourierArchitecture, FourierMLP


def _name(prefix: str, path) -> str:
    return f"{prefix}." + ".".join(str(part) for part in path)


def to_arrays(network: nnx.Module, prefix: str) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """{"<prefix>.<path>": (dimension names, array)} of every weight and frequency."""
    arrays = {}
    for path, variable in nnx.to_flat_state(nnx.state(network)):
        name = _name(prefix, path)
        value = np.asarray(variable[...])
        arrays[name] = (tuple(f"{name}.{axis}" for axis in range(value.ndim)), value)
    return arrays


def make_network(settings, extra_inputs: int, outputs: int, seed: int) -> FourierMLP:
    """A network of the configured sizes, frequencies and weights drawn from their own streams."""
    architecture = FourierArchitecture(settings.features, settings.frequency_scale, tuple(settings.widths))
    rngs = nnx.Rngs(frequencies=2 * seed, weights=2 * seed + 1)
    return FourierMLP(architecture, extra_inputs, outputs, rngs)


def from_arrays(settings, extra_inputs: int, outputs: int, arrays, prefix: str) -> FourierMLP:
    """The network of the configured sizes with the weights that :func:`to_arrays` named."""
    # Only the shapes of a new network: to draw weights that are replaced at once takes half a second.
    graph, state = nnx.split(nnx.eval_shape(lambda: make_network(settings, extra_inputs, outputs, 0)))
    loaded = []
    for path, variable in nnx.to_flat_state(state):
        value = jnp.asarray(np.asarray(arrays[_name(prefix, path)]), variable.dtype)
        if value.shape != variable.shape:
            raise ValueError(
                f"{_name(prefix, path)} has the shape {value.shape} where the network has {variable.shape}"
            )
        loaded.append((path, variable.replace(value)))
    return nnx.merge(graph, nnx.from_flat_state(loaded))


def split_trainable(network: nnx.Module):
    """(params, apply) with ``apply(params)`` the network holding those weights; frequencies stay."""
    graph, params, rest = nnx.split(network, nnx.Param, ...)

    def apply(values: Array) -> nnx.Module:
        return nnx.merge(graph, values, rest)

    return params, apply
