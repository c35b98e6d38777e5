"""Closed-form laws that a person can type into any finite-element code, as candidates for a phase."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hypernode.mechanics.closed_forms import goh, mooney_rivlin, neo_hookean, yeoh
from hypernode.mechanics.kinematics import Invariants, in_plane_trace, invariants
from hypernode.mechanics.stress import first_piola_kirchhoff

#: Steps of Newton's method for the thickness of a compressible sheet from the linear answer: digits double with each.
NEWTON_STEPS = 6
#: Largest stress parameter over the stiffness where a fit begins; of a lambda, the sheet is then incompressible.
LARGE = 1e3


@dataclass(frozen=True)
class Parameter:
    """One parameter of a law.

    Attributes:
        name: as in the formula.
        stress: whether it is a stress, and its numbers below shares of a stiffness; else it is a number.
        lowest, highest: bounds.
        starts: where fits begin.
        unit: of what is no stress.
    """

    name: str
    stress: bool
    lowest: float
    highest: float
    starts: tuple[float, ...]
    unit: str = "1"


@dataclass(frozen=True)
class Law:
    """A law: its formula, its parameters and its energy."""

    name: str
    formula: str
    parameters: tuple[Parameter, ...]
    energy: Callable[[Invariants, Mapping[str, Float[Array, ""]]], Float[Array, "..."]]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    def stress(self, F: Float[Array, "2 2 point"], params: Float[Array, " parameter"]) -> Float[Array, "2 2 point"]:
        """First Piola-Kirchhoff stress of a sheet in plane stress."""
        p = dict(zip(self.names, params, strict=True))
        angle = jnp.deg2rad(p.get("fibre_angle", 0.0))
        dPsi = jax.grad(lambda I: jnp.sum(self.energy(I, p)))(invariants(F, angle))
        return first_piola_kirchhoff(F, dPsi, angle)

    def bounds(self, stiffness: Float[np.ndarray, " fit"]) -> tuple[np.ndarray, np.ndarray]:
        """(lowest, highest) values (fit, parameter) where stresses are measured by a stiffness each."""
        unit = np.where([parameter.stress for parameter in self.parameters], stiffness[:, None], 1.0)
        return tuple(unit * [getattr(each, end) for each in self.parameters] for end in ("lowest", "highest"))

    def starts(self, stiffness: float) -> Float[np.ndarray, "start parameter"]:
        """Every combination of where fits begin."""
        axes = [np.array(each.starts) * (stiffness if each.stress else 1.0) for each in self.parameters]
        return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)


def demiray(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = a/(2 b) (exp(b (I1 - 3)) - 1) (Demiray 1972)."""
    return 0.5 * p["a"] / p["b"] * jnp.expm1(p["b"] * (I.I1 - 3.0))


def logarithmic_neo_hookean(I: Invariants, p: Mapping) -> Float[Array, "..."]:
    """Psi = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2 of the solid (Simo and Pister 1984), where S33 = 0.

    The thickness stretch t has mu (t^2 - 1) + lambda ln (J t) = 0, with J in the plane.
    """
    mu, la, log_J = p["mu"], p["lambda"], jnp.log(I.J)

    def closer(log_t, mu, la, log_J):
        square = jnp.exp(2.0 * log_t)
        return log_t - (mu * (square - 1.0) + la * (log_J + log_t)) / (2.0 * mu * square + la)

    found = jax.lax.stop_gradient((-la * log_J / (la + 2.0 * mu), mu, la, log_J))
    log_t = found[0]
    for _ in range(NEWTON_STEPS):
        log_t = closer(log_t, *found[1:])
    # One more step has the derivatives of the solution itself.
    log_t = closer(log_t, mu, la, log_J)
    volume = log_J + log_t
    return 0.5 * mu * (in_plane_trace(I) + jnp.exp(2.0 * log_t) - 3.0 - 2.0 * volume) + 0.5 * la * volume**2


def _stress(name: str, start: float, lowest: float = 0.0) -> Parameter:
    return Parameter(name, True, lowest, LARGE, (start,))


#: Candidates, the plainest first.
LAWS = (
    Law("neo-Hookean", "mu/2 (I1 - 3)", (_stress("mu", 1.0, 1e-6),), neo_hookean),
    Law(
        "Mooney-Rivlin",
        "C10 (I1 - 3) + C01 (I2 - 3)",
        (_stress("C10", 0.4, 1e-6), _stress("C01", 0.1)),
        mooney_rivlin,
    ),
    Law(
        "compressible neo-Hookean",
        "mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2, with I1 and J of the solid",
        (_stress("mu", 1.0, 1e-6), Parameter("lambda", True, 1e-3, LARGE, (1.0, 30.0))),
        logarithmic_neo_hookean,
    ),
    Law(
        "Demiray",
        "a/(2 b) (exp(b (I1 - 3)) - 1)",
        (_stress("a", 1.0, 1e-6), Parameter("b", False, 1e-3, 1e2, (0.5,))),
        demiray,
    ),
    Law(
        "Yeoh",
        "C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3",
        (_stress("C10", 0.5, 1e-6), _stress("C20", 0.01, -LARGE), _stress("C30", 0.001)),
        yeoh,
    ),
    Law(
        "Gasser-Ogden-Holzapfel",
        "C10 (I1 - 3) + k1/(2 k2) (exp(k2 <E>^2) - 1), E = kappa (I1 - 3) + (1 - 3 kappa)(I4 - 1)",
        (
            _stress("C10", 0.4, 1e-6),
            _stress("k1", 0.5),
            Parameter("k2", False, 1e-3, 1e2, (1.0,)),
            Parameter("kappa", False, 0.0, 1.0 / 3.0, (0.1,)),
            Parameter("fibre_angle", False, -360.0, 360.0, (0.0, 45.0, 90.0, 135.0), "degree"),
        ),
        goh,
    ),
)
