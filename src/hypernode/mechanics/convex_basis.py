"""A small convex basis of strain energies whose coefficients a full-field test can determine.

Psi = c [ (I1 - 3) + c1 (I1 - 3)^2 / (2 s) + c2 (I2 - 3) + k (<E_M>^2 + q <E_N>^2) / (2 s) ],
E_M = b (I1 - 3) + (1 - b) (M : C - 1),  M = (1 + r)/2 v x v + (1 - r)/2 w x w,  N = I - M,

with positive c, c1, c2, k, q, a dispersion b between 0 and 1, and s a typical I1 - 3. Every summand is
polyconvex. The parameters are unconstrained numbers, all but the first relative to it, so that where only
the stiffness jumps, only one of them does: the logarithm of c, log(1 + .) of c1, c2 and q, a logit, and for the
fibres v, at angle a, the doubled-angle vector z = |z| (cos 2a, sin 2a). It gives the fibres' strength k and their
alignment r. Both are functions of |z| that vanish at zero, so that a field of z is smooth where fibres begin or turn.
The family across, N, comes with the share q of their strength and ends where they do.

With the term stiffening the squares of the fibres' strains become exponentials, as in tissues. With I1_stiffening that
of E = I1 - 3 becomes the exponential without its first two terms, as in Demiray's law. Each has a positive h,

E^2 -> s^2 (exp(h E^2 / s^2) - 1) exp(-h / 2) / h,
E^2 -> 2 s^2 (exp(h E / s) - 1 - h E / s) exp(-h / 8^0.5) / h^2,

so that at E^2 = s^2 / 2 they are about as stiff as without: strength and stiffening hardly trade places.

With the term ogden three of Ogden's powers of the principal stretches l join: 6, 4 and -4. They are polynomials of I1
and I2, scaled as I1 - 3 for small strains,

Psi_O = c [ c5 (l1^6 + l2^6 + l3^6 - 3) / 9 + c6 (l1^4 + l2^4 + l3^4 - 3) / 4 + c7 (l1^-4 + l2^-4 + l3^-4 - 3) / 4 ].

Ogden's laws have no I1. They shall be no limit of a vanishing c. So the level of such a material is its stiffness for
small strains, c times 1 + c2 + c5 + c6 + c7, and c1 and k are relative to that.

With the term J the sheet is compressible. I1 - 3 becomes tr C - 2 in the plane, and the neo-Hookean term that of shear
alone, tr C - 2 J. The area has an energy of its own, with J in the plane and positive coefficients,

Psi_J = c [ 2 c3 (J - 1 - ln J) + c4 (2 J + 1/J^2 - 3) ].

With c3 = 1 and c4 = 0 a neo-Hookean sheet keeps its thickness when its area grows, with c3 = 0 and c4 = 1 its volume.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float

from hypernode.mechanics.kinematics import in_plane_trace, invariants, right_cauchy_green, stretch_powers
from hypernode.mechanics.parameters import BASIS_TERMS
from hypernode.mechanics.point_law import traced_once
from hypernode.mechanics.stress import stress_with_structure

#: Fibres weaker than this, relative to the matrix, begin gradually: their strength has no slope at zero.
ROUNDING = 0.02
#: Length of the fibre vector below which fibres lose their alignment: a fifth of their least strength.
TURNING = 0.004
#: Coefficients below this size approach zero gradually, at finite parameters: at minus infinity a search would stop.
SMALLEST = 0.005
#: Times this below zero a coefficient is a quarter of that, and has a twentieth of its slope.
NONE = 4.0
#: Ratio of stiffness from which the softer side takes all of the deformation to three digits, more than cameras tell.
RIGID = 1e3
#: Term -> names of its parameters and where an identification starts from.
PARAMETERS = {
    "I1_squared": {"log1p_I1_squared": 0.08},
    "I2": {"log1p_I2": 0.08},
    "ogden": {"log1p_ogden_6": 0.02, "log1p_ogden_4": 0.02, "log1p_ogden_minus_4": 0.02},
    "fibre": {"fibre_x": 0.1, "fibre_y": 0.0, "logit_dispersion": -2.0},
    "across": {"log1p_across": 0.02},
    "stiffening": {"log1p_stiffening": 0.08},
    "I1_stiffening": {"log1p_I1_stiffening": 0.08},
    "J": {"log1p_J_area": 0.4, "log1p_J_volume": 0.4},
}
#: Letter of a positive coefficient in the energy above -> its parameter; ``h1`` is the h of I1_stiffening.
LETTERS = {
    "c1": "log1p_I1_squared",
    "c2": "log1p_I2",
    "q": "log1p_across",
    "h": "log1p_stiffening",
    "h1": "log1p_I1_stiffening",
    "c3": "log1p_J_area",
    "c4": "log1p_J_volume",
    "c5": "log1p_ogden_6",
    "c6": "log1p_ogden_4",
    "c7": "log1p_ogden_minus_4",
}
#: Parameters that together are the doubled-angle vector of the fibres.
FIBRE_VECTOR = ("fibre_x", "fibre_y")
assert tuple(PARAMETERS) == BASIS_TERMS, "the names that the configuration offers are those of the basis"


def _coefficient(parameter):
    """Positive coefficient whose log(1 + .) is ``parameter``, smoothed near zero."""
    value = jnp.expm1(parameter)
    return 0.5 * (value + jnp.sqrt(value**2 + 4.0 * SMALLEST**2))


def _aligned(p):
    """(strength k, components of r (cos 2a, sin 2a)) of the fibres of parameters by name."""
    squared = p["fibre_x"] ** 2 + p["fibre_y"] ** 2
    length = jnp.sqrt(squared + TURNING**2)
    return jnp.sqrt(squared + ROUNDING**2) - ROUNDING, p["fibre_x"] / length, p["fibre_y"] / length


@dataclass(frozen=True)
class ConvexBasis:
    """Which terms are present.

    Attributes:
        terms: names in :data:`PARAMETERS`; the neo-Hookean term is always there.
        invariant_scale: s, a typical value of I1 - 3.
    """

    terms: tuple[str, ...]
    invariant_scale: float

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in their order."""
        return ("log_level", *(name for term in self.terms for name in PARAMETERS[term]))

    @property
    def lowest(self) -> Float[np.ndarray, " parameter"]:
        """Below which coefficients are none and have no slope; minus infinity for other parameters."""
        return np.where(np.isin(self.names, list(LETTERS.values())), -NONE * SMALLEST, -np.inf)

    @property
    def highest(self) -> Float[np.ndarray, " parameter"]:
        """Up to which coefficients can be told from rigid; infinity for other parameters."""
        return np.where(np.isin(self.names, list(LETTERS.values())), np.log1p(RIGID), np.inf)

    @property
    def has_fibres(self) -> bool:
        """Whether the material has a direction."""
        return "fibre" in self.terms

    @property
    def start(self) -> Float[np.ndarray, " parameter"]:
        """Parameters of a nearly neo-Hookean material of unit level."""
        return np.array([0.0, *(value for term in self.terms for value in PARAMETERS[term].values())])

    def energy(self, F: Float[ArrayLike, "2 2 ..."], params: Float[ArrayLike, "parameter ..."]) -> Float[Array, "..."]:
        """Energy density of a sheet in plane stress, of ``params`` in the order of :attr:`names`."""
        p = dict(zip(self.names, params, strict=True))
        I = invariants(F, 0.0)
        e1, e2 = self._isotropic(I), I.I2 - 3.0
        total = e1
        if "I2" in self.terms:
            total = total + _coefficient(p["log1p_I2"]) * e2
        if "ogden" in self.terms:
            for name, (value, _, _) in stretch_powers(I).items():
                total = total + _coefficient(p[f"log1p_{name}"]) * value
            total = total / self.mixed(p)
        if "J" in self.terms:
            total = total - 2.0 * (I.J - 1.0) + _coefficient(p["log1p_J_area"]) * 2.0 * (I.J - 1.0 - jnp.log(I.J))
            total = total + _coefficient(p["log1p_J_volume"]) * (2.0 * I.J + 1.0 / I.J**2 - 3.0)
        if "I1_squared" in self.terms:
            square, _ = self._square(e1, p, "I1_stiffening")
            total = total + _coefficient(p["log1p_I1_squared"]) * square / (2.0 * self.invariant_scale)
        if "fibre" in self.terms:
            strength, _, families = self._fibre(F, e1, p)
            squares = sum(share * self._square(E, p, "stiffening")[0] for share, _, E in families)
            total = total + strength * squares / (2.0 * self.invariant_scale)
        return jnp.exp(p["log_level"]) * total

    @traced_once
    def stress(
        self, F: Float[ArrayLike, "2 2 ..."], params: Float[ArrayLike, "parameter ..."]
    ) -> Float[Array, "2 2 ..."]:
        """First Piola-Kirchhoff stress P[i, J, ...], the derivative of :meth:`energy`."""
        p = dict(zip(self.names, params, strict=True))
        I = invariants(F, 0.0)
        e1 = self._isotropic(I)
        dI1, dI2, S = jnp.ones_like(e1), jnp.zeros_like(e1), (0.0, 0.0, 0.0)
        if "I2" in self.terms:
            dI2 = dI2 + _coefficient(p["log1p_I2"])
        if "ogden" in self.terms:
            for name, (_, by_I1, by_I2) in stretch_powers(I).items():
                coefficient = _coefficient(p[f"log1p_{name}"])
                dI1, dI2 = dI1 + coefficient * by_I1, dI2 + coefficient * by_I2
            dI1, dI2 = dI1 / self.mixed(p), dI2 / self.mixed(p)
        if "I1_squared" in self.terms:
            _, slope = self._square(e1, p, "I1_stiffening")
            dI1 = dI1 + _coefficient(p["log1p_I1_squared"]) * slope / (2.0 * self.invariant_scale)
        if "fibre" in self.terms:
            strength, b, families = self._fibre(F, e1, p)
            for share, M, E in families:
                slope = strength * share * self._square(E, p, "stiffening")[1] / (2.0 * self.invariant_scale)
                dI1 = dI1 + b * slope
                S = tuple(known + 2.0 * (1.0 - b) * slope * component for known, component in zip(S, M, strict=True))
        dJ = 0.0
        if "J" in self.terms:
            # tr C = I1 - 1/J^2, the shear energy's -2 J, and the energy of the area.
            dJ = 2.0 * dI1 / I.J**3 - 2.0 + 2.0 * _coefficient(p["log1p_J_area"]) * (1.0 - 1.0 / I.J)
            dJ = dJ + 2.0 * _coefficient(p["log1p_J_volume"]) * (1.0 - 1.0 / I.J**3)
        return jnp.exp(p["log_level"]) * stress_with_structure(F, dI1, dI2, S, dJ)

    def coefficients(self, params: Float[ArrayLike, "parameter ..."]) -> dict[str, Float[Array, "..."]]:
        """The numbers of the energy above by their letters; ``rx, ry`` of the fibres is r (cos 2a, sin 2a)."""
        p = dict(zip(self.names, params, strict=True))
        found = {"c": jnp.exp(p["log_level"])}
        for letter, name in LETTERS.items():
            if name in p:
                found[letter] = _coefficient(p[name])
        if self.has_fibres:
            k, x, y = _aligned(p)
            found |= {"k": k, "rx": x, "ry": y}
            found["b"] = jax.nn.sigmoid(p["logit_dispersion"])
        if "ogden" in self.terms:
            mixed = self.mixed(p)
            found["c"] = found["c"] / mixed
            found |= {letter: found[letter] * mixed for letter in ("c1", "k") if letter in found}
        return found

    def mixed(self, p):
        """1 + c2 + c5 + c6 + c7, what is relative to the level where powers of stretches join."""
        names = [name for term in ("I2", "ogden") if term in self.terms for name in PARAMETERS[term]]
        return 1.0 + sum(_coefficient(p[name]) for name in names)

    def _isotropic(self, I):
        """I1 - 3, or tr C - 2 where the sheet is compressible."""
        return in_plane_trace(I) - 2.0 if "J" in self.terms else I.I1 - 3.0

    def _square(self, E, p, term):
        """(square of a positive strain, or what a term of stiffening makes of it; its derivative)."""
        # tr C - 2 of a sheet that is compressed is negative, where the square falls: it would not be polyconvex.
        E = jnp.maximum(E, 0.0)
        if term not in self.terms:
            return E**2, 2.0 * E
        s, h = self.invariant_scale, _coefficient(p[f"log1p_{term}"])
        if term == "I1_stiffening":
            y, unstretched = h * E / s, jnp.exp(-h / 8.0**0.5)
            return 2.0 * s**2 * (jnp.expm1(y) - y) * unstretched / h**2, 2.0 * s * jnp.expm1(y) * unstretched / h
        y, unstretched = h * (E / s) ** 2, jnp.exp(-h / 2.0)
        return s**2 * jnp.expm1(y) * unstretched / h, 2.0 * E * jnp.exp(y) * unstretched

    def _fibre(self, F, e1, p):
        """(strength k, dispersion b, families); a family is its share, (M11, M22, M12) and its strain E.

        Fibres carry no load in compression: of E only positive values count.
        """
        strength, along, diagonal = _aligned(p)
        C11, C22, C12 = right_cauchy_green(F)
        b = jax.nn.sigmoid(p["logit_dispersion"])
        # The family across is that of the opposite doubled-angle vector.
        shares = [(1.0, 1.0)] + ([(-1.0, _coefficient(p["log1p_across"]))] if "across" in self.terms else [])
        families = []
        for sign, share in shares:
            x, y = sign * along, sign * diagonal
            M = 0.5 * (1.0 + x), 0.5 * (1.0 - x), 0.5 * y
            planar = M[0] * C11 + M[1] * C22 + 2.0 * M[2] * C12 - 1.0
            families.append((share, M, b * e1 + (1.0 - b) * planar))
        return strength, b, families
