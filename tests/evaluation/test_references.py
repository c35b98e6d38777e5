"""Sheets of one identified phase."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr

from hypernode.evaluation.references import pulled_sheet, reference_forces, typical_places
from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.progress import Progress


def test_a_homogeneous_sheet_pulls_with_stress_times_cross_section_on_every_edge():
    node = NodeMaterial(terms=("I1", "I2"), hidden=(4,), steps=2, invariant_scale=0.4, stress_scale=1.0)
    params = jnp.asarray(node.initial_params(jax.random.key(3)), float)
    mesh = rectilinear(np.linspace(0.0, 4.0, 7), np.linspace(0.0, 2.0, 5))
    F = np.array([[0.96, 0.0], [0.0, 1.12]])
    u = mesh.nodes @ (F - np.eye(2)).T
    measurement = xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
            "u_measured": (("repeat", "load_step", "node", "i"), u[None, None]),
            "relaxation": (("load_step",), np.ones(1)),
            "noise_level": (("load_step", "i"), np.zeros((1, 2))),
            "relative_thickness": ("cell", np.ones(len(mesh.cells))),
        },
        attrs={"thickness": 0.5},
    )
    forces = pulled_sheet(measurement, node, params[None], Progress("references", "sheet", 1))
    P = np.asarray(node_stress(node, jnp.asarray(F)[..., None], params[:, None]))[..., 0]
    width = {"left": (-2.0, 0.0), "right": (2.0, 0.0), "bottom": (0.0, -4.0), "top": (0.0, 4.0)}
    wanted = np.array([0.5 * P @ width[edge] for edge in EDGE_NAMES])
    np.testing.assert_allclose(forces[0], wanted, rtol=1e-5, atol=1e-6 * np.abs(wanted).max())
    field = jnp.tile(params, (len(mesh.cells), 1, 1))
    again = pulled_sheet(measurement, node, field, Progress("references", "sheet", 1))
    np.testing.assert_array_equal(again, forces)
    other = jnp.asarray(node.initial_params(jax.random.key(4)), float) + 0.3
    alone = pulled_sheet(measurement, node, other[None], Progress("references", "sheet", 1))
    both = pulled_sheet(measurement, node, jnp.stack([params, other]), Progress("references", "sheet", 1))
    np.testing.assert_allclose(both, 0.5 * (forces + alone), rtol=1e-5, atol=1e-6 * np.abs(alone).max())
    assert np.abs(alone - forces).max() > 0.1 * np.abs(forces).max()


def test_other_frames_of_a_test_are_predicted_with_the_relaxation_of_those_that_are_used():
    """Their own record has seen the forces that they are judged by; it may say anything and changes nothing."""
    mesh = rectilinear(np.array([0.0, 2.0, 4.0]), np.array([0.0, 2.0]))
    node = NodeMaterial(terms=("I1", "I2"), hidden=(4,), steps=4, invariant_scale=1.0, stress_scale=1.0)
    params = np.asarray(node.initial_params(jax.random.key(3)), float)
    u = mesh.nodes * (0.1, -0.04)
    sheet = xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
            "u_measured": (("repeat", "load_step", "node", "i"), u[None, None]),
            "relaxation": (("load_step",), np.array([1.25])),
            "noise_level": (("load_step", "i"), np.zeros((1, 2))),
            "relative_thickness": ("cell", np.ones(len(mesh.cells))),
            "time": (("load_step",), np.array([3.0])),
        },
        attrs={"thickness": 0.5},
    )
    identified = xr.Dataset(
        {
            "relaxation_time": (("test", "record_sample"), [[2.0, 4.0]]),
            "relaxation_factor": (("test", "record_sample"), [[1.5, 1.3]]),
        },
        attrs={"pace": json.dumps([1.4 / 0.9])},
    )
    progress = Progress("references", "sheet", 9)
    everywhere = lambda places: np.tile(params[:, None], len(places))  # noqa: E731
    found = reference_forces("whole", sheet, identified, None, node, everywhere, progress)
    elastic = pulled_sheet(sheet, node, params[None], progress)
    np.testing.assert_allclose(found, 0.9 * elastic, rtol=1e-12)
    other = sheet.assign(relaxation=("load_step", np.array([7.0])))
    np.testing.assert_array_equal(reference_forces("whole", other, identified, None, node, everywhere, progress), found)


def test_a_phase_is_represented_by_its_middle_half_and_of_an_absent_one_nothing_is_predicted(capsys):
    mesh = rectilinear(np.arange(8.0), np.arange(2.0))
    evaluation = xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
            "shape": ("cell", [0, 1, 1, 1, 1, 1, 0]),
            "trace_P": ("cell", [1.0, 9.0, 5.0, 7.0, 6.0, 8.0, 3.0]),
        }
    )
    middle = [[4.5, 0.5], [3.5, 0.5], [3.5, 0.5], [3.5, 0.5], [5.5, 0.5]]
    np.testing.assert_array_equal(typical_places(evaluation, "inclusion"), middle)
    none = evaluation.assign(shape=("cell", np.zeros(7, int)))
    sheet = xr.Dataset({"edge_force": (("load_step", "edge", "i"), np.ones((3, 4, 2)))})
    forces = reference_forces("inclusion", sheet, None, none, None, None, Progress("references", "sheet", 3))
    assert forces.shape == (3, 4, 2) and np.isnan(forces).all()
    assert "no forces of the inclusion" in capsys.readouterr().err
    assert len(typical_places(none, "matrix")) == 5
