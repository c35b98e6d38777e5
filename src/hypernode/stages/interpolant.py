"""Stage 4: a continuous deformation gradient (X, t) -> F for every test."""

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config.methods import Interpolant
from hypernode.data.measurement import mesh_of
from hypernode.networks.weights import make_network, split_trainable, to_arrays
from hypernode.storage.netcdf import read, units_of, write
from hypernode.training.interpolant import relative_variance
from hypernode.training.loop import minimise


def run(settings: Interpolant, seed: int, name: str, gradient_file: str, output: str, attributes: dict) -> None:
    """Fit one network a test to F at the cell centres (equation ``eq_training_FDM_Fint``).

    The misfit of each load step is measured in units of that step's own F - I, and the network's
    output is scaled by it, so that small steps are fitted as well as large ones.
    """
    data = read(gradient_file)
    mesh = mesh_of(data)
    length = float(mesh.size.max())
    tests, F = data["load_case"].values, data["F"].values
    amplitude = np.sqrt(np.mean((F - np.eye(2)) ** 2, axis=(1, 2, 3)))
    t = np.array([amplitude[k] / amplitude[tests == tests[k]].max() for k in range(len(tests))])
    X = jnp.asarray((mesh.centres - mesh.lower) / length, jnp.float32)
    variables, losses, fitted = {}, [], np.empty_like(F)
    for test in range(tests.max() + 1):
        steps = np.flatnonzero(tests == test)
        target = jnp.asarray((F[steps] - np.eye(2)) / amplitude[steps, None, None, None], jnp.float32)
        target, load = target.reshape(len(steps), -1, 4), jnp.asarray(t[steps, None, None], jnp.float32)
        params, apply = split_trainable(make_network(settings, 1, 4, seed + 100 * test))
        count = min(settings.points or len(X), len(X))

        def loss(params, key, target=target, load=load, apply=apply, count=count):
            at = slice(None) if count == len(X) else jax.random.choice(key, len(X), (count,), replace=False)
            return jnp.mean((apply(params)(X[None, at], load) - target[:, at]) ** 2)

        params, history, iterations = minimise(
            loss, params, settings, stage="interpolant", case=f"{name}, test {test}", seed=seed
        )
        variables |= to_arrays(apply(params), f"interpolant{test}")
        values = np.asarray(apply(params)(X[None], load), float).reshape(len(steps), -1, 2, 2)
        fitted[steps] = np.eye(2) + values * amplitude[steps, None, None, None]
        losses.append(history)
    variables |= {key: data[key].values for key in ("X", "cells", "corners", "load_case", "stretch")}
    variables |= {"t": t, "amplitude": amplitude}
    variables |= {"loss": np.mean(losses, axis=0), "loss_iteration": iterations}
    described = {
        **attributes,
        "units": units_of(data),
        "interpolant": settings.model_dump_json(),
        "length_scale": length,
    }
    axes = (1, 2, 3)
    variables["F_interpolated"] = fitted
    variables["gradient_variance"] = relative_variance(mesh, fitted - F)
    variables["misfit"] = np.sqrt(np.sum((fitted - F) ** 2, axis=axes) / np.sum((F - np.eye(2)) ** 2, axis=axes))
    write(output, variables, f"interpolated deformation gradient of {name}", described, parents=[gradient_file])
