"""Closed-form hyperelastic materials, used as the truth of synthetic tests.

Each material is an energy density Psi(invariants, parameters); its derivatives come from automatic
differentiation, so that equation, stress and tangent cannot disagree.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hypernode.mechanics.kinematics import Invariants, in_plane_trace


@dataclass(frozen=True)
class ClosedForm:
    """A material model: its equation, its parameters and its energy density."""

    equation: str
    parameters: tuple[str, ...]
    dimensionless: tuple[str, ...]
    energy_density: Callable[[Invariants, Mapping[str, Float[Array, "..."]]], Float[Array, "..."]]


def neo_hookean(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = mu/2 (I1 - 3)."""
    return 0.5 * p["mu"] * (I.I1 - 3.0)


def mooney_rivlin(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = C10 (I1 - 3) + C01 (I2 - 3)."""
    return p["C10"] * (I.I1 - 3.0) + p["C01"] * (I.I2 - 3.0)


def yeoh(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3."""
    e = I.I1 - 3.0
    return e * (p["C10"] + e * (p["C20"] + e * p["C30"]))


def _fibre_energy(k1, k2, stretch_measure):
    """k1/(2 k2) (exp(k2 E^2) - 1) for fibres that only carry tension, E >= 0."""
    E = jnp.maximum(stretch_measure, 0.0)
    return 0.5 * k1 / k2 * jnp.expm1(k2 * E**2)


def goh(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Gasser-Ogden-Holzapfel: Psi = C10 (I1 - 3) + k1/(2 k2) (exp(k2 E^2) - 1).

    E = kappa (I1 - 3) + (1 - 3 kappa)(I4v - 1), clamped at zero in compression.
    """
    E = p["kappa"] * (I.I1 - 3.0) + (1.0 - 3.0 * p["kappa"]) * (I.I4v - 1.0)
    return p["C10"] * (I.I1 - 3.0) + _fibre_energy(p["k1"], p["k2"], E)


def hgo(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Holzapfel-Gasser-Ogden, two perpendicular families v and w of strengths k1 and k1w."""
    return (
        p["C10"] * (I.I1 - 3.0)
        + _fibre_energy(p["k1"], p["k2"], I.I4v - 1.0)
        + _fibre_energy(p["k1w"], p["k2"], I.I4w - 1.0)
    )


def compressible_neo_hookean(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = mu/2 (tr C + t^2 - 3 - 2 ln (J t)) + K/2 (J t - 1)^2, at the thickness stretch t for which S33 = 0.

    t is the positive root of (mu + K J^2) t^2 - K J t - mu = 0, where Psi has its minimum.
    """
    mu, K, J = p["mu"], p["K"], I.J
    a, b = mu + K * J**2, K * J
    t = (b + jnp.sqrt(b**2 + 4.0 * a * mu)) / (2.0 * a)
    return 0.5 * mu * (in_plane_trace(I) + t**2 - 3.0 - 2.0 * jnp.log(J * t)) + 0.5 * K * (J * t - 1.0) ** 2


MODELS: dict[str, ClosedForm] = {
    "neo_hookean": ClosedForm("mu/2 (I1 - 3)", ("mu",), (), neo_hookean),
    "mooney_rivlin": ClosedForm("C10 (I1 - 3) + C01 (I2 - 3)", ("C10", "C01"), (), mooney_rivlin),
    "yeoh": ClosedForm("sum_n Cn0 (I1 - 3)^n, n = 1..3", ("C10", "C20", "C30"), (), yeoh),
    "goh": ClosedForm(
        "C10 (I1 - 3) + k1/(2 k2) (exp(k2 <kappa (I1 - 3) + (1 - 3 kappa)(I4v - 1)>^2) - 1)",
        ("C10", "k1", "k2", "kappa", "fibre_angle"),
        ("k2", "kappa", "fibre_angle"),
        goh,
    ),
    "hgo": ClosedForm(
        "C10 (I1 - 3) + sum_a k1_a/(2 k2) (exp(k2 <I4a - 1>^2) - 1), a = v, w",
        ("C10", "k1", "k1w", "k2", "fibre_angle"),
        ("k2", "fibre_angle"),
        hgo,
    ),
    "compressible_neo_hookean": ClosedForm(
        "mu/2 (I1 - 3 - 2 ln J) + K/2 (J - 1)^2", ("mu", "K"), (), compressible_neo_hookean
    ),
}
#: Values that keep an energy finite where a material point belongs to another model.
NEUTRAL = {"k2": 1.0, "K": 1.0}


def energy_density(
    models: tuple[str, ...], I: Invariants, parameters: Mapping[str, Float[Array, "..."]]
) -> Float[Array, "..."]:
    """Energy density of a field in which every point belongs to one of ``models``.

    Args:
        models: the models present, names in :data:`MODELS`.
        I: invariants of the batch.
        parameters: ``"model"`` (index into ``models``) and the union of the models' parameters;
            points of other models hold :data:`NEUTRAL` values or zero.
    """
    total = 0.0
    for index, name in enumerate(models):
        total = total + jnp.where(parameters["model"] == index, MODELS[name].energy_density(I, parameters), 0.0)
    return total


def energy_derivatives(
    models: tuple[str, ...], I: Invariants, parameters: Mapping[str, Float[Array, "..."]]
) -> Invariants:
    """dPsi/dI_k of :func:`energy_density` at every point, with the batch shape of ``I``."""
    return jax.grad(lambda invariants: jnp.sum(energy_density(models, invariants, parameters)))(I)
