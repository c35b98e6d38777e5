"""Weights of a network as named arrays, and back."""

import numpy as np
from flax import nnx
from jaxtyping import Array

from hypernode.networks.fourier_mlp import FourierArchitecture, FourierMLP


def to_arrays(network: nnx.Module, prefix: str) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """{"<prefix>.<path>": (dimension names, array)} of every weight and frequency."""
    arrays = {}
    for path, variable in nnx.to_flat_state(nnx.state(network)):
        name = f"{prefix}." + ".".join(str(part) for part in path)
        value = np.asarray(variable[...])
        arrays[name] = (tuple(f"{name}.{axis}" for axis in range(value.ndim)), value)
    return arrays


def from_arrays(network: nnx.Module, arrays, prefix: str) -> nnx.Module:
    """Load the weights that :func:`to_arrays` named into a network of the same sizes."""
    state = nnx.state(network)
    for path, variable in nnx.to_flat_state(state):
        name = f"{prefix}." + ".".join(str(part) for part in path)
        variable[...] = np.asarray(arrays[name])
    nnx.update(network, state)
    return network


def make_network(settings, extra_inputs: int, outputs: int, seed: int) -> FourierMLP:
    """A network of the configured sizes, frequencies and weights drawn from their own streams."""
    architecture = FourierArchitecture(settings.features, settings.frequency_scale, tuple(settings.widths))
    rngs = nnx.Rngs(frequencies=2 * seed, weights=2 * seed + 1)
    return FourierMLP(architecture, extra_inputs, outputs, rngs)


def split_trainable(network: nnx.Module):
    """(params, apply) with ``apply(params)`` the network holding those weights; frequencies stay."""
    graph, params, rest = nnx.split(network, nnx.Param, ...)

    def apply(values: Array) -> nnx.Module:
        return nnx.merge(graph, values, rest)

    return params, apply
