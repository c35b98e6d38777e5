"""Held edges: smoothed as far as their noise goes, with errors of the size that they have."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from hypernode.data import smoothing
from hypernode.data.boundary import prescribed_displacement
from hypernode.data.smoothing import roughness, smoothed
from hypernode.fem.mesh import rectilinear

NOISE = 1e-3
X = np.linspace(0.0, 1.0, 41) ** 1.2
SHAPES = {"straight": 0.1 + 0.2 * X, "bent": 0.02 * np.sin(5.0 * X)}


def test_roughness_is_the_integral_of_the_squared_curvature_of_the_natural_spline():
    values = np.sin(7.0 * X)
    curvature = CubicSpline(X, values, bc_type="natural").derivative(2)
    # Squares of straight pieces: Simpson's rule is exact.
    ends, middle = curvature(X), curvature((X[1:] + X[:-1]) / 2)
    exact = np.sum(np.diff(X) * (ends[1:] ** 2 + ends[:-1] ** 2 + 4.0 * middle**2)) / 6.0
    assert values @ roughness(X) @ values == pytest.approx(exact, rel=1e-9)
    lines = np.stack([np.ones_like(X), X], axis=1)
    assert np.abs(roughness(X) @ lines).max() < 1e-6 * np.abs(roughness(X)).max()


@pytest.mark.parametrize("shape", SHAPES)
def test_smoothed_values_miss_the_true_ones_by_what_their_errors_say(shape):
    rng = np.random.default_rng(4)
    missed, said = [], []
    for _ in range(80):
        measured = SHAPES[shape] + rng.normal(0.0, NOISE, X.shape)
        values, errors = smoothed(X, measured, NOISE)
        missed.append(np.mean((values - SHAPES[shape]) ** 2))
        said.append(np.mean(np.sum(errors**2, axis=1)))
    assert np.mean(missed) == pytest.approx(np.mean(said), rel=0.25)
    assert np.mean(missed) < 0.25 * NOISE**2


@pytest.mark.parametrize("place", [0.37, 0.55])
def test_where_an_interface_crosses_an_edge_its_kink_stays_and_errors_say_how_well_it_is_known(place):
    """One weight of roughness for the whole edge misses such a kink by 1.2 of the noise, and says half of that."""
    rng = np.random.default_rng(4)
    true = 0.25 * X - 0.2 * np.maximum(X - place, 0.0)
    near, missed, said = np.abs(X - place) < 0.06, [], []
    for _ in range(60):
        values, errors = smoothed(X, true + rng.normal(0.0, 0.3 * NOISE, X.shape), 0.3 * NOISE)
        missed.append((values - true) ** 2)
        said.append(np.sum(errors**2, axis=1))
    missed, said = np.mean(missed, axis=0) / (0.3 * NOISE) ** 2, np.mean(said, axis=0) / (0.3 * NOISE) ** 2
    assert missed.mean() < 0.2 and missed[near].mean() < 0.6
    assert missed[near].mean() < 1.5**2 * said[near].mean()


@pytest.mark.parametrize("places", [(0.31, 0.63), (0.41, 0.53)])
def test_where_an_inclusion_crosses_an_edge_both_of_its_kinks_stay(places):
    """Neither shows alone: as roughness they are missed by 0.7 of the noise."""
    rng = np.random.default_rng(4)
    true = 0.25 * X - 0.1 * (np.maximum(X - places[0], 0.0) - np.maximum(X - places[1], 0.0))
    missed, said = [], []
    for _ in range(30):
        values, errors = smoothed(X, true + rng.normal(0.0, 0.3 * NOISE, X.shape), 0.3 * NOISE)
        missed.append(np.mean((values - true) ** 2))
        said.append(np.mean(np.sum(errors**2, axis=1)))
    assert np.mean(missed) < (0.5 * 0.3 * NOISE) ** 2
    assert np.mean(missed) < 1.3**2 * np.mean(said)


def test_a_smooth_edge_has_no_kink(monkeypatch):
    rng = np.random.default_rng(5)
    for true in (*SHAPES.values(), 0.1 * X + 0.06 * np.tanh(6.0 * (X - 0.5))):
        for _ in range(20):
            measured = true + rng.normal(0.0, NOISE, X.shape)
            values, _ = smoothed(X, measured, NOISE)
            with monkeypatch.context() as without:
                without.setattr(smoothing, "MOST", 0)
                smoothing._smoothed.cache_clear()
                plain, _ = smoothed(X, measured, NOISE)
            smoothing._smoothed.cache_clear()
            assert np.array_equal(values, plain)


def test_without_noise_an_edge_is_taken_as_it_is():
    values, errors = smoothed(X, SHAPES["bent"], 0.0)
    assert np.array_equal(values, SHAPES["bent"]) and errors.shape == (len(X), 0)


def test_held_edges_are_smoothed_and_free_ones_left_alone():
    lines = np.linspace(0.0, 1.0, 41)
    mesh = rectilinear(lines, lines)
    exact = mesh.nodes @ np.array([[0.1, 0.0], [0.0, 0.2]])
    u = exact + np.random.default_rng(3).normal(0.0, NOISE, exact.shape)
    held = np.zeros((4, 2))
    held[1, 0] = held[3, 1] = 1.0
    edges = prescribed_displacement(mesh, u, held, [NOISE, NOISE])
    assert edges.mask.sum() == 2 * 41 and not edges.mask[mesh.on_edge("left"), 1][:-1].any()
    assert np.std((edges.values - exact)[edges.mask]) < 0.5 * NOISE
    assert not edges.errors[~edges.mask.ravel()].any()


def test_where_two_held_edges_meet_their_mean_counts_and_has_half_the_variance():
    lines = np.linspace(0.0, 1.0, 21)
    mesh = rectilinear(lines, lines)
    u = np.random.default_rng(3).normal(0.0, NOISE, (len(mesh.nodes), 2))
    both, each = np.zeros((4, 2)), np.zeros((2, 4, 2))
    both[[0, 2], 0] = each[0, 0, 0] = each[1, 2, 0] = 1.0
    corner = np.flatnonzero(mesh.on_edge("left") & mesh.on_edge("bottom"))[0]
    found = prescribed_displacement(mesh, u, both, [NOISE, NOISE])
    parts = [prescribed_displacement(mesh, u, held, [NOISE, NOISE]) for held in each]
    assert found.values[corner, 0] == pytest.approx(np.mean([part.values[corner, 0] for part in parts]))
    variances = [np.sum(part.errors[2 * corner] ** 2) for part in parts]
    assert np.sum(found.errors[2 * corner] ** 2) == pytest.approx(sum(variances) / 4.0)
