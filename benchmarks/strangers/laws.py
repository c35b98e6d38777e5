"""Incompressible plane-stress laws of the sheets, as energies of the in-plane deformation gradient. Stresses in MPa.

They are written from their textbook form, and nothing of the project's own mechanics is imported here.
"""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

#: Largest share of a Gent chain's limit that is evaluated; beyond it the energy is infinite.
_LOCKED = 1.0 - 1e-9
#: Series of the inverse Langevin function: coefficients of (I1^n - 3^n) / N^(n - 1).
_CHAIN = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)
#: Newton steps to the thickness of a compressible sheet.
_NEWTON = 8


def _invariants(C):
    """(I1, I2) of a sheet whose thickness keeps the volume."""
    trace, area = jnp.trace(C), jnp.linalg.det(C)
    return trace + 1.0 / area, area + trace / area


def neo_hookean(C, p):
    """mu / 2 (I1 - 3)."""
    return p["mu"] / 2 * (_invariants(C)[0] - 3.0)


def mooney_rivlin(C, p):
    """mu / 2 ((1 - share) (I1 - 3) + share (I2 - 3))."""
    I1, I2 = _invariants(C)
    return p["mu"] / 2 * ((1.0 - p["share"]) * (I1 - 3.0) + p["share"] * (I2 - 3.0))


def yeoh(C, p):
    """mu / 2 (I1 - 3) + mu second (I1 - 3)^2 + mu third (I1 - 3)^3."""
    e = _invariants(C)[0] - 3.0
    return p["mu"] * (e / 2 + p["second"] * e**2 + p["third"] * e**3)


def goh(C, p):
    """A neo-Hookean matrix with one dispersed family of fibres that bears no pressure."""
    I1, _ = _invariants(C)
    fibre = jnp.array([jnp.cos(p["angle"]), jnp.sin(p["angle"])])
    E = p["kappa"] * (I1 - 3.0) + (1.0 - 3.0 * p["kappa"]) * (fibre @ C @ fibre - 1.0)
    fibres = p["k1"] / (2.0 * p["k2"]) * jnp.expm1(p["k2"] * jnp.maximum(E, 0.0) ** 2)
    return p["mu"] * ((I1 - 3.0) / 2 + fibres)


def ogden(C, p):
    """2 mu / alpha^2 (sum of stretch^alpha - 3)."""
    mean, area = jnp.trace(C) / 2, jnp.linalg.det(C)
    # Smooth where both stretches are equal; off by less than rounding of the solver elsewhere.
    radius = jnp.sqrt(((C[0, 0] - C[1, 1]) / 2) ** 2 + C[0, 1] ** 2 + 1e-12)
    half = p["alpha"] / 2
    return p["mu"] / (2 * half**2) * ((mean + radius) ** half + (mean - radius) ** half + area**-half - 3.0)


def arruda_boyce(C, p):
    """Five terms of the eight-chain model whose chains have N links."""
    I1, _ = _invariants(C)
    return p["mu"] * sum(c * (I1**n - 3.0**n) / p["N"] ** (n - 1) for n, c in enumerate(_CHAIN, start=1))


def gent(C, p):
    """-mu J / 2 log(1 - (I1 - 3) / J)."""
    used = (_invariants(C)[0] - 3.0) / p["J"]
    inside = jnp.where(used < _LOCKED, used, 0.0)
    return jnp.where(used < _LOCKED, -p["mu"] * p["J"] / 2 * jnp.log1p(-inside), jnp.inf)


def fung(C, p):
    """mu / 2 (exp(Q) - 1), Q = a1 E11^2 + a2 E22^2 + 2 a3 E11 E22 + a4 E12^2 of Green's strain in axes at an angle.

    Such laws are fitted to membranes of tissue. Beside them a hundredth of a neo-Hookean sheet keeps the equations
    solvable where a corner is compressed.
    """
    along = jnp.array([jnp.cos(p["angle"]), jnp.sin(p["angle"])])
    across = jnp.array([-along[1], along[0]])
    E = (C - jnp.eye(2)) / 2
    one, two, both = along @ E @ along, across @ E @ across, along @ E @ across
    Q = p["a1"] * one**2 + p["a2"] * two**2 + 2.0 * p["a3"] * one * two + p["a4"] * both**2
    return p["mu"] / 2 * jnp.expm1(Q) + 0.01 * neo_hookean(C, p)


def crossed(C, p):
    """mu / 2 (I1 - 3) and two unlike families of fibres, of strengths k1 k1 / 2, 100 degrees apart."""
    found = neo_hookean(C, p)
    for strength, angle in ((1.0, p["angle"]), (0.5, p["angle"] + jnp.deg2rad(100.0))):
        fibre = jnp.array([jnp.cos(angle), jnp.sin(angle)])
        E = jnp.maximum(fibre @ C @ fibre - 1.0, 0.0)
        found += strength * p["mu"] * p["k1"] / (2.0 * p["k2"]) * jnp.expm1(p["k2"] * E**2)
    return found


def softening(C, p):
    """mu n / (2 power) ((1 + (I1 - 3) / n)^power - 1): chains that give way; with a power below one half not convex."""
    E = _invariants(C)[0] - 3.0
    return p["mu"] * p["n"] / (2.0 * p["power"]) * ((1.0 + E / p["n"]) ** p["power"] - 1.0)


def yielding(C, p):
    """Neo-Hookean until E = I1 - 3 is start, then with a share of the stiffness: mu / 2 (E - (1 - share) ramp)."""
    E = _invariants(C)[0] - 3.0
    # The ramp bends over half of where it starts, so that Newton's method has a tangent.
    width = 0.5 * p["start"]
    return p["mu"] / 2 * (E - (1.0 - p["share"]) * width * jax.nn.softplus((E - p["start"]) / width))


def trellis(C, p):
    """mu / 2 (I1 - 3) + mu k / 2 C12^2 in axes at an angle: a fabric that resists shear along its yarns."""
    along = jnp.array([jnp.cos(p["angle"]), jnp.sin(p["angle"])])
    across = jnp.array([-along[1], along[0]])
    return neo_hookean(C, p) + p["mu"] * p["k"] / 2 * (along @ C @ across) ** 2


def compressible(C, p):
    """mu / 2 (tr C + s^2 - 3 - 2 ln J) + (bulk - 2/3) mu / 2 ln^2 J, with a thickness stretch s that is free."""
    area, lame = jnp.log(jnp.linalg.det(C)) / 2, p["bulk"] - 2.0 / 3.0
    thin = -lame / (lame + 2.0) * area
    for _ in range(_NEWTON):
        # d energy / d ln s = s^2 - 1 + lame ln J = 0.
        thin = thin - (jnp.exp(2.0 * thin) - 1.0 + lame * (area + thin)) / (2.0 * jnp.exp(2.0 * thin) + lame)
    J = area + thin
    return p["mu"] / 2 * (jnp.trace(C) + jnp.exp(2.0 * thin) - 3.0 - 2.0 * J + lame * J**2)


def porous_fibres(C, p):
    """A compressible matrix with one family of fibres, mu k1 / 2 (stretch^2 - 1)^2 where it is pulled."""
    fibre = jnp.array([jnp.cos(p["angle"]), jnp.sin(p["angle"])])
    return compressible(C, p) + p["mu"] * p["k1"] / 2 * jnp.maximum(fibre @ C @ fibre - 1.0, 0.0) ** 2


def grown(C, p):
    """A neo-Hookean sheet that is at rest when it is larger in its plane by a factor."""
    return p["grown"] ** 2 * neo_hookean(C / p["grown"] ** 2, p)


#: Kind -> (energy, bounds between which its parameters besides mu are drawn).
LAWS: dict[str, tuple[Callable, dict[str, tuple[float, float]]]] = {
    "neo_hookean": (neo_hookean, {}),
    "mooney_rivlin": (mooney_rivlin, {"share": (0.1, 0.5)}),
    "yeoh": (yeoh, {"second": (0.05, 0.25), "third": (0.0, 0.05)}),
    "goh": (goh, {"k1": (0.1, 0.5), "k2": (0.2, 2.0), "kappa": (0.0, 0.2), "angle": (-1.5, 1.5)}),
    "ogden": (ogden, {"alpha": (2.8, 5.5)}),
    "arruda_boyce": (arruda_boyce, {"N": (2.0, 6.0)}),
    "gent": (gent, {"J": (2.5, 6.0)}),
}

#: Laws that seeds do not draw, since no sum of convex isotropic terms and one family of fibres comes near.
WRONG: dict[str, Callable] = {
    **{"fung": fung, "crossed": crossed, "softening": softening, "yielding": yielding, "trellis": trellis},
    **{"porous_fibres": porous_fibres, "grown": grown},
}


def plane_strain(C, p):
    """mu / 2 (tr C - 2 - 2 ln J) + lame / 2 (ln J)^2 of a thick body whose thickness stays."""
    log_J = jnp.log(jnp.linalg.det(C)) / 2
    return p["mu"] / 2 * (jnp.trace(C) - 2.0 - 2.0 * log_J) + p["lame"] / 2 * log_J**2


def linear(C, p):
    """Hooke's law in plane stress, with the strain E = (C - I) / 2: mu E:E + mu nu / (1 - nu) (tr E)^2."""
    E = (C - jnp.eye(2)) / 2
    return p["mu"] * (jnp.sum(E * E) + p["nu"] / (1.0 - p["nu"]) * jnp.trace(E) ** 2)


#: Laws of sheets that no seed stands for.
FURTHER: dict[str, Callable] = {"plane_strain": plane_strain, "linear": linear, "compressible": compressible}


def energy(kind: str, laws: dict, F, weight):
    """Energy density of one point: that of each law [MPa], by its weight there.

    Args:
        kind: key of :data:`LAWS`, :data:`WRONG` or :data:`FURTHER`.
        laws: parameter -> its value in every law (law,).
        F: in-plane deformation gradient (2, 2).
        weight: of every law (law,), summing to one.
    """
    others = WRONG | FURTHER
    law = others[kind] if kind in others else LAWS[kind][0]
    each = jax.vmap(partial(law, F.T @ F))(laws)
    # A law that is not here may be beyond its limit.
    return jnp.sum(jnp.where(weight > 0.0, weight * each, 0.0))


@partial(jax.jit, static_argnames="kind")
def _stress(kind: str, laws: dict, F, weight):
    return jax.vmap(jax.grad(energy, argnums=2), (None, None, 0, 0))(kind, laws, F, weight)


def stress(kind: str, laws: dict, F, weight) -> np.ndarray:
    """First Piola-Kirchhoff stress [MPa] (..., point, 2, 2) at F (..., point, 2, 2) with weights (point, law)."""
    F = np.asarray(F, float)
    weights = np.broadcast_to(weight, (*F.shape[:-2], weight.shape[-1])).reshape(-1, weight.shape[-1])
    return np.asarray(_stress(kind, laws, F.reshape(-1, 2, 2), weights)).reshape(F.shape)
