"""Unseen loads with the true and with another material."""

import numpy as np
import pytest

from hypernode.evaluation.references import force_nrmse
from hypernode.evaluation.validation import Response, compare, respond, worst_error
from hypernode.mechanics.loads import Load, make_load
from hypernode.progress import Progress
from hypernode.synthetic.forward import true_sheet
from tests.evaluation.files import closed_form, square_mesh

MESH = square_mesh(4)
MU = np.where(np.abs(MESH.centres - 0.5).max(axis=1) < 0.2, 3.0, 1.0)
LOADS = [make_load("uniaxial_x", [1.1, 1.2]), make_load("shear", [1.1])]
LOAD_CASE = np.array([0, 0, 1])


def response(mu, loads=LOADS):
    solver = true_sheet(closed_form(MESH, "neo_hookean", mu=mu))[0]
    return respond(solver, loads, Progress("validation", "sheet", 10))


@pytest.fixture(scope="module")
def true():
    return response(MU)


def test_the_true_material_against_itself_has_no_error(true):
    assert compare(response(MU), true, LOAD_CASE) == {
        "unseen_displacement_error": 0.0, "unseen_force_error": 0.0, "unseen_without_equilibrium": 0,
    }  # fmt: skip


def test_a_sheet_a_tenth_stiffer_moves_alike_and_pulls_a_tenth_harder(true):
    summary = compare(response(1.1 * MU), true, LOAD_CASE)
    assert summary["unseen_force_error"] == pytest.approx(0.1, rel=1e-8)
    assert summary["unseen_displacement_error"] < 1e-8


def test_a_load_without_equilibrium_is_counted_and_leaves_no_error(true, capsys):
    to_nothing = Load("equibiaxial", np.array([np.diag([-1.0, 0.0])]))
    found = response(MU, [LOADS[0], to_nothing])
    assert np.isnan(found.u[2]).all() and np.isfinite(found.u[:2]).all()
    summary = compare(found, true, LOAD_CASE)
    assert summary["unseen_without_equilibrium"] == 1 and np.isnan(summary["unseen_displacement_error"])
    assert "no equilibrium: load step 0" in capsys.readouterr().err


def test_the_worst_load_counts_whatever_the_size_of_the_others():
    true = np.array([[100.0], [100.0], [1.0]])
    error = np.array([[1.0], [1.0], [0.2]])
    assert worst_error(true + error, true, LOAD_CASE) == pytest.approx(0.2)
    same = Response(np.ones((3, 2, 2)), np.ones((3, 4, 2)))
    assert compare(same, same, LOAD_CASE)["unseen_force_error"] == 0.0


def test_the_error_of_a_reference_sheet_is_relative_to_its_largest_force():
    measured = np.full((2, 4, 2), np.nan)
    measured[:, 1, 0] = 1.0, 4.0
    assert force_nrmse(np.nan_to_num(measured) + 0.2, measured) == pytest.approx(0.05)
