"""The grid for ParaView holds what the run says: read back, number by number."""

import meshio
import numpy as np
import pytest

from hypernode.commands.export import open_run
from hypernode.export.fields import cell_fields
from hypernode.export.run import Run
from hypernode.export.vtu import vtu_files
from tests.evaluation.files import closed_form
from tests.export.runs import MESH, MU, PHASE, SPREAD, THICKNESS, U, write_run


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return open_run(write_run(tmp_path_factory.mktemp("results")))


@pytest.fixture(scope="module")
def grid(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("vtu") / "sheet.vtu"
    path.write_bytes(vtu_files(run)["sheet.vtu"])
    return meshio.read(path)


def of_cells(grid, name):
    (values,) = grid.cell_data[name]
    return values


def test_nodes_cells_and_displacements_are_read_back(grid):
    np.testing.assert_array_equal(grid.points[:, :2], MESH.nodes)
    np.testing.assert_array_equal(grid.cells_dict["quad"], MESH.cells)
    for step, u in enumerate(U):
        np.testing.assert_array_equal(grid.point_data[f"displacement_{step + 1}"], np.pad(u, ((0, 0), (0, 1))))


def test_stiffness_is_that_of_the_laws(grid):
    """Of an incompressible neo-Hookean sheet: tr P = 2 mu (s - s^-5), and 3 mu along a small pull."""
    mu = MU[PHASE]
    np.testing.assert_allclose(of_cells(grid, "trace_P"), 2.0 * mu * (1.1 - 1.1**-5), rtol=1e-12)
    np.testing.assert_allclose(of_cells(grid, "modulus_shear"), mu, rtol=1e-12)
    for name in ("young_x", "young_y"):
        np.testing.assert_allclose(of_cells(grid, name), 3.0 * mu, rtol=0.02)
    np.testing.assert_allclose(of_cells(grid, "basis_c"), 0.5 * mu, rtol=1e-12)


def test_spreads_are_those_of_the_posterior_samples(grid):
    for name in ("trace_P", "modulus_xx", "young_x", "basis_c"):
        np.testing.assert_allclose(of_cells(grid, f"{name}_spread"), SPREAD * of_cells(grid, name), rtol=1e-9)


def test_findings_and_verdict_are_arrays_and_words(grid, run):
    for name, wanted in (("phase", PHASE), ("inclusion", PHASE), ("thickness", THICKNESS), ("verdict", 2)):
        np.testing.assert_array_equal(of_cells(grid, name), wanted)
    page = vtu_files(run)["sheet.md"].decode()
    assert "Verdict on the run: warn: forces." in page and "- Edge forces are missed by 4 %." in page
    assert all(f"| `{name}` |" in page for name in (*grid.cell_data, *grid.point_data))
    assert "| `modulus_xx` | MPa |" in page and "| `displacement_3` | mm | identified displacement, pull" in page


def test_the_vector_of_fibres_points_along_them(run):
    angle = np.deg2rad(30.0)
    law = {"C10": 0.5, "k1": 0.8, "k2": 1.0, "kappa": 0.1, "fibre_angle": angle}
    fibres = cell_fields(Run("fibres", {**run.files, "material": closed_form(MESH, "goh", **law)}))
    vector = fibres["fibre"].values
    np.testing.assert_allclose(np.linalg.norm(vector, axis=1), fibres["anisotropy"].values, rtol=1e-12)
    direction = vector[:, :2] / np.linalg.norm(vector, axis=1, keepdims=True)
    np.testing.assert_allclose(direction, np.tile([np.cos(angle), np.sin(angle)], (len(vector), 1)), rtol=1e-9)
    assert fibres["material.k1"].values[0] == 0.8 and fibres["anisotropy"].values.min() > 0.05
