"""Forces and equilibrium of a stress field, and the deformation at which it is taken."""

import numpy as np
import pytest

from hypernode.data.loading import Loading
from hypernode.evaluation.equilibrium import (
    edge_force_error,
    edge_resultants,
    equilibrium_gap,
    nodal_forces,
    nodal_residual,
    score_equilibrium,
    stress_at,
)
from hypernode.fem.mesh import EDGES, rectilinear
from hypernode.material.files import material_of
from tests.evaluation.files import closed_form, measurement

MESH = rectilinear(np.linspace(0.0, 4.0, 9), np.linspace(0.0, 2.0, 6))
ROLLERS = [("left", 0), ("right", 0), ("bottom", 1), ("top", 1)]
PULL = [("left", 0), ("right", 0)]


def outward(P):
    """Resultants (edge, i) of a uniform stress on the 4 x 2 sheet."""
    length = {0: 2.0, 1: 4.0}
    return np.array([sign * length[axis] * P[:, axis] for axis, sign in EDGES.values()])


def layered():
    """P_xX that varies from layer to layer alone, which is in equilibrium, and the test that carries it."""
    height = MESH.centres[:, 1]
    P = np.zeros((1, len(MESH.cells), 2, 2))
    P[0, :, 0, 0] = 1.0 + 0.3 * np.cos(5.0 * height)
    pull = np.sum(MESH.areas * P[0, :, 0, 0]) / 4.0
    forces = np.zeros((1, 4, 2))
    forces[0, :2, 0] = -pull, pull
    return P, measurement(MESH, [np.diag([1.2, 0.9])], forces, PULL)


def test_edge_forces_of_a_homogeneous_sheet_are_stress_times_section():
    P = np.array([[1.5, 0.4], [-0.2, 0.7]])
    loading = Loading.of(measurement(MESH, [np.diag([1.1, 1.2])], outward(P)[None], ROLLERS))
    field = np.tile(P, (1, len(MESH.cells), 1, 1))
    forces = edge_resultants(MESH, loading, nodal_forces(MESH, field), np.ones((1, 2)))[0]
    for number, edge in enumerate(EDGES):
        i = EDGES[edge][0]
        assert forces[number, i] == pytest.approx(outward(P)[number, i], rel=1e-12)
        assert np.isnan(forces[number, 1 - i]), "nothing holds that component"


def test_a_layered_stress_is_in_equilibrium_with_its_resultant():
    P, test = layered()
    loading = Loading.of(test)
    assert equilibrium_gap(MESH, loading, P).max() < 1e-12
    assert nodal_residual(MESH, loading, nodal_forces(MESH, P), P).max() < 1e-12


def test_the_gap_of_a_disturbed_stress_is_at_most_the_disturbance_and_grows_with_it():
    P, test = layered()
    loading, disturbed = Loading.of(test), P.copy()
    disturbed[0, 17] += [[0.2, 0.1], [-0.1, 0.3]]
    size = np.sqrt(MESH.areas[17] * np.sum((disturbed - P) ** 2) / MESH.areas.sum()) / loading.scale[0]
    gap = equilibrium_gap(MESH, loading, disturbed)[0]
    assert 0.1 * size < gap <= size
    assert equilibrium_gap(MESH, loading, 2.0 * disturbed - P)[0] == pytest.approx(2.0 * gap, rel=1e-9)
    assert nodal_residual(MESH, loading, nodal_forces(MESH, disturbed), disturbed)[0] > 0.01


def test_a_stress_that_misses_the_force_is_in_equilibrium_at_the_nodes_but_not_with_the_test():
    P, test = layered()
    loading, weak = Loading.of(test), 0.9 * P
    assert nodal_residual(MESH, loading, nodal_forces(MESH, weak), weak)[0] < 1e-12
    assert equilibrium_gap(MESH, loading, weak)[0] == pytest.approx(0.1, rel=1e-9)
    judged = score_equilibrium(MESH, loading, test, np.tile(np.eye(2), (1, len(MESH.cells), 1, 1)), weak, "measured")
    assert judged.summary["edge_force_error_measured"] == pytest.approx(0.1, rel=1e-9)


def test_ends_of_a_cut_grid_carry_different_parts_of_one_force():
    measured = np.full((1, 4, 2), np.nan)
    measured[0, :2, 0] = -2.0, 2.0
    found, held = measured + np.array([0.1, 0.1, 0.0, 0.0])[:, None], np.isfinite(measured)
    assert edge_force_error(found, measured, held) == pytest.approx([0.05])
    assert edge_force_error(found, measured, held, cut=True) == pytest.approx([0.0], abs=1e-12)
    assert edge_force_error(1.1 * measured, measured, held, cut=True) == pytest.approx([0.1])


def test_thickness_and_relaxation_turn_stress_into_recorded_force():
    P, test = layered()
    recorded = test.assign(relaxation=("load_step", [1.25]), edge_force=test["edge_force"] * 0.5 * 1.25)
    recorded.attrs["thickness"] = 0.5
    F = np.tile(np.eye(2), (1, len(MESH.cells), 1, 1))
    judged = score_equilibrium(MESH, Loading.of(recorded), recorded, F, P, "identified")
    np.testing.assert_allclose(
        judged.variables["edge_force_at_identified"], recorded["edge_force"].values, rtol=1e-12, atol=1e-12
    )
    assert judged.summary["equilibrium_gap_identified"] < 1e-12


def test_the_principal_strain_is_that_of_the_largest_stretch():
    P, test = layered()
    c, s = np.cos(0.7), np.sin(0.7)
    F = np.tile(np.array([[c, -s], [s, c]]) @ np.diag([1.3, 0.8]), (1, len(MESH.cells), 1, 1))
    judged = score_equilibrium(MESH, Loading.of(test), test, F, P, "measured")
    np.testing.assert_allclose(judged.variables["principal_strain_measured"], 0.5 * (1.3**2 - 1.0), rtol=1e-12)


def test_a_cell_that_noise_folds_over_has_no_stress_and_its_step_no_score():
    _, test = layered()
    F = np.tile(np.diag([1.1, 1.0]), (1, len(MESH.cells), 1, 1))
    F[0, 5] = np.diag([-0.2, 1.0])
    found = stress_at(material_of(closed_form(MESH, "neo_hookean", mu=1.0)), MESH.centres, F)
    assert np.flatnonzero(np.isnan(found[0]).any(axis=(1, 2))).tolist() == [5]
    judged = score_equilibrium(MESH, Loading.of(test), test, F, found, "measured")
    assert np.isnan(judged.summary["equilibrium_gap_measured"])
    assert np.isnan(judged.summary["equilibrium_residual_measured"])
