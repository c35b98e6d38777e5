"""Every stage that writes an identified material writes what its test has seen."""

from types import SimpleNamespace

import numpy as np

from hypernode.config.methods import Frequencies, Method
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_of
from hypernode.material.node_material import NodeMaterial
from hypernode.networks.weights import make_network
from hypernode.stages import baseline, hypernetwork_files
from hypernode.storage.netcdf import SYNTHETIC_UNITS, read, write
from hypernode.training.loop import Fit
from tests.evaluation.files import measurement, square_mesh

MESH = square_mesh(3)
STATES = np.array([np.diag([1.1, 0.97]), np.diag([1.2, 0.95])])
F = np.broadcast_to(STATES[:, None], (2, len(MESH.cells), 2, 2))


def files(folder):
    """A measurement pulled along x between edges that hold it, and its deformation."""
    force = np.zeros((2, 4, 2))
    force[:, 1, 0] = force[:, 0, 0] = [0.2, 0.4]
    force[:, 0] *= -1.0
    test = measurement(MESH, STATES, force, [("left", 0), ("right", 0)])
    grid = {"X": MESH.nodes, "cells": MESH.cells, "corners": np.stack([MESH.lower, MESH.upper])}
    paths = {"measurement": folder / "measurement.nc", "field": folder / "gradient.nc"}
    content = {name: test[name].values for name in test.variables}
    write(paths["measurement"], content, "measurement", {"units": SYNTHETIC_UNITS, "thickness": 1.0})
    write(paths["field"], {**grid, "F": F}, "gradient", {"units": SYNTHETIC_UNITS})
    return paths


def ranges_of(path):
    return domain_of(read(path)).ranges


def test_a_baseline_writes_the_domain_of_an_isotropic_material(tmp_path):
    baseline.run(Method(baseline="homogeneous"), "sheet", files(tmp_path), tmp_path / "material.nc", {})
    assert ranges_of(tmp_path / "material.nc") == Domain.of(F, directional=False).ranges


def test_a_trained_network_writes_the_domain_of_a_material_with_fibres(tmp_path):
    paths, settings = files(tmp_path), Frequencies(features=2, frequency_scale=1.0, widths=[2])
    spec = {"terms": ("I1", "I4v"), "hidden": (2,), "steps": 1, "invariant_scale": 0.3, "stress_scale": 1.0}
    node = NodeMaterial(**spec)
    problem = SimpleNamespace(
        name="sheet", mesh=MESH, node=node, spec=spec, hypernetwork=settings.model_dump_json(), length=1.0,
        inputs={key: read(path) for key, path in paths.items()},
    )  # fmt: skip
    network = make_network(settings, 0, node.size, 0)
    fit = Fit(network, np.zeros(1), np.zeros(1, int))
    hypernetwork_files.save(problem, fit, "material", paths, tmp_path / "material.nc", {})
    assert ranges_of(tmp_path / "material.nc") == Domain.of(F, directional=True).ranges
