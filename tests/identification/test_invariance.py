"""A material does not depend on how its test is laid on the table, nor on the units in which it was measured."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet

CELLS = 10
SETTINGS = Constrained(terms=["I1_squared", "I2", "fibre"], iterations=40)
#: Where descents end, with as many digits as their tolerance gives them.
SAME = 5e-3
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
#: Edge (left, right, bottom, top) -> the one that it becomes in a quarter turn.
BECOMES = {0: 2, 1: 3, 2: 1, 3: 0}
F = np.stack([np.diag([1.1, 1.05]), [[1.0, 0.1], [0.0, 1.0]]])


def inclusion(X):
    return (np.abs(X - [0.4, 0.55]) < [0.2, 0.25]).all(axis=1)


@pytest.fixture(scope="module")
def measured():
    load = make_load("biaxial", [[1.05, 1.03], [1.1, 1.06], [1.15, 1.1]])
    return sheet(CELLS, inclusion, load, noise=1e-3)[0]


@pytest.fixture(scope="module")
def found(measured):
    return stress(identify(measured, SETTINGS, "as it is"), F)


def stress(estimate, F):
    """P (deformation, cell, 2, 2) at deformations (deformation, 2, 2)."""
    P = estimate.problem.basis.stress(np.moveaxis(F, 0, -1)[..., None], estimate.params.T[:, None])
    return np.moveaxis(np.asarray(P), (0, 1), (2, 3))


def turned(grid):
    """Values (..., row, column, component) a quarter turn on; the first column becomes the last row's mirror image."""
    return np.swapaxes(grid, -3, -2)[..., :, ::-1, :]


def quarter_turn(data):
    points = CELLS + 1
    u = data["u_measured"].values
    grid = turned(u.reshape(*u.shape[:-2], points, points, 2) @ QUARTER.T).reshape(u.shape)
    force, held = data["edge_force"].values.copy(), data["edge_constrained"].values.copy()
    for old, new in BECOMES.items():
        force[:, new] = data["edge_force"].values[:, old, ::-1] * [-1.0, 1.0]
        held[:, new] = data["edge_constrained"].values[:, old, ::-1]
    return data.assign(
        u_measured=(data["u_measured"].dims, grid),
        H=(data["H"].dims, QUARTER @ data["H"].values @ QUARTER.T),
        edge_force=(data["edge_force"].dims, force),
        edge_constrained=(data["edge_constrained"].dims, held),
    )


@pytest.mark.slow
def test_a_quarter_turn_of_the_test_is_a_quarter_turn_of_the_material(measured, found):
    P = stress(identify(quarter_turn(measured), SETTINGS, "turned"), QUARTER @ F @ QUARTER.T)
    expected = turned((QUARTER @ found @ QUARTER.T).reshape(len(F), CELLS, CELLS, 4)).reshape(P.shape)
    assert np.linalg.norm(P - expected) < SAME * np.linalg.norm(expected)


@pytest.mark.slow
def test_inches_and_pounds_are_the_same_material_as_millimetres_and_newtons(measured, found):
    length, force = 25.4, 4.448
    lengths = ("X", "corners", "u_measured", "noise_level", "noise_scatter")
    other = measured.assign({name: measured[name] * length for name in lengths})
    other = other.assign(edge_force=measured["edge_force"] * force)
    P = stress(identify(other.assign_attrs(thickness=length), SETTINGS, "inches"), F)
    expected = found * force / length**2
    assert np.linalg.norm(P - expected) < SAME * np.linalg.norm(expected)


@pytest.mark.slow
def test_noise_that_is_believed_half_again_as_large_or_as_small_changes_little(measured, found):
    for factor in (1.5, 1 / 1.5):
        other = measured.assign({name: measured[name] * factor for name in ("noise_level", "noise_scatter")})
        P = stress(identify(other, SETTINGS, "believed"), F)
        assert np.linalg.norm(P - found) < 0.05 * np.linalg.norm(found)
