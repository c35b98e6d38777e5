"""Points that a camera lost: what is between their neighbours, and nothing less of the sheet."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.data.boundary import prescribed_displacement
from hypernode.data.lost import along, filled
from hypernode.fem.mesh import rectilinear
from hypernode.identification.observations import observe
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square


def grid(cells):
    return rectilinear(np.linspace(0.0, 1.0, cells + 1), np.linspace(0.0, 1.0, cells + 1))


def test_a_linear_field_is_filled_in_exactly_and_nothing_measured_changes():
    mesh = grid(6)
    u = mesh.nodes @ [[0.1, 0.02], [-0.03, 0.2]] + 0.5
    gappy = u.copy()
    gappy[[8, 16, 17, 24, 40]] = np.nan
    found = filled(mesh, gappy[None])[0]
    np.testing.assert_allclose(found, u, atol=1e-12)
    known = np.isfinite(gappy)
    np.testing.assert_array_equal(found[known], gappy[known])
    assert filled(mesh, u[None]) is not None and np.array_equal(filled(mesh, u[None])[0], u)


def test_a_lost_outline_makes_no_sheet_less_stretched():
    """The deformation goes on there, although nothing beyond the lost points says so."""
    mesh = grid(6)
    u = mesh.nodes @ [[0.1, 0.02], [-0.03, 0.2]] + 0.5
    gappy = np.repeat(u[None], 2, axis=0)
    gappy[0, (mesh.nodes[:, 1] < 0.3) & (np.abs(mesh.nodes[:, 0] - 0.5) < 0.3)] = np.nan
    gappy[1, mesh.nodes[:, 0] > 0.6] = np.nan
    np.testing.assert_allclose(filled(mesh, gappy), [u, u], atol=1e-12)


def test_the_line_through_known_points_goes_on_straight():
    x = np.array([0.0, 1.0, 2.0, 4.0, 5.0])
    known = np.array([1.0, 2.0, 4.0])
    np.testing.assert_allclose(along(x, known) @ (3.0 * known - 1.0), 3.0 * x - 1.0)
    np.testing.assert_allclose(along(x, known) @ np.array([0.0, 1.0, 0.0]), [-1.0, 0.0, 1.0, 0.0, -0.5])


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_an_edge_with_lost_points_is_prescribed_all_along(noise):
    mesh = grid(8)
    u = mesh.nodes * (0.1, -0.05)
    gappy = u.copy()
    right = np.flatnonzero(mesh.on_edge("right"))
    gappy[right[[0, 4]]] = np.nan
    prescribed = np.zeros((4, 2))
    prescribed[1, 0] = 1.0
    found = prescribed_displacement(mesh, gappy, prescribed, [noise, noise])
    assert found.mask[right, 0].all() and found.mask.sum() == len(right)
    np.testing.assert_allclose(found.values[right, 0], u[right, 0], atol=1e-9)
    gappy[right[:6]] = np.nan
    with pytest.raises(ValueError, match="of the right edge of the grid only 3 of 9 points"):
        prescribed_displacement(mesh, gappy, prescribed, [noise, noise])


def lose(data, nodes):
    u = data["u_measured"].values.copy()
    u[:, :, nodes] = np.nan
    return data.assign(u_measured=(data["u_measured"].dims, u))


def test_what_is_filled_in_is_not_observed():
    data, _, _ = sheet(6, square, make_load("equibiaxial", [1.1]), noise=1e-3)
    whole, gappy = (observe(each, 1) for each in (data, lose(data, [16, 24])))
    assert len(whole.boundaries[0].observed) - len(gappy.boundaries[0].observed) == 4
    np.testing.assert_allclose(gappy.mean_F, whole.mean_F, atol=1e-12)


@pytest.mark.slow
def test_material_goes_on_beneath_lost_points():
    """A patch of the sheet is lost, half of it stiff: nothing is a hole, and what is stiff is found to be."""
    data, mesh, true = sheet(12, square, make_load("equibiaxial", [1.1, 1.2]), noise=5e-4)
    settings = Constrained(terms=["I1_squared"], iterations=15)
    patch = np.flatnonzero((np.abs(mesh.nodes - (0.3, 0.5)) < 0.13).all(axis=1))
    assert len(patch) == 9
    full, gappy = (identify(each, settings, "sheet") for each in (data, lose(data, patch)))
    assert gappy.params.shape == full.params.shape

    def error(found):
        return np.sqrt(np.mean((found.params[:, 0] - true[:, 0]) ** 2))

    assert error(gappy) < 1.2 * error(full) + 0.01
    stiff = gappy.params[:, 0] > 0.5 * np.log(2.0) + true[:, 0].min()
    assert (stiff == square(mesh.centres)).mean() > 0.97
