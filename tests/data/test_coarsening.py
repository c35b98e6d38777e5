"""A test on every second line of its grid is the same test."""

import numpy as np

from hypernode.data.coarsening import coarsened
from hypernode.data.measurement import mesh_of
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square


def test_points_move_as_they_did_and_the_outline_stays():
    data, mesh, _ = sheet(7, square, make_load("uniaxial_x", [1.05, 1.1]))
    coarse = coarsened(data)
    kept = mesh_of(coarse)
    assert len(kept.cells) == 16 and kept.areas.sum() == mesh.areas.sum()
    np.testing.assert_allclose(kept.size, mesh.size)
    for node, u in zip(kept.nodes, np.moveaxis(coarse["u_measured"].values[0], 1, 0), strict=True):
        same = np.flatnonzero((mesh.nodes == node).all(axis=1))
        np.testing.assert_array_equal(u, data["u_measured"].values[0][:, same[0]])


def test_a_coarse_cell_is_as_thick_as_its_parts_and_may_be_cut_by_interfaces():
    data, mesh, _ = sheet(6, square, make_load("uniaxial_x", [1.1]))
    thick = data.assign(relative_thickness=("cell", 1.0 + mesh.centres[:, 0]))
    coarse = coarsened(thick)
    np.testing.assert_allclose(coarse["relative_thickness"], 1.0 + mesh_of(coarse).centres[:, 0])
    assert coarse.attrs["mesh"] == "finer"


def test_a_coarse_cell_of_which_a_part_is_missing_is_none():
    data, mesh, _ = sheet(6, square, make_load("uniaxial_x", [1.1]))
    gone = np.flatnonzero((np.abs(mesh.centres - [7 / 12, 7 / 12]) < 1e-9).all(axis=1))
    holed = data.drop_vars([name for name in data if "cell" in data[name].dims])
    holed = holed.assign(
        cells=(("cell", "vertex"), np.delete(mesh.cells, gone, axis=0)), relative_thickness=("cell", np.ones(35))
    )
    assert len(mesh_of(coarsened(holed)).cells) == 8
