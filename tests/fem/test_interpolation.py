"""A displacement between nodes, and the way back from the deformed sheet."""

import numpy as np
import pytest

from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import rectilinear

MESH = rectilinear(np.array([0.0, 0.3, 0.5, 1.1]), np.array([0.0, 0.2, 0.9]))


def bilinear(X):
    x, y = X.T
    return np.stack([0.1 + 0.2 * x - 0.1 * y + 0.3 * x * y, -0.2 + 0.1 * x + 0.25 * y - 0.2 * x * y], axis=1)


def test_shape_functions_reproduce_a_bilinear_field_within_and_go_on_straight_beyond():
    field = NodalField.of(MESH, bilinear(MESH.nodes))
    X = np.random.default_rng(0).uniform(MESH.lower, MESH.upper, (200, 2))
    np.testing.assert_allclose(field.at(X), bilinear(X), atol=1e-14)
    affine = NodalField.of(MESH, MESH.nodes @ np.array([[0.1, 0.3], [-0.2, 0.2]]))
    beyond = np.array([[-1.0, 0.4], [3.0, 2.0], [0.2, -5.0]])
    np.testing.assert_allclose(affine.at(beyond), beyond @ np.array([[0.1, 0.3], [-0.2, 0.2]]), atol=1e-13)


def test_every_place_of_a_kinked_sheet_is_traced_back():
    random = np.random.default_rng(1)
    mesh = rectilinear(np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 21))
    u = 0.2 * mesh.nodes + random.uniform(-0.008, 0.008, mesh.nodes.shape)
    field = NodalField.of(mesh, u)
    x = random.uniform(-0.2, 1.4, (5000, 2))
    X = field.sources(x, 1e-12)
    assert np.abs(X + field.at(X) - x).max() <= 1e-12


def test_a_folded_sheet_and_a_mesh_with_a_hole_are_refused():
    u = np.zeros((len(MESH.nodes), 2))
    u[np.isclose(MESH.nodes[:, 0], 1.1), 0] = -0.7
    x = np.stack(np.meshgrid(np.linspace(0.41, 0.49, 9), np.linspace(0.1, 0.8, 8)), axis=-1).reshape(-1, 2)
    with pytest.raises(ValueError, match="folded over"):
        NodalField.of(MESH, u).sources(x, 1e-10)
    hole = rectilinear(*(np.linspace(0.0, 1.0, 4),) * 2, keep=np.arange(9) != 4)
    with pytest.raises(ValueError, match="without holes"):
        NodalField.of(hole, np.zeros((len(hole.nodes), 2)))
