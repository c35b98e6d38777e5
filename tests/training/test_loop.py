"""The training loop: one program for every case of the same shapes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.kinematics import Invariants
from hypernode.training.loop import data_as_arguments


def stress_loss(seed):
    """A loss that closes over arrays and over a material with its own units, both of which depend on ``seed``."""
    rng = np.random.default_rng(seed)
    material = NodeMaterial(
        terms=("I1", "I2"),
        hidden=(4,),
        steps=2,
        invariant_scale=rng.uniform(0.1, 0.5),
        stress_scale=rng.uniform(1.0, 9.0),
    ).with_units_as_data()
    strain, target = (
        jnp.asarray(rng.uniform(3.0, 3.4, (2, 7)), jnp.float32),
        jnp.asarray(rng.normal(size=7), jnp.float32),
    )

    def loss(params, key):
        at = jax.random.choice(key, 7, (5,), replace=False)
        I = Invariants(strain[0, at], strain[1, at], jnp.ones(5), jnp.ones(5), jnp.ones(5))
        return jnp.mean((material.energy_derivatives(I, params[:, None]).I1 - target[at]) ** 2)

    return loss, jnp.linspace(-0.3, 0.3, material.size, dtype=jnp.float32)


def test_data_of_a_loss_are_arguments_so_that_two_cases_share_one_program():
    key, programs = jax.random.key(3), []
    for seed in (1, 2):
        loss, params = stress_loss(seed)
        evaluate, data = data_as_arguments(loss, params, key)
        assert float(evaluate(data, params, key)) == pytest.approx(float(jax.jit(loss)(params, key)), rel=1e-5)
        programs.append(jax.jit(jax.value_and_grad(evaluate, argnums=1)).lower(data, params, key).as_text())
    assert programs[0] == programs[1]
