"""The homogenised material is read like any other, and is the same everywhere."""

import dataclasses
import json

import jax.numpy as jnp
import numpy as np
import xarray as xr

from hypernode.material.files import material_of
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial


def test_a_homogenised_material_has_the_stress_of_its_parameters_at_every_point():
    node = NodeMaterial(terms=("I1", "I2"), hidden=(2,), steps=2, invariant_scale=0.5, stress_scale=3.0)
    params = np.random.default_rng(0).normal(size=node.size).astype(np.float32)
    units = {"length": "1", "stress": "Pa", "force": "Pa", "energy": "Pa"}
    attributes = {"material_kind": "homogenised", "node": json.dumps(dataclasses.asdict(node))}
    file = xr.Dataset({"node_params": ("parameter", params)}, attrs=attributes | {"units": json.dumps(units)})
    X, F = np.array([[0.1, 0.2], [0.9, 0.4]]), np.diag([1.2, 1.05])
    P = np.asarray(material_of(file).stress(X, np.stack([F, F])))
    wanted = node_stress(node, jnp.asarray(F[..., None], jnp.float32), jnp.asarray(params[:, None]))[..., 0]
    np.testing.assert_array_equal(P[0], P[1])
    np.testing.assert_allclose(P[0], wanted, rtol=1e-5)
