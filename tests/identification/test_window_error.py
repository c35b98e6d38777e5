"""A point that prescribes what it sees through a window is off where the displacement bends, and nowhere else."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.data.measurement import mesh_of
from hypernode.identification.camera import window_average
from hypernode.identification.problem import field_problem
from hypernode.identification.window_error import blurred_edges
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

NOISE, POINTS, KINK = 1e-4, 2.0, 10


def seen(before, after):
    """(measurement, displacement, what is seen of it) of a sheet with these slopes along x on both sides of a kink."""
    data, _, _ = sheet(20, square, make_load("uniaxial_x", [1.05]), noise=NOISE)
    grid = mesh_of(data)
    side, x = POINTS * grid.step, grid.nodes[:, 0]
    at = KINK * grid.step
    true = np.stack([np.where(x < at, before * x, before * at + after * (x - at)), 0.0 * x], axis=1)[None]
    mean = (window_average(grid, side, "average") @ true.ravel()).reshape(true.shape)
    noisy = mean + np.random.default_rng(2).normal(0.0, NOISE, mean.shape)
    stated = data.assign_attrs(mesh="finer", correlation_window=side, correlation_kernel="average")
    return stated.assign(u_measured=(data["u_measured"].dims, noisy[None])), true, noisy


def blurred(data, u):
    return blurred_edges(data, mesh_of(data), u, np.full((1, 2), NOISE))


def test_what_a_window_hides_of_a_kink_is_within_what_it_may_be():
    data, true, noisy = seen(0.02, 0.2)
    may = blurred(data, noisy)
    off = np.abs(noisy - true).max(axis=2) > 5.0 * NOISE
    assert off.any() and (may[off][:, 0] > 0.0).all()
    assert (np.abs(noisy - true)[off][:, 0] <= 3.0 * may[off][:, 0]).all()
    assert not may[..., 1].any()


def test_a_displacement_that_bends_nowhere_is_off_nowhere():
    data, _, noisy = seen(0.05, 0.05)
    assert not blurred(data, noisy).any()


@pytest.mark.parametrize(("unknown", "off"), [(0.0, False), (0.25, True)])
def test_a_window_that_nobody_stated_is_taken_for_a_usual_one(unknown, off):
    data, _, noisy = seen(0.02, 0.2)
    data = data.assign_attrs(correlation_window=0.0, window_uncertainty=unknown)
    assert blurred(data, noisy).any() == off


def test_edges_that_prescribe_a_kink_are_as_wrong_as_that():
    data, _, noisy = seen(0.02, 0.2)
    (boundary,) = field_problem(data.assign_attrs(outline="cut"), Constrained(terms=[])).observations.boundaries
    may, size = blurred(data, noisy)[0], np.sqrt(np.asarray(boundary.errors.power(2).sum(axis=1)).ravel())
    on_edge = np.flatnonzero(boundary.mask.ravel() & (may.ravel() > 0.0))
    assert len(on_edge) and (size[on_edge] >= may.ravel()[on_edge]).all()
