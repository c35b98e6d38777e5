"""The terms a neural-ODE material may have; free of imports so that the config can read it fast."""

#: Invariants that a term may use, with their value at F = I.
INVARIANTS = {"I1": 3.0, "I2": 3.0, "I4v": 1.0, "I4w": 1.0, "J": 1.0}
#: Sums of powers of the principal stretches, which are functions of I1 and I2
#: (:func:`~hypernode.mechanics.kinematics.stretch_powers`).
POWERS = ("ogden_6", "ogden_4", "ogden_minus_4")
_MIXED = [name for name in INVARIANTS if name != "J"]
#: Every term: one invariant, a mixture alpha I_i + (1 - alpha) I_j of two, or a sum of powers. With J the sheet is
#: compressible.
TERMS = {
    **{name: (name,) for name in (*INVARIANTS, *POWERS)},
    **{f"{a}_{b}": (a, b) for i, a in enumerate(_MIXED) for b in _MIXED[i + 1 :]},
}
#: Increasing functions that a term may be made of: a neural ODE, or what the literature uses in its place.
POTENTIAL_NAMES = ("node", "icnn", "cann")
