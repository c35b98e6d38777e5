"""The identified stress against the true one."""

import json

import numpy as np
import pytest
import xarray as xr

from hypernode.evaluation.ending import score_ending
from hypernode.evaluation.spread import coverage, interface_spread, open_share_of_lines, sample_spread
from hypernode.evaluation.truth import (
    cell_means,
    interface_band,
    observed_mode,
    score_networks,
    score_stress,
)
from hypernode.fem.mesh import rectilinear
from hypernode.material.files import material_of
from hypernode.mechanics.modes import MODES, mode_gradients
from tests.evaluation.files import closed_form, square_mesh

MESH = square_mesh(4)
F = mode_gradients([1.1, 1.2])


def test_means_over_cells_of_a_truth_on_a_finer_grid_are_means_of_its_cells():
    fine = square_mesh(8)
    mu = np.random.default_rng(1).uniform(1.0, 5.0, len(fine.cells))
    truth = closed_form(fine, "neo_hookean", mu=mu)
    found = cell_means(truth, material_of(truth), MESH, F[:1])
    mean = mu.reshape(4, 2, 4, 2).mean(axis=(1, 3)).ravel()
    for step, stretch in enumerate((1.1, 1.2)):
        np.testing.assert_allclose(found[0, step, :, 0, 0], mean * (stretch - stretch**-5), rtol=1e-12)


def test_a_truth_on_the_measured_grid_has_no_other_means():
    truth = closed_form(MESH, "neo_hookean", mu=1.0)
    assert cell_means(truth, material_of(truth), MESH, F[:1]) is None


def test_the_interface_band_is_one_cell_to_either_side():
    band = interface_band(MESH, MESH.centres[:, 0] > 0.5)
    np.testing.assert_array_equal(band, np.abs(MESH.centres[:, 0] - 0.5) < 0.25)


def test_a_load_is_judged_in_the_mode_that_is_closest_to_it():
    assert [MODES[observed_mode(kind)] for kind in ("biaxial", "clamped_x", "uniaxial_y")] == [
        "equibiaxial", "strip_x", "strip_y",
    ]  # fmt: skip


def test_an_error_of_one_phase_is_that_phase_s_alone():
    phase = (MESH.centres[:, 0] > 0.5).astype(int)
    true = np.ones((4, 2, len(phase), 2, 2)) * (1.0 + phase)[:, None, None]
    found = true * np.where(phase == 1, 1.2, 1.0)[:, None, None]
    judged = score_stress(MESH, found, true, phase, 2, 0)
    np.testing.assert_allclose(judged.variables["stress_error_phase"][0], 0.0, atol=1e-15)
    np.testing.assert_allclose(judged.variables["stress_error_phase"][1], 0.2, rtol=1e-12)
    # The stiff half has 4 of 5 parts of the squared stress, also away from the interface.
    for key in ("stress_error", "stress_error_all_modes", "stress_error_off_interface"):
        assert judged.summary[key] == pytest.approx(0.2 * 0.8**0.5, rel=1e-12)
    assert judged.summary["correlation"] == pytest.approx(1.0, rel=1e-12)


def test_networks_are_compared_with_their_field_all_together_and_by_the_worst_cell():
    field = 1.1 * np.ones((2, len(MESH.cells), 2, 2))
    assert score_networks(1.02 * field, field, MESH.areas).summary["network_error"] == pytest.approx(0.02)
    one = field.copy()
    one[:, 5] *= 3.0
    size = np.sqrt(np.einsum("scij,c->", field**2, MESH.areas / MESH.areas.sum()))
    worst = score_networks(one, field, MESH.areas).summary["network_error_worst_cell"]
    assert worst == pytest.approx(2.0 * np.linalg.norm(field[:, 5]) / size)
    without = score_networks(one, field, np.where(np.arange(len(MESH.cells)) == 5, 0.0, MESH.areas)).summary
    assert without == {"network_error": 0.0, "network_error_worst_cell": 0.0}


def test_two_standard_deviations_cover_the_gaussian_share_of_the_truth():
    rng = np.random.default_rng(4)
    spread = rng.uniform(0.1, 3.0, 200_000)
    error = rng.normal(0.0, spread)
    assert coverage(error, spread) == pytest.approx(0.9545, abs=0.002)
    assert coverage(3.0 * error, spread) == pytest.approx(0.495, abs=0.005), "a spread that is three times too sure"


def test_the_spread_of_posterior_samples_is_unbiased():
    samples = np.random.default_rng(5).normal(2.0, 0.3, (3, 200_000))
    assert np.sqrt(np.mean(sample_spread(samples) ** 2)) == pytest.approx(0.3, rel=0.01)


def test_at_the_centre_of_a_cell_that_an_interface_cuts_anywhere_a_field_is_as_uncertain_as_is_said():
    mesh = rectilinear(np.arange(7.0), np.arange(4.0))
    column = mesh.centres[:, 0].astype(int)
    phase, field = (column >= 3).astype(int), np.where(column >= 3, 5.0, 2.0)
    said = interface_spread(mesh, phase, field)
    assert np.all(said[(column < 2) | (column > 3)] == 0.0)
    # An interface x = a in a cell: its mean is 2 a + 5 (1 - a), and its centre is in the left part where a > 1/2.
    share = np.random.default_rng(3).uniform(size=200_000)
    error = 2.0 * share + 5.0 * (1.0 - share) - np.where(share > 0.5, 2.0, 5.0)
    assert said[(column == 2) | (column == 3)] == pytest.approx(np.sqrt(np.mean(error**2)), rel=0.01)
    assert not interface_spread(mesh, np.zeros_like(phase), field).any()


def test_a_centre_is_open_where_its_line_may_be_on_either_side():
    """Half on the line itself, and 2.3 % two standard deviations away from it."""
    cells = np.arange(12).reshape(3, 4)
    distance = np.repeat([0.0, 0.1, 3.0], 4)[None]
    lines = xr.Dataset({"interface_distance": (("interface", "node"), distance), "cells": (("cell", "vertex"), cells)})
    odds = np.array([0.5, 0.02275, 0.0])
    found = open_share_of_lines(lines.assign_attrs(line_error=0.05))
    np.testing.assert_allclose(found, odds * (1.0 - odds), atol=1e-5)


def test_how_a_descent_ended_is_copied_and_never_guessed():
    field = closed_form(MESH, "neo_hookean", mu=1.0)
    field.attrs |= {"ending": "stagnated", "misfits": json.dumps({"displacement": 1.02, "force": 0.4})}
    assert score_ending(field).summary == {"ending": "stagnated", "displacement_misfit": 1.02, "force_misfit": 0.4}
    field.attrs["left_out"] = json.dumps(
        {"steps": [4], "observed": 90, "directions": 9.0, "displacement": 1.1, "deformation": 0.004, "force": None}
    )
    assert score_ending(field).summary["left_out_displacement_misfit"] == 1.1
    assert "left_out_force_misfit" not in score_ending(field).summary
    del field.attrs["ending"]
    with pytest.raises(ValueError, match=r"does not say how its descent ended \(no attribute ending\)"):
        score_ending(field)
