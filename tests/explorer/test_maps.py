"""Every map is what its words say."""

import numpy as np
import pytest

from hypernode.explorer.maps import PHASES, from_softest, maps_of
from hypernode.material.files import material_of
from tests.evaluation.files import square_mesh
from tests.explorer.files import NOISE, displacement, right_half, run_files

CELLS = 4


@pytest.fixture(scope="module")
def files():
    return run_files(CELLS)


@pytest.fixture(scope="module")
def maps(files):
    true = material_of(files["truth"])
    return {each.key: each for each in maps_of(files, true, true)}


def test_a_perfect_material_has_no_error_and_the_anisotropy_and_angle_of_the_truth(maps):
    assert np.array_equal(maps["error"].values, np.zeros((1, CELLS**2)))
    for key in ("stiffness", "anisotropy", "angle"):
        assert np.array_equal(maps[key].values, maps[key].truth)
    assert maps["angle"].values == pytest.approx(np.full((1, CELLS**2), np.rad2deg(0.5)), rel=1e-6)


def test_the_stiffness_is_the_trace_of_the_equibiaxial_stress(files, maps):
    mesh = square_mesh(CELLS)
    P = material_of(files["truth"]).stress(mesh.centres, np.tile(1.1 * np.eye(2), (CELLS**2, 1, 1)))
    assert maps["stiffness"].values[0] == pytest.approx(np.trace(P, axis1=1, axis2=2), rel=1e-6)


def misfit_of(files):
    return next(each for each in maps_of(files, material_of(files["truth"]), None) if each.key == "misfit").values


def test_misfits_are_those_that_the_field_weighs_and_lost_points_count_nothing(files):
    residual = np.full(files["constrained"]["u"].shape, 3.0)
    residual[0, 0, 0] = np.nan
    residual[1] = np.nan
    weighed = files["constrained"].assign(residual=(files["constrained"]["u"].dims, residual))
    misfit = misfit_of(files | {"constrained": weighed})
    assert misfit[[0, 2]] == pytest.approx(np.full((2, CELLS**2), 3.0))
    assert np.isnan(misfit[1]).all()


def test_misfits_of_a_field_that_weighs_none_are_lengths(files):
    u = displacement(square_mesh(CELLS))
    lost = u[None].copy()
    lost[0, 1] = np.nan
    fields = files | {
        "measurement": files["measurement"].assign(u_measured=(files["measurement"]["u_measured"].dims, lost)),
        "constrained": files["constrained"].assign(u=(files["constrained"]["u"].dims, u + 3.0 * NOISE)),
    }
    misfit = misfit_of(fields)
    assert misfit[0] == pytest.approx(np.full(CELLS**2, 3.0 * NOISE * np.sqrt(2.0)))
    assert np.isnan(misfit[1]).all()


def test_the_spread_is_a_share_of_the_stiffness(maps):
    assert maps["spread"].values[0] == pytest.approx(np.full(CELLS**2, 5.0))


def test_phases_are_numbered_from_the_softest(maps):
    assert maps["phases"].colours == PHASES
    assert np.array_equal(maps["phases"].values[0], 1.0 + right_half(square_mesh(CELLS)))
    assert np.array_equal(from_softest(np.array([7, 7, 2, 4]), np.array([3.0, 5.0, 6.0, 1.0])), [1, 1, 2, 0])
