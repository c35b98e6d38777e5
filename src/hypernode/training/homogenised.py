"""One set of neural-ODE parameters for the whole sheet."""

from collections.abc import Collection
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.config.methods import Method, Node, needing_thickness
from hypernode.data.loading import Loading
from hypernode.fem.gradient import mean_gradient
from hypernode.fem.mesh import Mesh
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.kinematics import invariants
from hypernode.training.loop import Fit, compiled, minimise


class Homogenised(NamedTuple):
    """The homogenised material.

    Attributes:
        node: the neural-ODE material, with its units.
        fit: its parameters (parameter,) and the losses.
        P: its stress at the mean deformation of every step (step, 2, 2).
    """

    node: NodeMaterial
    fit: Fit
    P: np.ndarray


def terms_for(node: Node, field_terms: Collection[str]) -> tuple[str, ...]:
    """Terms of the networks that learn an equilibrium field.

    Powers of stretches join where the field has them. Where its sheet may change its volume, J joins, and terms that
    need the thickness leave.
    """
    if "J" in field_terms and "J" not in node.terms:
        others = (term for term in node.terms if term != "I1" and not needing_thickness([term]))
        return ("I1", *others, "J")
    return (*node.terms, *(node.further_terms if "ogden" in field_terms else ()))


def fit_homogenised(
    method: Method,
    name: str,
    mesh: Mesh,
    loading: Loading,
    F: Float[np.ndarray, "2 2 step cell"],
    field_terms: Collection[str] = (),
) -> Homogenised:
    """Fit the homogenised material to force over cross-section (equation ``pre-training1-3``).

    Components whose resultant is not measured and that are not free carry no data. The units of stress and of the
    invariants in the networks are set here: those of the largest load step, or none where the method does not
    normalise. So are their terms (:func:`terms_for`).
    """
    mean_F = jnp.asarray(mean_gradient(mesh, F), jnp.float32)
    largest = max(float(jnp.max(invariant)) - 3.0 for invariant in invariants(mean_F, jnp.zeros(()))[:2])
    unit = loading.scale if method.normalised else np.ones_like(loading.scale)
    node = NodeMaterial(
        terms=terms_for(method.node, field_terms),
        hidden=tuple(method.node.hidden),
        steps=method.node.rk4_steps,
        invariant_scale=largest if method.normalised else 1.0,
        stress_scale=float(unit.max()),
        share=method.node.share,
        scaled=method.node.scaled,
        potential=method.node.potential,
    )
    fitted = node.with_units_as_data()
    start = node.initial_params(jax.random.key(method.seed))
    target = jnp.asarray(loading.P_average, jnp.float32)
    known = jnp.asarray(loading.measured, jnp.float32)
    scale = jnp.asarray(unit, jnp.float32)[:, None, None]

    def predicted(params):
        return jnp.moveaxis(node_stress(fitted, mean_F, params[:, None])[..., 0], -1, 0)

    def loss(params, key):
        ode, _, constants, _ = node.split(params)
        ridge = method.homogenised.ridge * (jnp.sum(ode**2) + jnp.sum((constants - node.split(start)[2]) ** 2))
        return jnp.mean(known * ((predicted(params) - target) / scale) ** 2) + ridge

    fit = minimise(loss, start, method.homogenised, stage="homogenised NODE", case=name, seed=method.seed)
    return Homogenised(node, fit, np.asarray(compiled(predicted)(fit.params)))
