"""Closed-form laws that a person can type into any finite-element code, as candidates for a phase."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.export.numpy_material.closed_form import goh, mooney_rivlin, neo_hookean, yeoh
from hypernode.export.numpy_material.mechanics import REFERENCE, first_piola_kirchhoff, invariants

#: Steps of Newton's method for the thickness of a compressible sheet from the linear answer: digits double with each.
NEWTON_STEPS = 6
#: Largest stress parameter over the stiffness where a fit begins; of a lambda, the sheet is then incompressible.
LARGE = 1e3


@dataclass(frozen=True, kw_only=True)
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
class ExportedLaw:
    """A law: its formula, its parameters and its response.

    Attributes:
        response: ({invariant: values}, {parameter: values}) -> (energy, {invariant: derivative}), of complex ones too.
    """

    name: str
    formula: str
    parameters: tuple[Parameter, ...]
    response: Callable[[Mapping, Mapping], tuple]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    def stress(self, F: Float[np.ndarray, "2 2 ..."], params: Float[np.ndarray, "parameter ..."]):
        """First Piola-Kirchhoff stress [i, J, ...] of a sheet in plane stress; parameters may be complex."""
        p = dict(zip(self.names, params, strict=True))
        angle = np.pi / 180.0 * p.get("fibre_angle", 0.0)
        I = invariants(F, angle)
        _, slope = self.response(I, p)
        return first_piola_kirchhoff(F, dict.fromkeys(REFERENCE, 0.0) | slope, angle)

    def bounds(self, stiffness: Float[np.ndarray, " fit"]) -> tuple[np.ndarray, np.ndarray]:
        """(lowest, highest) values (fit, parameter) where stresses are measured by a stiffness each."""
        unit = np.where([parameter.stress for parameter in self.parameters], stiffness[:, None], 1.0)
        return tuple(unit * [getattr(each, end) for each in self.parameters] for end in ("lowest", "highest"))

    def starts(self, stiffness: float) -> Float[np.ndarray, "start parameter"]:
        """Every combination of where fits begin."""
        axes = [np.array(each.starts) * (stiffness if each.stress else 1.0) for each in self.parameters]
        return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)


def demiray(I: Mapping, p: Mapping):
    """Psi = a/(2 b) (exp(b (I1 - 3)) - 1) (Demiray 1972), and its derivatives."""
    e = I["I1"] - 3.0
    return 0.5 * p["a"] / p["b"] * np.expm1(p["b"] * e), {"I1": 0.5 * p["a"] * np.exp(p["b"] * e)}


def logarithmic_neo_hookean(I: Mapping, p: Mapping):
    """Psi = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2 of the solid (Simo and Pister 1984), where S33 = 0.

    The thickness stretch t has mu (t^2 - 1) + lambda ln (J t) = 0, with J in the plane. There Psi has its minimum over
    t. So its derivatives are those at a given t.
    """
    mu, la, J = p["mu"], p["lambda"], I["J"]
    log_J = np.log(J)
    log_t = -la * log_J / (la + 2.0 * mu)
    for _ in range(NEWTON_STEPS):
        square = np.exp(2.0 * log_t)
        log_t = log_t - (mu * (square - 1.0) + la * (log_J + log_t)) / (2.0 * mu * square + la)
    volume, trace = log_J + log_t, I["I1"] - 1.0 / J**2
    energy = 0.5 * mu * (trace + np.exp(2.0 * log_t) - 3.0 - 2.0 * volume) + 0.5 * la * volume**2
    return energy, {"I1": 0.5 * mu, "J": mu / J**3 + (la * volume - mu) / J}


def _stress(name: str, start: float, lowest: float = 0.0) -> Parameter:
    return Parameter(name=name, stress=True, lowest=lowest, highest=LARGE, starts=(start,))


#: Candidates, the plainest first.
LAWS = (
    ExportedLaw("neo-Hookean", "mu/2 (I1 - 3)", (_stress("mu", 1.0, 1e-6),), neo_hookean),
    ExportedLaw(
        "Mooney-Rivlin",
        "C10 (I1 - 3) + C01 (I2 - 3)",
        (_stress("C10", 0.4, 1e-6), _stress("C01", 0.1)),
        mooney_rivlin,
    ),
    ExportedLaw(
        "compressible neo-Hookean",
        "mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2, with I1 and J of the solid",
        (
            _stress("mu", 1.0, 1e-6),
            Parameter(name="lambda", stress=True, lowest=1e-3, highest=LARGE, starts=(1.0, 30.0)),
        ),
        logarithmic_neo_hookean,
    ),
    ExportedLaw(
        "Demiray",
        "a/(2 b) (exp(b (I1 - 3)) - 1)",
        (_stress("a", 1.0, 1e-6), Parameter(name="b", stress=False, lowest=1e-3, highest=1e2, starts=(0.5,))),
        demiray,
    ),
    ExportedLaw(
        "Yeoh",
        "C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3",
        (_stress("C10", 0.5, 1e-6), _stress("C20", 0.01, -LARGE), _stress("C30", 0.001)),
        yeoh,
    ),
    ExportedLaw(
        "Gasser-Ogden-Holzapfel",
        "C10 (I1 - 3) + k1/(2 k2) (exp(k2 <E>^2) - 1), E = kappa (I1 - 3) + (1 - 3 kappa)(I4 - 1)",
        (
            _stress("C10", 0.4, 1e-6),
            _stress("k1", 0.5),
            Parameter(name="k2", stress=False, lowest=1e-3, highest=1e2, starts=(1.0,)),
            Parameter(name="kappa", stress=False, lowest=0.0, highest=1.0 / 3.0, starts=(0.1,)),
            Parameter(
                name="fibre_angle",
                stress=False,
                lowest=-360.0,
                highest=360.0,
                starts=(0.0, 45.0, 90.0, 135.0),
                unit="degree",
            ),
        ),
        goh,
    ),
)
