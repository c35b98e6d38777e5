"""Files of small materials of every kind, and exported packages as modules."""

import functools
import importlib.util
import json

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr
from flax import nnx

from hypernode.config.methods import Frequencies
from hypernode.export.numpy_package import numpy_package
from hypernode.fem.mesh import rectilinear
from hypernode.material.basis_file import basis_content
from hypernode.material.files import node_material
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.closed_forms import MODELS
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.networks.weights import from_arrays, make_network, to_arrays
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.evaluation.files import grid

SETTINGS = Frequencies(features=6, frequency_scale=0.5, widths=[8])
#: A graded grid with a hole.
X, Y = np.linspace(0.0, 2.0, 6) ** 1.2, np.linspace(1.0, 2.5, 5)
KEEP = np.ones((4, 5), bool)
KEEP[1:3, 2:4] = False
MESH = rectilinear(X, Y, KEEP)


def file_of(content, **attributes):
    """A file with a mesh."""
    attributes = {"title": "a sheet", "units": json.dumps(SYNTHETIC_UNITS), **attributes}
    return xr.Dataset({**grid(MESH), **content}, attrs=attributes)


@functools.cache
def node_file(terms, potential="node", scaled=True):
    """Random weights, large enough that every term counts. No test changes the file."""
    spec = {
        "terms": terms, "hidden": (3, 2), "steps": 2, "invariant_scale": 0.3, "stress_scale": 1.7, "share": 0.4,
        "scaled": scaled, "potential": potential,
    }  # fmt: skip
    material = NodeMaterial(**spec)
    network = make_network(SETTINGS, 0, material.size, 3)
    network.layers[-1].bias[...] = 3.0 * jax.jit(material.initial_params)(jax.random.key(5)).astype(jnp.float32)
    attributes = {"material_kind": "node", "node": json.dumps(spec), "hypernetwork": SETTINGS.model_dump_json()}
    return file_of(to_arrays(network, "hypernetwork"), length_scale=2.0, **attributes)


def basis_file(terms, subcells=4):
    basis, random = ConvexBasis(terms, 0.4), np.random.default_rng(2)
    params = basis.start[:, None, None] + random.normal(0.0, 0.4, (len(basis.names), subcells, len(MESH.cells)))
    content, kind = basis_content(basis, params)
    return file_of(content, **kind)


def closed_form_file():
    """Every law, each in some cells."""
    models = list(MODELS)
    random = np.random.default_rng(3)
    names = (
        "mu",
        "C10",
        "C01",
        "C20",
        "C30",
        "k1",
        "k1w",
        "k2",
        "K",
        "fibre_angle",
        "b",
        "c",
        "a_v",
        "a_w",
        "a_vw",
        "a_s",
    )
    values = {name: random.uniform(0.5, 1.5, len(MESH.cells)) for name in names}
    values |= {"kappa": random.uniform(0.0, 0.3, len(MESH.cells)), "model": np.arange(len(MESH.cells)) % len(models)}
    values |= {"alpha": random.choice([-3.0, 5.0], len(MESH.cells)), "Jm": random.uniform(5.0, 9.0, len(MESH.cells))}
    content = {f"material.{name}": ("cell", value) for name, value in values.items()}
    return file_of(content, material_kind="closed_form", models=json.dumps(models))


def double_parameters(file):
    """(material, positions -> parameters) of a hyper-network whose numbers are computed in double precision."""
    material = node_material(file)
    graph, state = nnx.split(from_arrays(SETTINGS, 0, material.size, file, "hypernetwork"))
    network = nnx.merge(graph, jax.tree.map(lambda each: each.astype(jnp.float64), state))
    lower = file["corners"].values[0]
    return material, lambda X: network((jnp.asarray(X) - lower) / file.attrs["length_scale"]).T


def exported(file, folder):
    """The package of a file, imported."""
    for name, content in numpy_package(file).items():
        (folder / name).write_bytes(content)
    spec = importlib.util.spec_from_file_location("exported_material", folder / "material.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def points(count, seed=0, size=0.15):
    """Random positions and admissible deformation gradients."""
    random = np.random.default_rng(seed)
    lower, upper = MESH.lower, MESH.upper
    F = np.eye(2) + random.normal(0.0, size, (count, 2, 2))
    assert np.linalg.det(F).min() > 0.0
    return lower + (upper - lower) * random.random((count, 2)), F
