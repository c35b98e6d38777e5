"""Closed-form hyperelastic materials, used as the truth of synthetic tests.

Each material is an energy density Psi(invariants, parameters); its derivatives come from automatic
differentiation, so that equation, stress and tangent cannot disagree.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from hypernode.mechanics.kinematics import Invariants, in_plane_trace

#: Squares of x below which the sum of two powers is its series, and how many of its terms leave no digit in doubt.
SERIES_BELOW, SERIES_TERMS = 1e-2, 8


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


def _sum_of_powers(trace, J, b):
    """c1^b + c2^b of the eigenvalues of the in-plane C, by its trace and their product J^2.

    With their mean m and half their difference r it is m^b ((1 + x)^b + (1 - x)^b), x = r/m, an even function of x
    whose series has the derivatives that the square root in x lacks where the two are equal.
    """
    m = 0.5 * trace
    square = 1.0 - (J / m) ** 2
    small = square < SERIES_BELOW
    series, coefficient = 1.0, 1.0
    for k in range(1, SERIES_TERMS):
        coefficient = coefficient * (b - 2 * k + 2) * (b - 2 * k + 1) / ((2 * k - 1) * 2 * k)
        series = series + coefficient * square**k
    x = jnp.sqrt(jnp.where(small, SERIES_BELOW, square))
    return m**b * jnp.where(small, 2.0 * series, (1.0 + x) ** b + (1.0 - x) ** b)


def ogden(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """One term of Ogden's series, Psi = 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3) with l3 = 1/J."""
    alpha = p["alpha"]
    powers = _sum_of_powers(in_plane_trace(I), I.J, 0.5 * alpha) + I.J**-alpha
    return 2.0 * p["mu"] / alpha**2 * (powers - 3.0)


def gent(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = -mu Jm/2 ln(1 - (I1 - 3)/Jm), infinite where I1 - 3 reaches Jm."""
    return -0.5 * p["mu"] * p["Jm"] * jnp.log1p(-(I.I1 - 3.0) / p["Jm"])


def demiray(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = mu/(2 b) (exp(b (I1 - 3)) - 1)."""
    return 0.5 * p["mu"] / p["b"] * jnp.expm1(p["b"] * (I.I1 - 3.0))


def fung(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = c/2 (exp(a_v Evv^2 + a_w Eww^2 + 2 a_vw Evv Eww + 4 a_s Evw^2) - 1) of a membrane (Tong and Fung 1976).

    E is the Green-Lagrange strain along v and w: 2 Evv = I4v - 1, 2 Eww = I4w - 1, 4 Evw^2 = I4v I4w - J^2.
    """
    Evv, Eww, shear = 0.5 * (I.I4v - 1.0), 0.5 * (I.I4w - 1.0), I.I4v * I.I4w - I.J**2
    Q = p["a_v"] * Evv**2 + p["a_w"] * Eww**2 + 2.0 * p["a_vw"] * Evv * Eww + p["a_s"] * shear
    return 0.5 * p["c"] * jnp.expm1(Q)


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
    "ogden": ClosedForm("2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3)", ("mu", "alpha"), ("alpha",), ogden),
    "gent": ClosedForm("-mu Jm/2 ln(1 - (I1 - 3)/Jm)", ("mu", "Jm"), ("Jm",), gent),
    "demiray": ClosedForm("mu/(2 b) (exp(b (I1 - 3)) - 1)", ("mu", "b"), ("b",), demiray),
    "fung": ClosedForm(
        "c/2 (exp(a_v Evv^2 + a_w Eww^2 + 2 a_vw Evv Eww + 4 a_s Evw^2) - 1)",
        ("c", "a_v", "a_w", "a_vw", "a_s", "fibre_angle"),
        ("a_v", "a_w", "a_vw", "a_s", "fibre_angle"),
        fung,
    ),
}
#: Values that keep an energy finite where a material point belongs to another model.
NEUTRAL = {"k2": 1.0, "K": 1.0, "alpha": 2.0, "Jm": 1e6, "b": 1.0}


def energy_density(
    models: tuple[str, ...], I: Invariants, parameters: Mapping[str, Float[ArrayLike, "..."]]
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
    models: tuple[str, ...], I: Invariants, parameters: Mapping[str, Float[ArrayLike, "..."]]
) -> Invariants:
    """dPsi/dI_k of :func:`energy_density` at every point, with the batch shape of ``I``."""
    return jax.grad(lambda invariants: jnp.sum(energy_density(models, invariants, parameters)))(I)
