"""A material field with lines has the material of either side within the cells that they cut."""

import dataclasses
import json

import numpy as np
import pytest
import xarray as xr

from hypernode.evaluation.truth import cut_by_lines, means_where_cut
from hypernode.fem.mesh import rectilinear
from hypernode.material.files import material_of
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.export.materials import exported

BASIS = ConvexBasis((), 0.4)
#: A line at x = 1.7 of three cells of side one, the stiffer material behind it.
PLACE = 1.7


@pytest.fixture
def sheet():
    mesh = rectilinear(np.arange(4.0), np.array([0.0, 1.0]))
    labels = np.array([0, 0, 1])
    return mesh, xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "material_label": ("cell", labels),
            "interface_distance": (("interface", "node"), (mesh.nodes[:, 0] - PLACE)[None]),
            "basis.log_level": (("subcell", "cell"), np.log(2.0) * labels[None]),
        },
        attrs={
            "basis": json.dumps(dataclasses.asdict(BASIS)),
            "units": json.dumps(SYNTHETIC_UNITS),
            "material_kind": "convex_basis",
        },
    )


def test_a_point_beyond_the_line_of_its_cell_is_of_the_other_material(sheet):
    _, file = sheet
    X = np.array([[0.5, 0.5], [1.6, 0.2], [1.75, 0.9], [2.5, 0.5]])
    F = np.tile(np.diag([1.1, 1.2]), (4, 1, 1))
    P = np.asarray(material_of(file).stress(X, F))
    np.testing.assert_allclose(P[2:], 2.0 * P[:2], rtol=1e-6)


def test_the_mean_over_a_cut_cell_has_each_material_by_its_share(sheet):
    mesh, file = sheet
    cut = cut_by_lines(file)
    assert np.array_equal(cut, [False, True, False])
    F = np.diag([1.1, 1.2])[None, None]
    soft = np.asarray(material_of(file).stress(mesh.centres[:1], F[0]))[0]
    P = means_where_cut(material_of(file), mesh, cut, np.tile(soft, (1, 1, 3, 1, 1)), F)
    np.testing.assert_allclose(P[0, 0, 1], 1.3 * soft, rtol=1e-6)
    np.testing.assert_allclose(P[0, 0, 0], soft, rtol=1e-6)
    assert np.array_equal(means_where_cut(material_of(file), mesh, np.zeros(3, bool), P, F), P)


def test_the_exported_file_answers_the_same_on_both_sides_of_a_line(sheet, tmp_path):
    _, file = sheet
    package = exported(file.assign_attrs(title="field"), tmp_path)
    X = np.random.default_rng(4).uniform([0.0, 0.0], [3.0, 1.0], (50, 2))
    F = np.tile(np.diag([1.1, 1.2]), (50, 1, 1))
    np.testing.assert_allclose(package.stress(X, F), np.asarray(material_of(file).stress(X, F)), rtol=1e-5)
