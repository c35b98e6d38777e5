"""A network that learns a field is held to it on every cell, from as many starts as it takes."""

from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.config.methods import Pretraining
from hypernode.training import hypernetwork
from hypernode.training.loop import Fit
from hypernode.training.targets import Target


class Problem:
    """What pre-training asks of an inverse problem, with an error that is the output of the network."""

    name, has_field, centre, node = "sheet", True, jnp.zeros(1), None
    X = jnp.linspace(0.0, 1.0, 6)[:, None]
    # Of few materials, no network is trained.
    materials = np.arange(1000)

    def __init__(self, errors, settings):
        widths = SimpleNamespace(widths=(80, 80))
        self.method = SimpleNamespace(pretraining=settings, hypernetwork=widths, seed=1, prior_weight=0.0)
        self.errors = errors

    def trainable(self):
        return "first", lambda params: lambda X: jnp.full((len(X), 1), self.errors[params])

    def other_trainable(self, number):
        return f"other {number}", None

    def target(self):
        F = jnp.ones((2, 2, 1, len(self.X)))
        return Target(F, F, jnp.ones((2, 2, 1, 1)), jnp.ones(1))


@pytest.mark.parametrize(
    ("errors", "kept"),
    [
        ({"first": 0.005}, "first"),
        ({"first": 0.05, "went on": 0.004}, "went on"),
        ({"first": 0.05, "went on": 0.03, "other": 0.002}, "other"),
        ({"first": 0.05, "went on": 0.02, "other": 0.04}, "went on"),
    ],
)
def test_it_is_trained_again_until_it_is_close_and_the_best_is_kept(errors, kept, monkeypatch):
    ends, starts = iter(errors), []

    def minimise(loss, params, *_, **__):
        starts.append(params)
        return Fit(next(ends), np.ones(3), np.arange(3))

    monkeypatch.setattr(hypernetwork, "minimise", minimise)
    monkeypatch.setattr(Target, "relative_error", lambda self, node, params: float(params[0, 0]))
    problem = Problem(errors, Pretraining(iterations=3))
    fit = hypernetwork.pretrain(problem)
    assert float(fit.params(problem.X)[0, 0]) == pytest.approx(errors[kept])
    assert starts == ["first", "first", "other 2"][: len(errors)]
    assert len(fit.losses) == len(fit.iterations) == 3 * len(errors)


def test_the_relative_error_counts_every_load_case_in_its_unit(monkeypatch):
    monkeypatch.setattr("hypernode.training.targets.node_stress", lambda node, F, params: params)
    P = jax.random.normal(jax.random.key(0), (2, 2, 3, 5))
    scale = jnp.array([1.0, 10.0, 100.0])
    target = Target(P, P, jnp.ones((2, 2, 1, 1)), scale)
    assert target.relative_error(None, 1.02 * P * scale[:, None]) == pytest.approx(0.02, rel=1e-4)
