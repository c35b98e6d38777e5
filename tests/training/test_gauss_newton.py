"""Gauss-Newton steps lower the squares of many parameters, with some of the residuals at a time."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.training.gauss_newton import gauss_newton

X = np.linspace(-1.0, 1.0, 200)


def _curve(params, at):
    return jnp.tanh(at[:, None] * params["slope"] + params["shift"]) @ params["size"]


def _fit(steps, enough):
    true = {"slope": jnp.array([1.0, 3.0]), "shift": jnp.array([0.2, -0.5]), "size": jnp.array([1.0, 0.5])}
    start = jax.tree.map(lambda each: each + 0.2, true)
    seen = _curve(true, jnp.asarray(X))

    def residual(params, sample):
        return _curve(params, jnp.asarray(X)[sample]) - seen[sample]

    every = jnp.arange(len(X))
    draw = np.random.default_rng(0)
    samples = (jnp.asarray(draw.choice(len(X), 50, replace=False)) for _ in range(steps))
    return gauss_newton(residual, lambda params: jnp.abs(residual(params, every)), start)(start, samples, enough)


def test_it_ends_at_the_parameters_that_made_the_data():
    params, errors = _fit(20, 0.0)
    assert errors[-1] < 1e-2 * errors[0]
    assert params["slope"] == pytest.approx([1.0, 3.0], abs=0.3)


def test_it_takes_no_step_where_the_error_is_small_enough():
    params, errors = _fit(20, 1e9)
    assert len(errors) == 1
    assert params["slope"] == pytest.approx([1.2, 3.2])
