"""The whole evaluation of a run, of an identified material that is the true one."""

import json

import numpy as np
import pytest
import xarray as xr

from hypernode.evaluation.judge import judge
from hypernode.fem.gradient import deformation_gradient
from hypernode.material.basis_file import basis_content
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from hypernode.storage.schema import VARIABLES
from tests.evaluation.files import grid
from tests.sheets import SCALE, sheet, square

TERMS = ("I1_squared",)
STRETCHES = np.array([1.05, 1.1])
BOTH = ("edge_force_at", "edge_force_error", "equilibrium_residual", "equilibrium_gap", "principal_strain")


def run_of(measurement, mesh, params):
    """Files of a run whose constrained field and identified material are the truth, and the truth itself."""
    content, kind = basis_content(ConvexBasis(TERMS, SCALE), params.T[:, None])
    material = xr.Dataset(grid(mesh) | content, attrs={**kind, "units": json.dumps(SYNTHETIC_UNITS)})
    misfits = {"displacement": 1.0, "force": 0.5}
    F = deformation_gradient(mesh, measurement["u_measured"].values[0])
    gradient = xr.Dataset({"F": (("load_step", "cell", "i", "J"), F)})
    return {
        "measurement": measurement.assign(F_truth=gradient["F"]),
        "gradient": gradient,
        "field": gradient,
        "material": material,
        "constrained": material.assign_attrs(ending="converged", misfits=json.dumps(misfits)),
        "truth": material.assign(phase=("cell", square(mesh.centres).astype(int))).assign_attrs(
            phases='["soft", "stiff"]'
        ),
    }


@pytest.fixture(scope="module")
def files():
    return run_of(*sheet(8, square, make_load("biaxial", [[1.05, 1.04], [1.1, 1.06]]), terms=TERMS))


@pytest.fixture(scope="module")
def exact(files):
    return judge(files, "biaxial", STRETCHES)


@pytest.fixture(scope="module")
def noisy(files):
    measurement = files["measurement"]
    noise = np.random.default_rng(5).normal(0.0, 1e-3, measurement["u_measured"].shape)
    measured = measurement.assign(u_measured=measurement["u_measured"] + noise)
    return judge({**files, "measurement": measured}, "biaxial", STRETCHES)


def test_the_true_material_has_no_error_and_its_own_shape(exact):
    summary = exact.summary
    for key in (
        "stress_error",
        "stress_error_all_modes",
        "contrast_error",
        "stress_error_constrained",
    ):
        assert summary[key] == 0.0
    assert summary["dice"] == 1.0 and summary["ending"] == "converged"
    assert "network_error" not in summary, "a field that no network learnt"


def test_everything_that_is_judged_has_a_place_in_the_schema(exact):
    assert exact.variables.keys() <= VARIABLES.keys()


def test_without_noise_the_measured_deformation_is_the_identified_one(exact):
    for name in BOTH:
        at = [exact.variables[f"{name}_{deformation}"] for deformation in ("measured", "identified")]
        np.testing.assert_allclose(*at, rtol=1e-9, atol=1e-12)


def test_noise_counts_at_the_measured_deformation_alone(exact, noisy):
    for name in BOTH:
        identified = [judged.variables[f"{name}_identified"] for judged in (exact, noisy)]
        np.testing.assert_array_equal(*identified)
    for key in ("equilibrium_gap", "equilibrium_residual", "edge_force_error"):
        assert noisy.summary[f"{key}_measured"] > 2.0 * noisy.summary[f"{key}_identified"]
    assert "snr_used" not in noisy.summary and 20.0 < noisy.summary["snr_measured"] < 60.0


def test_the_truth_adds_numbers_and_changes_none(files, exact):
    without = judge({key: file for key, file in files.items() if key != "truth"}, "biaxial", STRETCHES)
    assert without.summary.keys() < exact.summary.keys()
    assert all(exact.summary[key] == value for key, value in without.summary.items())
    for name, value in without.variables.items():
        np.testing.assert_array_equal(exact.variables[name], value, err_msg=name)
