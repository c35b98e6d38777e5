"""Small files of every kind of material, and what their stress must be."""

import json

import numpy as np

from hypernode.config.methods import Frequencies
from hypernode.fem.mesh import rectilinear
from hypernode.material.basis_file import basis_content
from hypernode.material.files import load_material
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.networks.weights import make_network, to_arrays
from hypernode.storage.netcdf import SYNTHETIC_UNITS, write

MESH = rectilinear(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 3))
X = MESH.centres
F = np.tile([[1.1, 0.05], [0.0, 0.97]], (len(X), 1, 1))


def _write(path, variables, attributes):
    corners = np.stack([MESH.lower, MESH.upper])
    mesh = {"X": MESH.nodes, "cells": MESH.cells, "corners": corners}
    write(path, mesh | variables, "a material", {"units": SYNTHETIC_UNITS, **attributes})


def write_materials(folder):
    """{file: stress (cell, 2, 2)} of a closed form, a convex basis and a hyper-network."""
    mu = np.array([1.0, 2.0, 3.0, 4.0])
    closed = {"material.model": (("cell",), np.zeros(4)), "material.mu": (("cell",), mu)}
    _write(folder / "closed_form.nc", closed, {"material_kind": "closed_form", "models": ["neo_hookean"]})
    basis = ConvexBasis(("I1_squared", "fibre"), 0.4)
    _write(folder / "convex_basis.nc", *basis_content(basis, np.tile(basis.start[:, None, None], (1, 1, 4))))
    node = {"terms": ["I1", "I2"], "hidden": [3], "steps": 1, "invariant_scale": 0.4, "stress_scale": 1.0}
    network = Frequencies(features=4, frequency_scale=1.0, widths=[5])
    size = NodeMaterial(**{k: tuple(v) if isinstance(v, list) else v for k, v in node.items()}).size
    attributes = {"material_kind": "node", "node": json.dumps(node), "length_scale": 1.0}
    attributes["hypernetwork"] = network.model_dump_json()
    _write(folder / "node.nc", to_arrays(make_network(network, 0, size, 1), "hypernetwork"), attributes)
    files = [folder / f"{kind}.nc" for kind in ("closed_form", "convex_basis", "node")]
    return {file: np.asarray(load_material(file).stress(X, F)) for file in files}
