"""A network that learns a field is held to it on every cell, in every load step, from as many starts as it takes."""

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

    def __init__(self, settings):
        widths = SimpleNamespace(widths=(80, 80))
        self.method = SimpleNamespace(pretraining=settings, hypernetwork=widths, seed=1, prior_weight=0.0)

    def trainable(self):
        return "first", lambda params: lambda X: jnp.full((len(X), 1), params)

    def other_trainable(self, number):
        return f"other {number}", None

    def target(self):
        F = jnp.ones((2, 2, 1, len(self.X)))
        return Target(F, F, jnp.ones((2, 2, 1, 1)), jnp.ones(1))


@pytest.mark.parametrize(
    ("trained", "nearer", "kept"),
    [
        ([0.005], [0.005], 0.005),
        ([0.05], [0.004], 0.004),
        ([0.05, 0.03], [0.03, 0.002], 0.002),
        ([0.05, 0.04, 0.03], [0.02, 0.03, 0.025], 0.02),
    ],
)
def test_steps_go_on_and_trainings_begin_again_until_the_network_is_close(trained, nearer, kept, monkeypatch):
    """Steps see all cells, the worst load step decides, and the best network is kept."""
    ends, after, starts = iter(trained), iter(nearer), []

    def minimise(loss, params, *_, **__):
        starts.append(params)
        return Fit(jnp.array(next(ends)), np.ones(3), np.arange(3))

    def gauss_newton(residual, errors, like):
        def solve(params, samples, enough):
            assert errors(params).max() == params
            assert {tuple(np.sort(each)) for each in samples} == {tuple(range(6))}
            end = next(after)
            return jnp.array(end), [float(params), end]

        return solve

    monkeypatch.setattr(hypernetwork, "minimise", minimise)
    monkeypatch.setattr(hypernetwork, "gauss_newton", gauss_newton)
    monkeypatch.setattr(Target, "errors", lambda self, node, params: jnp.array([0.0, params[0, 0]]))
    fit = hypernetwork.pretrain(Problem(Pretraining(iterations=3)))
    assert float(fit.params(Problem.X)[0, 0]) == pytest.approx(kept)
    assert starts == ["first", "other 1", "other 2"][: len(trained)]
    assert len(fit.losses) == len(fit.iterations) == 3 * len(trained)


def test_every_load_case_has_a_relative_error_in_its_unit(monkeypatch):
    monkeypatch.setattr("hypernode.training.targets.node_stress", lambda node, F, params: params)
    P = jax.random.normal(jax.random.key(0), (2, 2, 3, 5))
    scale = jnp.array([1.0, 10.0, 100.0])
    target = Target(P, P, jnp.ones((2, 2, 1, 1)), scale)
    assert target.errors(None, 1.02 * P * scale[:, None]) == pytest.approx(np.full(3, 0.02), rel=1e-4)
