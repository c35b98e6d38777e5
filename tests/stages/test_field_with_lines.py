"""The method that keeps the constrained field as it is keeps what its lines make of cells."""

import numpy as np

from hypernode.config.methods import Method
from hypernode.material.basis_file import basis_content
from hypernode.material.files import load_material
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.stages import baseline
from hypernode.storage.netcdf import SYNTHETIC_UNITS, write
from tests.stages.test_domain_of_materials import MESH, files


def test_the_material_of_the_field_answers_on_both_sides_of_a_line_as_the_field_does(tmp_path):
    paths = files(tmp_path) | {"constrained": tmp_path / "constrained.nc"}
    middle = MESH.lower[0] + 0.55 * MESH.size[0]
    labels = (MESH.centres[:, 0] > middle).astype(np.int16)
    content, kind = basis_content(ConvexBasis((), 0.4), np.log(2.0) * labels[None, None])
    lines = {"material_label": labels, "interface_distance": 3.0 * (MESH.nodes[None, :, 0] - middle) / MESH.size[0]}
    grid = {"X": MESH.nodes, "cells": MESH.cells, "corners": np.stack([MESH.lower, MESH.upper])}
    write(paths["constrained"], grid | content | lines, "field", kind | {"units": SYNTHETIC_UNITS})
    baseline.run(Method(baseline="constrained", constrained={}), "sheet", paths, tmp_path / "material.nc", {})
    X = MESH.lower + np.random.default_rng(1).uniform(size=(40, 2)) * MESH.size
    F = np.tile(np.diag([1.1, 1.05]), (40, 1, 1))
    P, of_field = (
        np.asarray(load_material(tmp_path / f"{name}.nc").stress(X, F)) for name in ("material", "constrained")
    )
    np.testing.assert_array_equal(P, of_field)
    stiff = X[:, 0] > middle
    assert stiff.any() and not stiff.all()
    np.testing.assert_allclose(P[stiff, 0, 0], 2.0 * P[~stiff, 0, 0].mean(), rtol=1e-5)
