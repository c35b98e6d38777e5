"""The network of a field of few materials is each of them at every cell of its own."""

from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr

from hypernode.config.methods import Method
from hypernode.config.presets import presets
from hypernode.material.basis_file import basis_content
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.networks.weights import make_network
from hypernode.training.few_materials import FEW, fit_materials, learn_few_materials
from hypernode.training.homogenised import terms_for
from hypernode.training.levenberg import least_squares
from hypernode.training.separation import separate
from hypernode.training.targets import Target

LINES = (np.arange(16) + 0.5) / 16
CENTRES = np.stack(np.meshgrid(LINES, LINES), axis=-1).reshape(-1, 2)
FIBRE = 0.05


def disc_and_strip(X):
    """Three regions: a disc, a strip, and what is around them."""
    return np.where(np.hypot(*(X - 0.35).T) < 0.2, 1, np.where(X[:, 0] > 0.8, 2, 0))


def features(X, frequencies=200, scale=2.8):
    phase = 2.0 * np.pi * X @ (scale * np.random.default_rng(0).normal(size=(2, frequencies)))
    return np.concatenate([np.sin(phase), np.cos(phase)], axis=-1)


@pytest.mark.parametrize("regions", [1, 2, 3])
def test_each_function_is_positive_in_its_region_alone(regions):
    labels = np.minimum(disc_and_strip(CENTRES), regions - 1)
    found = separate(features(CENTRES), labels)
    assert sorted([found.background, *found.regions]) == list(range(regions))
    value = features(CENTRES) @ found.weights[:-1] + found.weights[-1]
    for k, region in enumerate(found.regions):
        assert np.array_equal(value[:, k] > 0.0, labels == region)
        assert np.abs(value[:, k]).min() == pytest.approx(found.margins[k])


def test_between_the_cells_regions_go_on():
    labels = np.minimum(disc_and_strip(CENTRES), 1)
    found = separate(features(CENTRES), labels)
    between = CENTRES + 0.5 / 16
    distance = np.abs(np.hypot(*(between - 0.35).T) - 0.2)
    inside = (distance > 1.5 / 16) & (between < 0.95).all(axis=1) & (between[:, 0] < 0.7)
    value = (features(between) @ found.weights[:-1] + found.weights[-1])[inside, 0]
    assert np.array_equal(value > 0.0, disc_and_strip(between)[inside] == 1)


def test_regions_that_features_cannot_tell_apart_are_none():
    assert separate(CENTRES, np.arange(len(CENTRES)) % 2) is None


def test_least_squares_finds_a_curve_and_ends_where_it_is_near_enough():
    def residual(params, data):
        return params[0] * jnp.exp(params[1] * data["x"]) - data["y"]

    data = {"x": jnp.linspace(0.0, 1.0, 9)}
    data["y"] = 2.0 * jnp.exp(-1.5 * data["x"])
    params, squares = least_squares(residual, 50, 1e-10)(np.array([1.0, 0.0]), data)
    assert params == pytest.approx([2.0, -1.5], rel=1e-3)
    assert squares[-1] < 1e-10 < squares[-2] and (np.diff(squares) < 0.0).all()
    _, squares = least_squares(residual, 2, 1e-10)(np.array([1.0, 0.0]), data)
    assert len(squares) == 3


@pytest.mark.parametrize("batch", [(), (7,)])
def test_squared_departures_add_up_to_the_prior(batch):
    node = NodeMaterial(
        terms=("I1", "I2", "I1_I4v"), hidden=(4, 4), steps=2, invariant_scale=0.3, stress_scale=1.2, scaled=True
    )
    params = jax.random.normal(jax.random.key(0), (node.size,))
    centre = jax.random.normal(jax.random.key(1), (node.size,))
    alike = jnp.broadcast_to(params[:, None], (node.size, 7))
    assert jnp.sum(node.departures(params, centre) ** 2) == pytest.approx(
        float(node.departure(alike, centre)), rel=1e-5
    )


def problem(materials, stiffness=(1.0, 3.0, 0.5), law="fibre"):
    """A sheet of some materials with fibres of their own, or of kept volume, pulled to 1.2 in two directions."""
    method = Method.model_validate(presets()["hypernode"])
    node = NodeMaterial(
        terms=terms_for(method.node, (law,)),
        hidden=(4, 4),
        steps=2,
        invariant_scale=0.3,
        stress_scale=1.0,
        share=0.1,
        scaled=True,
    )
    basis = ConvexBasis((law,), 0.3)
    further = {"fibre": lambda k: [0.1, FIBRE * k, -2.0], "J": lambda k: [0.0, np.log(2.0)]}[law]
    values = np.array([[np.log(stiffness[k]), *further(k)] for k in range(3)]).T
    labels = np.minimum(disc_and_strip(CENTRES), materials - 1)
    field = values[:, labels]
    content, attributes = basis_content(basis, field[:, None])
    stretches = np.array([[1.1, 1.0], [1.2, 1.0], [1.2, 1.2], [1.05, 1.05]])
    F = np.zeros((2, 2, 4, len(CENTRES)))
    F[0, 0], F[1, 1] = stretches[:, :1], stretches[:, 1:]
    F = jnp.asarray(F + 0.02 * np.random.default_rng(0).normal(size=F.shape), jnp.float32)
    P = basis.stress(F, jnp.asarray(field, jnp.float32)[:, None])
    network = make_network(method.hypernetwork.model_copy(update={"frequency_scale": 2.8}), 0, node.size, 1)
    inputs = {"constrained": xr.Dataset(content, attrs=attributes)}
    own = SimpleNamespace(
        name="sheet", method=method, node=node, inputs=inputs, materials=labels, F=F[:, :, :3], X=jnp.asarray(CENTRES),
        centre=node.initial_params(jax.random.key(0)), new_network=lambda: network,
    )  # fmt: skip
    return own, Target(F, P, jnp.ones((2, 2, 1, 1)), jnp.ones(4))


@pytest.mark.parametrize("materials", [1, 3])
def test_the_stress_of_every_cell_is_learnt_to_the_tolerance(materials):
    own, target = problem(materials)
    fit = learn_few_materials(own, target)
    assert target.errors(own.node, fit.params(own.X).T).max() < own.method.pretraining.tolerance
    assert len(fit.losses) == len(fit.iterations)
    assert (np.diff(fit.losses) <= 0.0).all() and fit.losses[-1] < 0.1 * fit.losses[0]


def test_an_area_that_resists_its_loss_more_than_its_growth_is_learnt():
    """A sheet of kept volume, whose energy of the area is 2 J + 1/J^2."""
    own, target = problem(2, law="J")
    _, missed, _ = fit_materials(own, target)
    assert np.sqrt(missed.max()) < 0.5 * own.method.pretraining.tolerance


def test_many_materials_are_left_to_a_descent():
    own, target = problem(1)
    own.materials = np.arange(len(CENTRES)) % (FEW + 1)
    assert learn_few_materials(own, target) is None
