"""Forces of elastic sheets in uniaxial tension, as many as tell an elastic record from one that relaxes."""

import numpy as np
from jaxtyping import Float

#: Exponents of Ogden's energy. Between them curves bend as sums of neighbours do; 2 and -2 are I1 and I2.
POWERS = (-8.0, -4.0, -2.0, 2.0, 4.0, 8.0)
#: Where chains lock: I1 - 3 over that of the largest stretch of the test.
LOCKING = (1.3, 2.0)
#: Exponent of an energy that stiffens exponentially, at the largest stretch of the test.
STIFFENING = 3.0
#: What is left of a chain's length at least, so that no stretch beyond the test locks it.
_LEAST_SLACK = 0.02
#: Half of the difference of two stretches that stands for a derivative.
_DIFFERENCE = 1e-5


def elastic_curves(stretch: Float[np.ndarray, " sample"], largest: float) -> dict[str, Float[np.ndarray, "2 sample"]]:
    """(force, its derivative by the stretch) of isotropic incompressible energies, each one at the largest stretch.

    Ogden's powers, chains that lock (Gent, A new constitutive relation for rubber, 1996), exponential stiffening. A
    convex energy has them with positive factors.

    Args:
        stretch: at least 1.
        largest: stretch of the test, more than 1.
    """
    end = largest**2 + 2.0 / largest - 3.0

    def first(x):
        return (x**2 + 2.0 / x - 3.0) / end

    laws = {f"power {a:g}": lambda x, a=a: (x ** (a - 1.0) - x ** (-a / 2.0 - 1.0)) / a for a in POWERS}
    for limit in LOCKING:
        laws[f"locking {limit:g}"] = lambda x, j=limit: (x - x**-2) / np.maximum(1.0 - first(x) / j, _LEAST_SLACK)
    laws["stiffening"] = lambda x: (x - x**-2) * np.expm1(STIFFENING * first(x))
    return {
        name: np.stack([law(stretch), (law(stretch + _DIFFERENCE) - law(stretch - _DIFFERENCE)) / (2.0 * _DIFFERENCE)])
        / law(np.array(largest))
        for name, law in laws.items()
    }
