"""A field of coefficients of the convex basis.

Psi = c [ (I1 - 3) + c1 <I1 - 3>^2 / (2 s) + c2 (I2 - 3) + k (<E_M>^2 + q <E_N>^2) / (2 s) ],
E_M = b (I1 - 3) + (1 - b)(M : C - 1),  M = [1 + rx, ry; ry, 1 - rx] / 2,  N = 1 - M.

With h the squares of fibres are s^2 (exp(h E^2 / s^2) - 1) exp(-h / 2) / h. With h1 that of E = <I1 - 3> is

2 s^2 (exp(h1 E / s) - 1 - h1 E / s) exp(-h1 / 8^0.5) / h1^2.

With c5 to c7 powers 6, 4 and -4 of principal stretches join,

Psi_O = c [c5 (I1^3 - 3 I1 I2) / 9 + c6 (I1^2 - 2 I2 - 3) / 4 + c7 (I2^2 - 2 I1 - 3) / 4].

With c3 and c4 the sheet is compressible: I1 - 3 is tr C - 2 in the plane, the first term tr C - 2 J, and the area adds

Psi_J = c [2 c3 (J - 1 - ln J) + c4 (2 J + 1/J^2 - 3)].
"""

import numpy as np

from hypernode.export.numpy_material.api import Law
from hypernode.export.numpy_material.cells import nearest_cell
from hypernode.export.numpy_material.mechanics import invariants, positive_part, stress_with_structure, stretch_powers
from hypernode.material.lines import like_its_point


def cell_coefficients(data, spec, X):
    """(s, {letter: values (subcell, n)}): the material of a cell is the mean of those of its subcells."""
    cell = nearest_cell(data, X)
    if "line_distances" in data:
        place = (X - data["cell_middle"][cell]) / data["cell_sides"][cell]
        cell = like_its_point(cell, place, data["line_distances"], data["cell_label"])
    return spec["invariant_scale"], {letter: data[letter][:, cell] for letter in spec["letters"]}


def stiffened_fibres(E, s, h):
    """(<E>^2, or what h makes of it; its derivative by E)."""
    E = positive_part(E)
    if h is None:
        return E**2, 2.0 * E
    y, unstretched = h * (E / s) ** 2, np.exp(-h / 2.0)
    return s**2 * np.expm1(y) * unstretched / h, 2.0 * E * np.exp(y) * unstretched


def stiffened_matrix(E, s, h):
    """The same of I1 - 3."""
    E = positive_part(E)
    if h is None:
        return E**2, 2.0 * E
    y, unstretched = h * E / s, np.exp(-h / 8.0**0.5)
    return 2.0 * s**2 * (np.expm1(y) - y) * unstretched / h**2, 2.0 * s * np.expm1(y) * unstretched / h


def families(F, isotropic, p):
    """(share of the strength, (M11, M22, M12), E) of each family of fibres."""
    C11, C22 = F[0, 0] ** 2 + F[1, 0] ** 2, F[0, 1] ** 2 + F[1, 1] ** 2
    C12 = F[0, 0] * F[0, 1] + F[1, 0] * F[1, 1]
    for sign, share in ((1.0, 1.0), (-1.0, p.get("q", 0.0))):
        M = 0.5 * (1.0 + sign * p["rx"]), 0.5 * (1.0 - sign * p["rx"]), 0.5 * sign * p["ry"]
        planar = M[0] * C11 + M[1] * C22 + 2.0 * M[2] * C12 - 1.0
        yield share, M, p["b"] * isotropic + (1.0 - p["b"]) * planar


def subcell_response(F, s, p):
    """(Psi, P) of one subcell of every point, for coefficients p (n,)."""
    I = invariants(F, 0.0)
    compressible = "c3" in p
    e = I["I1"] - 1.0 / I["J"] ** 2 - 2.0 if compressible else I["I1"] - 3.0
    energy, dI1, dI2, dJ, S = e + 0.0, np.ones_like(e), p.get("c2", 0.0), 0.0, (0.0, 0.0, 0.0)
    energy = energy + dI2 * (I["I2"] - 3.0)
    if "c5" in p:
        for letter, power in zip(("c5", "c6", "c7"), stretch_powers(I).values(), strict=True):
            value, by_I1, by_I2 = (p[letter] * each for each in power)
            energy, dI1, dI2 = energy + value, dI1 + by_I1, dI2 + by_I2
    if "c1" in p:
        square, slope = stiffened_matrix(e, s, p.get("h1"))
        energy, dI1 = energy + p["c1"] * square / (2.0 * s), dI1 + p["c1"] * slope / (2.0 * s)
    if "k" in p:
        for share, M, E in families(F, e, p):
            square, slope = stiffened_fibres(E, s, p.get("h"))
            weight = p["k"] * share / (2.0 * s)
            energy, dI1 = energy + weight * square, dI1 + p["b"] * weight * slope
            on_fibres = 2.0 * (1.0 - p["b"]) * weight * slope
            S = tuple(known + on_fibres * component for known, component in zip(S, M, strict=True))
    if compressible:
        J = I["J"]
        energy = (
            energy - 2.0 * (J - 1.0) + 2.0 * p["c3"] * (J - 1.0 - np.log(J)) + p["c4"] * (2.0 * J + 1.0 / J**2 - 3.0)
        )
        # e = I1 - 1/J^2 - 2 depends on J as well.
        dJ = 2.0 * dI1 / J**3 - 2.0 + 2.0 * p["c3"] * (1.0 - 1.0 / J) + 2.0 * p["c4"] * (1.0 - 1.0 / J**3)
    return p["c"] * energy, p["c"] * stress_with_structure(F, dI1, dI2, S, dJ)


def mean_of_subcells(F, params, which):
    """Mean over the subcells of their energy (0) or stress (1)."""
    s, coefficients = params
    parts = [{letter: value[k] for letter, value in coefficients.items()} for k in range(len(coefficients["c"]))]
    return sum(subcell_response(F, s, p)[which] for p in parts) / len(parts)


LAW = Law(cell_coefficients, lambda F, p: mean_of_subcells(F, p, 1), lambda F, p: mean_of_subcells(F, p, 0))
