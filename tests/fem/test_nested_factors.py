"""Factors by nested dissection solve what dense algebra solves, of whole and of pierced sheets."""

import numpy as np
import pytest
import scipy.sparse

from hypernode.fem import factors, nested_factors
from hypernode.fem.factors import MANY, factorise
from hypernode.fem.mesh import rectilinear
from hypernode.fem.nested_factors import NestedFactors, Order
from hypernode.fem.nodal_forces import stiffness_matrix


def sheet(keep=None):
    """(held Laplacian of an oblong sheet, places of its nodes), in an order by chance."""
    mesh = rectilinear(np.linspace(0.0, 2.0, 25) ** 1.2, np.linspace(0.0, 1.0, 17), keep)
    energy = stiffness_matrix(mesh) + 0.1 * scipy.sparse.identity(len(mesh.nodes))
    order = np.random.default_rng(0).permutation(len(mesh.nodes))
    return energy.tocsc()[order][:, order], mesh.nodes[order]


@pytest.mark.parametrize("pierced", [False, True])
def test_solves_as_dense_algebra_does(pierced, monkeypatch):
    monkeypatch.setattr(nested_factors, "SMALLEST", 12)
    keep = np.ones((16, 24), bool)
    keep[:3, :2] = keep[6:12, 8:14] = not pierced
    energy, places = sheet(keep)
    right = np.random.default_rng(1).normal(size=(len(places), 3))
    # A load of few nodes leaves most parts of the sheet without one.
    right[:, 2] = np.arange(len(places)) == 5
    for scaled in (1.0, 2.0):
        factored = NestedFactors(scaled * energy, places)
        np.testing.assert_allclose(factored.solve(right), np.linalg.solve(scaled * energy.toarray(), right), atol=1e-10)


def test_halves_meet_only_in_what_is_eliminated_later(monkeypatch):
    monkeypatch.setattr(nested_factors, "SMALLEST", 12)
    energy, places = sheet()
    order = Order.of(energy.tocsr(), places)
    assert np.array_equal(np.sort(order.unknowns), np.arange(len(places)))
    numbers = sum((f.last - f.first) ** 2 + (f.last - f.first) * len(f.above) for f in order.fronts)
    assert numbers < 0.1 * len(places) ** 2
    assert not len(order.fronts[-1].above)


def test_many_columns_of_a_large_sheet_whose_places_are_known_are_solved_so(monkeypatch):
    energy, places = sheet()
    right = np.random.default_rng(2).normal(size=(len(places), MANY))
    monkeypatch.setattr(factors, "NESTED", len(places))
    monkeypatch.setattr(factors.BlockFactors, "of_band", None)
    found = factorise(energy, places).solve(right)
    np.testing.assert_allclose(found, np.linalg.solve(energy.toarray(), right), atol=1e-10)


def test_a_matrix_that_is_not_positive_definite_is_an_error():
    energy, places = sheet()
    with pytest.raises(np.linalg.LinAlgError):
        NestedFactors(energy - 100.0 * scipy.sparse.identity(len(places)), places)
