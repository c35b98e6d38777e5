"""The one training loop: every stage that fits a network calls :func:`minimise`."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np
import optax

from hypernode.errors import ExpectedError
from hypernode.progress import Progress

#: Iterations compiled into one call; the loop looks for divergence between calls.
CHUNK = 50


class DivergenceError(ExpectedError, RuntimeError):
    """A loss became infinite or not a number; the message names the stage, case and step."""


def make_optimiser(algorithm: str, learning_rate: float, iterations: int) -> optax.GradientTransformation:
    """Adam or Muon, with a cosine decay of the learning rate to zero."""
    schedule = optax.cosine_decay_schedule(learning_rate, max(iterations, 1))
    return optax.contrib.muon(schedule) if algorithm == "muon" else optax.adam(schedule)


def data_as_arguments(function: Callable, *arguments):
    """(function of (data, *arguments), data) for a function of one value that closes over its data.

    Arrays that a compiled function closes over are part of its program, so that every case would compile its own.
    As arguments they are not, and cases of the same shapes share what was compiled once.
    """
    traced = jax.make_jaxpr(function)(*arguments)

    def evaluate(data, *arguments):
        (value,) = jax.core.eval_jaxpr(traced.jaxpr, data, *jax.tree.leaves(arguments))
        return value

    return evaluate, traced.consts


def compiled(function: Callable) -> Callable:
    """The same function of arrays, compiled where it is first called by :func:`data_as_arguments`."""
    made = []

    def call(*arguments):
        if not made:
            evaluate, data = data_as_arguments(function, *arguments)
            made.extend((jax.jit(evaluate), data))
        return made[0](made[1], *arguments)

    return call


class Fit(NamedTuple):
    """Where a training ended.

    Attributes:
        params: trained parameters, or the network that they make.
        losses, iterations: recorded loss, and the iteration of each record.
    """

    params: object
    losses: np.ndarray
    iterations: np.ndarray

    def of(self, apply: Callable) -> "Fit":
        """The same with the network that the parameters make."""
        return self._replace(params=apply(self.params))


def minimise(loss: Callable, params, settings, *, stage: str, case: str, seed: int) -> Fit:
    """Minimise ``loss(params, key)`` by stochastic gradients.

    Args:
        loss: scalar function of the parameters and of a random key that changes every iteration.
        params: pytree of float32 arrays to start from.
        settings: an :class:`~hypernode.config.Optimiser`.
        stage, case: named in progress lines and errors.
        seed: seed of the keys.

    Raises:
        DivergenceError: the loss is no longer finite.
    """
    iterations = settings.iterations
    if iterations == 0:
        value = float(jax.jit(loss)(params, jax.random.key(seed)))
        return Fit(params, np.array([value], np.float32), np.array([0]))
    optimiser = make_optimiser(settings.algorithm, settings.learning_rate, iterations)
    length = min(CHUNK, iterations)
    evaluate, data = data_as_arguments(loss, params, jax.random.key(seed))

    @jax.jit
    def chunk(data, params, state, key):
        """A block of optimiser steps, compiled once."""

        def step(carry, key):
            params, state = carry
            value, gradient = jax.value_and_grad(evaluate, argnums=1)(data, params, key)
            updates, state = optimiser.update(gradient, state, params)
            return (optax.apply_updates(params, updates), state), value

        (params, state), values = jax.lax.scan(step, (params, state), jax.random.split(key, length))
        return params, state, values

    state, key = optimiser.init(params), jax.random.key(seed)
    progress = Progress(stage, case, iterations)
    losses, steps = [], []
    for start in range(0, iterations, length):
        key, now = jax.random.split(key)
        params, state, values = chunk(data, params, state, now)
        values = np.asarray(values)
        if not np.isfinite(values).all():
            bad = start + int(np.flatnonzero(~np.isfinite(values))[0])
            raise DivergenceError(
                f"{stage} of {case}: the loss is {values[bad - start]} at iteration {bad}; "
                "lower the learning rate of this stage"
            )
        losses.append(values)
        steps.append(np.arange(start, start + length))
        progress.advance(length, loss=float(values[-1]))
    return Fit(params, np.concatenate(losses), np.concatenate(steps))
