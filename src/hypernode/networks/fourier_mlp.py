"""Multilayer perceptron on random Fourier features of the position."""

import dataclasses
import itertools
from collections.abc import Sequence

import jax
import jax.numpy as jnp
from flax import nnx
from jaxtyping import Array, Float


class Frequencies(nnx.Variable):
    """Random frequencies: fixed while the weights train."""


@dataclasses.dataclass(frozen=True)
class FourierArchitecture:
    """Sizes of a :class:`FourierMLP`.

    Attributes:
        features: number n of frequencies; the first layer sees 2 n features.
        frequency_scale: standard deviation of the frequencies, in cycles per unit of X.
        widths: widths of the hidden layers.
    """

    features: int
    frequency_scale: float
    widths: tuple[int, ...]


class FourierMLP(nnx.Module):
    """tanh network of [sin 2 pi B X, cos 2 pi B X, extra inputs], linear in its last layer.

    Args:
        architecture: sizes.
        extra_inputs: further inputs appended to the features as they are (load parameter t: 1).
        outputs: output width.
        rngs: streams ``frequencies`` and ``weights``, one key each so that neither depends on
            how much the other draws.
    """

    def __init__(self, architecture: FourierArchitecture, extra_inputs: int, outputs: int, rngs: nnx.Rngs):
        key = rngs.frequencies()
        scale = architecture.frequency_scale
        self.frequencies = Frequencies(scale * jax.random.normal(key, (2, architecture.features)))
        sizes: Sequence[int] = (2 * architecture.features + extra_inputs, *architecture.widths, outputs)
        init = nnx.initializers.glorot_normal()
        self.layers = nnx.List(
            nnx.Linear(a, b, kernel_init=init, rngs=nnx.Rngs(rngs.weights())) for a, b in itertools.pairwise(sizes)
        )

    def features(self, X: Float[Array, "... 2"]) -> Float[Array, "... feature"]:
        """sin 2 pi B X and cos 2 pi B X."""
        phase = 2.0 * jnp.pi * (X @ self.frequencies[...])
        return jnp.concatenate([jnp.sin(phase), jnp.cos(phase)], axis=-1)

    def __call__(
        self, X: Float[Array, "... 2"], extra: Float[Array, "... extra"] | None = None
    ) -> Float[Array, "... outputs"]:
        """Value at X; batch axes of X and ``extra`` broadcast, so a grid of positions by load
        parameters, X[1, point, 2] and extra[step, 1, 1], computes its features once a point."""
        features = self.features(X)
        first = self.layers[0]
        kernel, split = first.kernel[...], features.shape[-1]
        h = features @ kernel[:split] + first.bias[...]
        if extra is not None:
            h = h + extra @ kernel[split:]
        for layer in self.layers[1:]:
            h = layer(jnp.tanh(h))
        return h
