"""A field of closed-form laws: every cell belongs to one of them."""

import numpy as np

from hypernode.export.numpy_material.api import Law
from hypernode.export.numpy_material.cells import nearest_cell
from hypernode.export.numpy_material.mechanics import first_piola_kirchhoff, invariants, positive_part

#: Squared relative difference of two principal stretches below which powers of them are summed by a series.
EQUAL = 1e-5


def neo_hookean(I, p):
    """Psi = mu/2 (I1 - 3), and its derivatives."""
    return 0.5 * p["mu"] * (I["I1"] - 3.0), {"I1": 0.5 * p["mu"]}


def mooney_rivlin(I, p):
    """Psi = C10 (I1 - 3) + C01 (I2 - 3), and its derivatives."""
    return p["C10"] * (I["I1"] - 3.0) + p["C01"] * (I["I2"] - 3.0), {"I1": p["C10"], "I2": p["C01"]}


def yeoh(I, p):
    """Psi = C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3, and its derivatives."""
    e = I["I1"] - 3.0
    slope = p["C10"] + e * (2.0 * p["C20"] + 3.0 * e * p["C30"])
    return e * (p["C10"] + e * (p["C20"] + e * p["C30"])), {"I1": slope}


def fibres(k1, k2, E):
    """k1/(2 k2) (exp(k2 <E>^2) - 1), and its derivative by E."""
    E = positive_part(E)
    return 0.5 * k1 / k2 * np.expm1(k2 * E**2), k1 * E * np.exp(k2 * E**2)


def goh(I, p):
    """Psi = C10 (I1 - 3) + k1/(2 k2) (exp(k2 <E>^2) - 1), E = kappa (I1 - 3) + (1 - 3 kappa)(I4v - 1)."""
    share = 1.0 - 3.0 * p["kappa"]
    energy, slope = fibres(p["k1"], p["k2"], p["kappa"] * (I["I1"] - 3.0) + share * (I["I4v"] - 1.0))
    return p["C10"] * (I["I1"] - 3.0) + energy, {"I1": p["C10"] + p["kappa"] * slope, "I4v": share * slope}


def hgo(I, p):
    """Psi = C10 (I1 - 3) + sum_a k1_a/(2 k2) (exp(k2 <I4a - 1>^2) - 1) of two perpendicular families."""
    v, slope_v = fibres(p["k1"], p["k2"], I["I4v"] - 1.0)
    w, slope_w = fibres(p["k1w"], p["k2"], I["I4w"] - 1.0)
    return p["C10"] * (I["I1"] - 3.0) + v + w, {"I1": p["C10"], "I4v": slope_v, "I4w": slope_w}


def compressible_neo_hookean(I, p):
    """Psi = mu/2 (tr C + t^2 - 3 - 2 ln (J t)) + K/2 (J t - 1)^2 at the thickness stretch t for which S33 = 0."""
    mu, K, J = p["mu"], p["K"], I["J"]
    a, b = mu + K * J**2, K * J
    t = (b + np.sqrt(b**2 + 4.0 * a * mu)) / (2.0 * a)
    energy = 0.5 * mu * (I["I1"] - 1.0 / J**2 + t**2 - 3.0 - 2.0 * np.log(J * t)) + 0.5 * K * (J * t - 1.0) ** 2
    return energy, {"I1": 0.5 * mu, "J": mu / J**3 - mu / J + K * t * (J * t - 1.0)}


def ogden(I, p):
    """Psi = 2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3) with l3 = 1/J, and its derivatives by tr C and J."""
    alpha, J = p["alpha"], I["J"]
    b, m = 0.5 * alpha, 0.5 * (I["I1"] - 1.0 / J**2)
    # Near equal stretches, where x says nothing of its sign, by the first terms of the series.
    square = np.maximum(1.0 - (J / m) ** 2, 0.0)
    x = np.sqrt(np.maximum(square, EQUAL))
    total, difference = (1.0 + x) ** b + (1.0 - x) ** b, ((1.0 + x) ** (b - 1.0) - (1.0 - x) ** (b - 1.0)) / x
    series = 2.0 + b * (b - 1.0) * square * (1.0 + (b - 2.0) * (b - 3.0) * square / 12.0)
    slopes = (b - 1.0) * (2.0 + (b - 2.0) * (b - 3.0) * square / 3.0)
    total, difference = (np.where(square < EQUAL, *pair) for pair in ((series, total), (slopes, difference)))
    # x^2 = 1 - (J/m)^2: by m it has the derivative 2 J^2/m^3, by J it has -2 J/m^2.
    by_square = 0.5 * b * m**b * difference
    by_trace = 0.5 * (b * m ** (b - 1.0) * total + by_square * 2.0 * J**2 / m**3)
    by_J = -by_square * 2.0 * J / m**2 - alpha * J ** (-alpha - 1.0)
    factor = 2.0 * p["mu"] / alpha**2
    return factor * (m**b * total + J**-alpha - 3.0), {
        "I1": factor * by_trace,
        "J": factor * (by_J + 2.0 * by_trace / J**3),
    }


def gent(I, p):
    """Psi = -mu Jm/2 ln(1 - (I1 - 3)/Jm), and its derivative."""
    left = 1.0 - (I["I1"] - 3.0) / p["Jm"]
    return -0.5 * p["mu"] * p["Jm"] * np.log(left), {"I1": 0.5 * p["mu"] / left}


def demiray(I, p):
    """Psi = mu/(2 b) (exp(b (I1 - 3)) - 1), and its derivative."""
    grown = np.expm1(p["b"] * (I["I1"] - 3.0))
    return 0.5 * p["mu"] / p["b"] * grown, {"I1": 0.5 * p["mu"] * (grown + 1.0)}


def fung(I, p):
    """Psi = c/2 (exp(Q) - 1), Q = a_v Evv^2 + a_w Eww^2 + 2 a_vw Evv Eww + 4 a_s Evw^2, and its derivatives."""
    Evv, Eww = 0.5 * (I["I4v"] - 1.0), 0.5 * (I["I4w"] - 1.0)
    shear = I["I4v"] * I["I4w"] - I["J"] ** 2
    grown = np.expm1(p["a_v"] * Evv**2 + p["a_w"] * Eww**2 + 2.0 * p["a_vw"] * Evv * Eww + p["a_s"] * shear)
    slope = 0.5 * p["c"] * (grown + 1.0)
    return 0.5 * p["c"] * grown, {
        "I4v": slope * (p["a_v"] * Evv + p["a_vw"] * Eww + p["a_s"] * I["I4w"]),
        "I4w": slope * (p["a_w"] * Eww + p["a_vw"] * Evv + p["a_s"] * I["I4v"]),
        "J": -2.0 * slope * p["a_s"] * I["J"],
    }


MODELS = {
    each.__name__: each
    for each in (neo_hookean, mooney_rivlin, yeoh, goh, hgo, compressible_neo_hookean, ogden, gent, demiray, fung)
}


def cell_parameters(data, spec, X):
    """(models, {parameter: value at each position})."""
    cell = nearest_cell(data, X)
    values = {name: data[f"material.{name}"][cell] for name in spec["parameters"]}
    return spec["models"], {"fibre_angle": 0.0, **values}


def closed_form_energy(F, params):
    """Psi [n]: each point takes that of its own model."""
    models, p = params
    I = invariants(F, p["fibre_angle"])
    return sum(np.where(p["model"] == k, MODELS[name](I, p)[0], 0.0) for k, name in enumerate(models))


def closed_form_stress(F, params):
    """P[i, J, n]: each point takes that of its own model."""
    models, p = params
    I = invariants(F, p["fibre_angle"])
    slopes = [MODELS[name](I, p)[1] for name in models]
    dPsi = {
        name: sum(np.where(p["model"] == k, slope.get(name, 0.0), 0.0) for k, slope in enumerate(slopes)) for name in I
    }
    return first_piola_kirchhoff(F, dPsi, p["fibre_angle"])


LAW = Law(cell_parameters, closed_form_stress, closed_form_energy)
