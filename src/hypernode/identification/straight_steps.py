"""Steps of material parameters that are straight in the coefficients of the law.

The stress is linear in the coefficients of an energy. Parameters are their logarithms, relative to the level. What one
material has more of one coefficient and less of another may leave the deformation as it is: a valley, straight in the
coefficients and bent in their logarithms. A step that is straight in logarithms leaves it (docs/decisions/0202).
"""

import numpy as np
from jaxtyping import Float

from hypernode.identification import numerics
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, LETTERS, NONE, PARAMETERS, SMALLEST, ConvexBasis

#: Coefficients that are exponents or relative to the fibres, in which the stress is not linear.
NOT_LINEAR = ("h", "h1", "q")
LINEAR = [name for letter, name in LETTERS.items() if letter not in NOT_LINEAR]


def straight(
    basis: ConvexBasis, before: Float[np.ndarray, "material parameter"], change: Float[np.ndarray, "material parameter"]
) -> Float[np.ndarray, "material parameter"]:
    """Materials once their coefficients have changed as a change of the parameters says to first order."""
    names, after = basis.names, before + change
    linear = [k for k, name in enumerate(names) if name in LINEAR]
    vector = [k for k, name in enumerate(names) if name in FIBRE_VECTOR]
    mixing = ("I2", "ogden") if "ogden" in basis.terms else ()
    mixed = np.isin(np.array(names)[linear], [name for term in mixing for name in PARAMETERS[term]])
    values, slopes = _coefficients(before[:, linear])
    added = slopes * change[:, linear]
    # Coefficients over the level before: of I1, of those that are relative to it, and of the others.
    total = 1.0 + (values * mixed).sum(axis=1, keepdims=True)
    first = 1.0 / total
    level = change[:, :1]
    first_after = first * (1.0 + level - first * (added * mixed).sum(axis=1, keepdims=True))
    over = np.where(mixed, first * (values + added) + values * (first_after - first), values * (1.0 + level) + added)
    level_after = first_after + (over * mixed).sum(axis=1, keepdims=True)
    if min((first_after / first).min(), level_after.min()) < numerics.LEVEL_LEFT:
        return after
    after[:, :1] = before[:, :1] + np.log(level_after)
    after[:, linear] = _parameters(over / np.where(mixed, first_after, level_after))
    after[:, vector] = before[:, vector] + change[:, vector] / level_after
    return after


def _coefficients(parameters):
    """(coefficients, their slopes) of parameters, smoothed near zero as the law does."""
    value = np.expm1(parameters)
    root = np.sqrt(value**2 + 4.0 * SMALLEST**2)
    return 0.5 * (value + root), 0.5 * (1.0 + value / root) * (value + 1.0)


def _parameters(coefficients):
    """The inverse; at least where a coefficient is none."""
    least, _ = _coefficients(-NONE * SMALLEST)
    some = np.maximum(coefficients, least)
    return np.log1p(some - SMALLEST**2 / some)
