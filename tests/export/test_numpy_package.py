"""The exported package is the material itself: stress, tangent and energy, of every kind, with NumPy alone."""

import subprocess
import sys
from functools import partial

import jax
import numpy as np
import pytest
from scipy.spatial import cKDTree

from hypernode.export.numpy_material.cells import nearest_cell
from hypernode.export.numpy_package import _cells
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.material.files import material_of
from hypernode.material.laws import node_energy, node_stress
from hypernode.mechanics.parameters import BASIS_TERMS
from tests.export.materials import (
    MESH,
    basis_file,
    closed_form_file,
    double_parameters,
    exported,
    node_file,
    points,
)

COMPRESSIBLE, INCOMPRESSIBLE = (
    tuple(term for term in BASIS_TERMS if term not in others) for others in (("I2", "ogden"), ("J",))
)
BY_CELL = {
    "closed forms": closed_form_file,
    "basis": lambda: basis_file(INCOMPRESSIBLE, subcells=1),
    "compressible basis": lambda: basis_file(COMPRESSIBLE, subcells=1),
    "subcells": lambda: basis_file(("I2",), subcells=4),
}
NODES = {
    "two families": lambda: node_file(("I1", "I1_I4v", "I4v_I4w")),
    "powers of the stretches": lambda: node_file(("I1", "I2", "ogden_6", "ogden_4", "ogden_minus_4", "I1_I4v")),
    "isotropic, compressible, shares fixed": lambda: node_file(("I1", "J"), scaled=False),
    "input-convex network, compressible": lambda: node_file(("I1", "J", "I4v"), "icnn"),
    "constitutive network": lambda: node_file(("I1", "I2", "I1_I4v"), "cann"),
}


def largest_error(found, wanted):
    """Largest over the points of the relative error of a tensor."""
    found, wanted = (np.asarray(each, float).reshape(len(found), -1) for each in (found, wanted))
    return (np.linalg.norm(found - wanted, axis=1) / np.linalg.norm(wanted, axis=1)).max()


@pytest.mark.parametrize("kind", BY_CELL)
def test_materials_of_cells_are_the_same_to_rounding(kind, tmp_path):
    file = BY_CELL[kind]()
    package, material, (X, F) = exported(file, tmp_path), material_of(file), points(1000)
    assert largest_error(package.stress(X, F), material.stress(X, F)) < 1e-11
    assert largest_error(package.tangent(X, F), material.tangent(X, F)) < 1e-11
    assert largest_error(package.energy(X, F), material.energy(X, F)) < 1e-10


@pytest.mark.parametrize("kind", NODES)
def test_networks_are_the_same_to_rounding_where_both_compute_in_double_precision(kind, tmp_path):
    file = NODES[kind]()
    package, (X, F) = exported(file, tmp_path), points(1000)
    material, params_at = double_parameters(file)
    params, states = params_at(X), np.moveaxis(F, 0, -1)
    stress = jax.jit(partial(node_stress, material))(states, params)
    assert largest_error(package.stress(X, F), np.moveaxis(np.asarray(stress), -1, 0)) < 1e-11


def test_the_energy_of_a_network_is_the_same_to_rounding(tmp_path):
    file = NODES["isotropic, compressible, shares fixed"]()
    package, (X, F) = exported(file, tmp_path), points(1000)
    material, params_at = double_parameters(file)
    energy = jax.jit(partial(node_energy, material))(np.moveaxis(F, 0, -1), params_at(X))
    assert largest_error(package.energy(X, F), energy) < 1e-10


def test_a_loaded_network_differs_by_the_single_precision_of_its_parameters(tmp_path):
    file = NODES["two families"]()
    package, material, (X, F) = exported(file, tmp_path), material_of(file), points(1000)
    assert largest_error(package.stress(X, F), material.stress(X, F)) < 1e-6
    assert largest_error(package.tangent(X, F), material.tangent(X, F)) < 1e-5


@pytest.mark.parametrize("kind", [*BY_CELL, *NODES])
def test_the_undeformed_sheet_is_free_of_stress_and_energy(kind, tmp_path):
    package, F = exported((BY_CELL | NODES)[kind](), tmp_path), np.tile(np.eye(2), (len(MESH.centres), 1, 1))
    assert np.abs(package.stress(MESH.centres, F)).max() < 1e-12
    assert np.abs(package.energy(MESH.centres, F)).max() < 1e-12


def test_states_of_all_positions_are_evaluated_together(tmp_path):
    package, (X, F) = exported(basis_file(("I1_squared",)), tmp_path), points(6)
    states = np.stack([F, F[::-1]])
    together = package.tangent(X, states)
    assert together.shape == (2, 6, 2, 2, 2, 2)
    np.testing.assert_array_equal(together[1], package.tangent(X, F[::-1]))
    with pytest.raises(ValueError, match=r"X must be \(n, 2\)"):
        package.stress(X[:3], F)


def test_the_cell_is_the_nearest_one_beside_holes_and_outside_too():
    X = np.random.default_rng(1).uniform(MESH.lower - 0.5, MESH.upper + 0.5, (2000, 2))
    found = nearest_cell(_cells(basis_file(())), X)
    np.testing.assert_array_equal(found, cKDTree(MESH.centres).query(X)[1])


@pytest.mark.parametrize("make", [closed_form_file, lambda: basis_file(("fibre",)), lambda: node_file(("I1",))])
def test_the_package_needs_numpy_and_nothing_else(make, tmp_path):
    exported(make(), tmp_path)
    script = (
        "import sys, numpy; before = set(sys.modules); sys.path.insert(0, sys.argv[1]); import material; "
        "material.tangent([[0.5, 1.5]], [[[1.1, 0.0], [0.0, 1.0]]]); "
        "print(*sorted({name.split('.')[0] for name in set(sys.modules) - before} - set(sys.stdlib_module_names)))"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["material"]


def test_the_package_warns_once_beyond_what_the_test_has_seen(tmp_path, recwarn):
    file = basis_file(("I1_squared",))
    seen, measures = domain_content(Domain.of(np.diag([1.2, 1.1])[None], directional=False))
    file["deformation_seen"] = (("deformation_measure", "bound"), seen["deformation_seen"])
    file.attrs["deformation_measures"] = str(measures["deformation_measures"]).replace("'", '"')
    package = exported(file, tmp_path)
    package.stress([[0.5, 1.5]], [np.diag([1.2, 1.1])])
    package.stress([[0.5, 1.5]], [np.eye(2)])
    assert not recwarn.list
    package.stress([[0.5, 1.5]], [np.diag([1.3, 1.0])])
    package.stress([[0.5, 1.5]], [np.diag([1.4, 1.0])])
    (warning,) = recwarn.list
    assert "the largest stretch is 1.3, and in the test it was 1 to 1.2" in str(warning.message)
    assert warning.filename == __file__
