"""Kinematics and stress of a thin sheet in plane stress; tensor indices come first and points last, F[i, J, n]."""

import numpy as np

#: The invariants of the undeformed sheet.
REFERENCE = {"I1": 3.0, "I2": 3.0, "I4v": 1.0, "I4w": 1.0, "J": 1.0}


def positive_part(x):
    """max(x, 0), also of complex numbers; where it begins, its slope is the mean of those on both sides."""
    return np.where(np.real(x) > 0.0, x, np.where(np.real(x) == 0.0, 0.5 * x, 0.0))


def invariants(F, angle):
    """{name: value} of the invariants, with F33 = 1/J of an incompressible sheet, and of the in-plane J.

    I1 = tr C + 1/J^2, I2 = J^2 + tr C / J^2, I4v = v.C v, I4w = w.C w, v at the angle [rad] from x and w across it.
    """
    C11, C22 = F[0, 0] ** 2 + F[1, 0] ** 2, F[0, 1] ** 2 + F[1, 1] ** 2
    C12 = F[0, 0] * F[0, 1] + F[1, 0] * F[1, 1]
    J, trace, c, s = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0], C11 + C22, np.cos(angle), np.sin(angle)
    return {
        "I1": trace + 1.0 / J**2,
        "I2": J**2 + trace / J**2,
        "I4v": c**2 * C11 + 2.0 * c * s * C12 + s**2 * C22,
        "I4w": s**2 * C11 - 2.0 * c * s * C12 + c**2 * C22,
        "J": J,
    }


def stretch_powers(I):
    """{name: (value, its derivatives by I1 and I2)} of sums of powers of the principal stretches of a sheet.

    (l1^6 + l2^6 + l3^6 - 3) / 9, (l1^4 + l2^4 + l3^4 - 3) / 4 and (l1^-4 + l2^-4 + l3^-4 - 3) / 4.
    """
    return {
        "ogden_6": ((I["I1"] ** 3 - 3.0 * I["I1"] * I["I2"]) / 9.0, (I["I1"] ** 2 - I["I2"]) / 3.0, -I["I1"] / 3.0),
        "ogden_4": ((I["I1"] ** 2 - 2.0 * I["I2"] - 3.0) / 4.0, 0.5 * I["I1"], -0.5),
        "ogden_minus_4": ((I["I2"] ** 2 - 2.0 * I["I1"] - 3.0) / 4.0, -0.5, 0.5 * I["I2"]),
    }


def stress_with_structure(F, dI1, dI2, S, dJ):
    """P[i, J, n] = dI1 dI1/dF + dI2 dI2/dF + dJ dJ/dF + F S, for S = 2 sum_k dPsi/dI4k a_k x a_k as (S11, S22, S12)."""
    (F11, F12), (F21, F22) = F
    J, trace = F11 * F22 - F12 * F21, F11**2 + F12**2 + F21**2 + F22**2
    on_F = 2.0 * (dI1 + dI2 / J**2)
    on_cofactor = -2.0 * dI1 / J**3 + 2.0 * dI2 * (J - trace / J**3) + dJ
    M11, M22, M12 = on_F + S[0], on_F + S[1], S[2]
    return np.array(
        [
            [F11 * M11 + F12 * M12 + on_cofactor * F22, F11 * M12 + F12 * M22 - on_cofactor * F21],
            [F21 * M11 + F22 * M12 - on_cofactor * F12, F21 * M12 + F22 * M22 + on_cofactor * F11],
        ]
    )


def first_piola_kirchhoff(F, dPsi, angle):
    """P[i, J, n] from the derivatives {invariant: dPsi/dI} and the angle of the first fibre direction [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    v, w = dPsi["I4v"], dPsi["I4w"]
    S = 2.0 * (v * c**2 + w * s**2), 2.0 * (v * s**2 + w * c**2), 2.0 * (v - w) * c * s
    return stress_with_structure(F, dPsi["I1"], dPsi["I2"], S, dPsi["J"])
