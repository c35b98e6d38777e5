"""Stage 5: one set of neural-ODE parameters for the whole sheet."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config.methods import Method
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of
from hypernode.fem.gradient import mean_gradient
from hypernode.material.laws import node_stress
from hypernode.mechanics.kinematics import invariants
from hypernode.networks.node_material import NodeMaterial
from hypernode.storage.netcdf import read, units_of, write
from hypernode.training.homogenised import RIDGE_CONSTANTS, RIDGE_WEIGHTS
from hypernode.training.loop import data_as_arguments, minimise


def run(method: Method, name: str, measurement_file: str, field_file: str, output: str, attributes: dict) -> None:
    """Fit the homogenised material to force over cross-section (equation ``pre-training1-3``).

    Components whose resultant is not measured and that are not free carry no data. The stress unit
    and the invariant unit of the networks are set here, from the largest load step.
    """
    measurement, field = read(measurement_file), read(field_file)
    loading, mesh = Loading.of(measurement), mesh_of(measurement)
    mean_F = jnp.asarray(mean_gradient(mesh, field_gradient(field)), jnp.float32)
    largest = max(float(jnp.max(invariant)) - 3.0 for invariant in invariants(mean_F, jnp.zeros(()))[:2])
    node = NodeMaterial(
        tuple(method.node.terms),
        tuple(method.node.hidden),
        method.node.rk4_steps,
        invariant_scale=largest,
        stress_scale=float(loading.scale.max()),
        share=method.node.share,
        scaled=method.node.scaled,
        potential=method.node.potential,
    )
    fitted = node.with_units_as_data()
    start = node.initial_params(jax.random.key(method.seed))
    target = jnp.asarray(loading.P_average, jnp.float32)
    known = jnp.asarray(loading.measured, jnp.float32)
    scale = jnp.asarray(loading.scale, jnp.float32)[:, None, None]

    def predicted(params):
        return jnp.moveaxis(node_stress(fitted, mean_F, params[:, None])[..., 0], -1, 0)

    def loss(params, key):
        ode, _, constants, _ = node.split(params)
        ridge = RIDGE_WEIGHTS * jnp.sum(ode**2) + RIDGE_CONSTANTS * jnp.sum((constants - node.split(start)[2]) ** 2)
        return jnp.mean(known * ((predicted(params) - target) / scale) ** 2) + ridge

    params, history, iterations = minimise(
        loss, start, method.homogenised, stage="homogenised NODE", case=name, seed=method.seed
    )
    evaluate, data = data_as_arguments(predicted, params)
    write(
        output,
        {
            "node_params": params,
            "P_average": loading.P_average,
            "P_homogenised": np.asarray(jax.jit(evaluate)(data, params)),
            "loss": history,
            "loss_iteration": iterations,
        },
        f"homogenised material of {name}",
        {**attributes, "units": units_of(measurement), "node": json.dumps(dataclasses.asdict(node))},
        parents=[measurement_file, field_file],
    )
