"""Young's modulus and Poisson's ratio of a run are those of its plane."""

import json

import jax
import numpy as np
import pytest
import xarray as xr

from hypernode.export.fields import stiffness
from hypernode.material.basis_file import basis_content
from hypernode.material.files import material_of
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.evaluation.files import grid, square_mesh

MESH, MU = square_mesh(3), 0.7


def constants(area, plane):
    """E and nu of a sheet whose in-plane bulk modulus is ``area`` times its modulus of shear."""
    # c3 + 3 c4 of the basis is that ratio.
    basis = ConvexBasis(("J",), 1.0)
    params = np.array([np.log(MU / 2.0), np.log1p(0.25 * area), np.log1p(0.25 * area)])
    content, kind = basis_content(basis, np.tile(params[:, None, None], (1, 1, len(MESH.cells))))
    with jax.enable_x64(True):
        units = {"units": json.dumps(SYNTHETIC_UNITS)}
        material = material_of(xr.Dataset(grid(MESH) | content, attrs=kind | units))
        found = stiffness(material, MESH.centres, 1.1, plane)
    assert found["young_x"] == pytest.approx(found["young_y"])
    return found["young_x"][0], found["poisson_x"][0]


@pytest.mark.parametrize("nu", [0.1, 0.3, 0.45])
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_constants_are_those_from_which_the_law_is_made(nu, plane):
    area = (1.0 + nu) / (1.0 - nu) if plane == "stress" else 1.0 / (1.0 - 2.0 * nu)
    young, poisson = constants(area, plane)
    assert poisson == pytest.approx(nu, abs=0.005)
    assert young == pytest.approx(2.0 * MU * (1.0 + nu), rel=0.01)
