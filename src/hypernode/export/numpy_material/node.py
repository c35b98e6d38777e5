"""A hyper-network from the position to the parameters of increasing functions, which are the derivatives of the energy.

dPsi/dI of an invariant is a constant, exp(logarithm), and a share of the increasing function of each term it is in. The
function takes (I - I(F = 1)) / invariant_scale, or a mixture of two invariants. That of J takes (1 - J^-3) / 3. Sums of
powers of stretches count as invariants. All is in units of stress_scale.
"""

import numpy as np

from hypernode.export.numpy_material.api import Law
from hypernode.export.numpy_material.mechanics import (
    REFERENCE,
    first_piola_kirchhoff,
    invariants,
    positive_part,
    stretch_powers,
)
from hypernode.export.numpy_material.potentials import POTENTIALS

#: Invariants and sums of powers whose derivative has a constant part, in the order of its parameters.
CONSTANTS = ("I1", "I2", "ogden_6", "ogden_4", "ogden_minus_4")


def network(data, spec, X):
    """node_params [size, n] at positions X (n, 2): a tanh network on sines and cosines of 2 pi B X."""
    phase = 2.0 * np.pi * ((X - data["lower"]) / spec["length_scale"]) @ data["frequencies"]
    h = np.concatenate([np.sin(phase), np.cos(phase)], axis=-1)
    for k in range(spec["layers"]):
        h = (np.tanh(h) if k else h) @ data[f"kernel.{k}"] + data[f"bias.{k}"]
    return h.T


def split_parameters(data, spec, X):
    """What the network gives at positions X, by its meaning."""
    terms, raw = spec["terms"], network(data, spec, X)
    weights, rest = np.split(raw, [spec["weights_per_term"] * len(terms)])
    mixed = [k for k, term in enumerate(terms) if len(term) == 2]
    constants = [name for name in CONSTANTS if [name] in terms]
    share = {k: 1.0 / (1.0 + np.exp(-rest[m])) for m, k in enumerate(mixed)}
    rest = rest[len(mixed) :]
    own = np.exp(rest[len(constants) :][: len(terms)]) if spec["scaled"] else [spec["share"]] * len(terms)
    return {
        "spec": spec,
        "weights": weights.reshape(-1, len(terms), raw.shape[1]),
        "mixture": [(share[k], 1.0 - share[k]) if k in share else (1.0,) for k in range(len(terms))],
        "constants": dict(zip(constants, np.exp(rest[: len(constants)]), strict=True)),
        "own": own,
        "angle": raw[-1] if any("I4" in name for term in terms for name in term) else 0.0,
    }


def energy_derivatives(I, p):
    """{invariant: dPsi/dI}; a term with fibres bears tension alone, and so does tr C - 2 of a compressible sheet."""
    spec = p["spec"]
    compressible = ["J"] in spec["terms"]
    shifted = {name: I[name] - REFERENCE[name] for name in REFERENCE}
    if compressible:
        shifted |= {"I1": I["I1"] - 1.0 / I["J"] ** 2 - 2.0, "J": (1.0 - I["J"] ** -3.0) / 3.0}
    powers = {name: power for name, power in stretch_powers(I).items() if [name] in spec["terms"]}
    shifted |= {name: value for name, (value, _, _) in powers.items()}
    total = {name: p["constants"].get(name, 0.0) + 0.0 * I["I1"] for name in shifted}
    slope = POTENTIALS[spec["potential"]]
    for k, term in enumerate(spec["terms"]):
        value = sum(share * shifted[name] for share, name in zip(p["mixture"][k], term, strict=True))
        tension_only = any("I4" in name for name in term) or (compressible and term == ["I1"])
        value = positive_part(value) if tension_only else value
        found = p["own"][k] * slope(value / spec["invariant_scale"], p["weights"][:, k], spec["hidden"], spec["steps"])
        for share, name in zip(p["mixture"][k], term, strict=True):
            total[name] = total[name] + share * found
    if compressible:
        # tr C = I1 - 1/J^2, and the undeformed sheet is free of stress.
        total["J"] = total["J"] + 2.0 * total["I1"] / I["J"] ** 3 - 2.0 * p["constants"]["I1"]
    for name, (_, by_I1, by_I2) in powers.items():
        slope = total.pop(name)
        total["I1"], total["I2"] = total["I1"] + slope * by_I1, total["I2"] + slope * by_I2
    return {name: spec["stress_scale"] * value for name, value in total.items()}


def node_stress(F, p):
    """P[i, J, n]."""
    return first_piola_kirchhoff(F, energy_derivatives(invariants(F, p["angle"]), p), p["angle"])


def node_energy(F, p):
    """Psi [n], the integral of its derivatives from the undeformed invariants by Gauss-Legendre points."""
    I = invariants(F, p["angle"])
    change, total = {name: I[name] - value for name, value in REFERENCE.items()}, 0.0
    for point, weight in zip(*np.polynomial.legendre.leggauss(p["spec"]["energy_points"]), strict=True):
        between = {name: value + 0.5 * (point + 1.0) * change[name] for name, value in REFERENCE.items()}
        slope = energy_derivatives(between, p)
        total = total + 0.5 * weight * sum(slope[name] * change[name] for name in change)
    return total


LAW = Law(split_parameters, node_stress, node_energy)
