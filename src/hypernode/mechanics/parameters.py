"""Parameters of the closed-form materials and their ranges; free of imports so that the config can
read it fast. Moduli in the stress unit of the test, fibre_angle in degrees."""

#: Terms that the convex basis may have beside the neo-Hookean one.
BASIS_TERMS = ("I1_squared", "I2", "ogden", "fibre", "across", "stiffening", "I1_stiffening", "J")
_MODULUS, _ANY = (1e-12, 1e12), (-1e12, 1e12)
#: Model -> parameter -> (lowest, highest) allowed value.
PARAMETERS = {
    "neo_hookean": {"mu": _MODULUS},
    "mooney_rivlin": {"C10": _MODULUS, "C01": (0.0, 1e12)},
    "yeoh": {"C10": _MODULUS, "C20": _ANY, "C30": (0.0, 1e12)},
    "goh": {
        "C10": _MODULUS,
        "k1": (0.0, 1e12),
        "k2": (1e-6, 1e3),
        "kappa": (0.0, 1.0 / 3.0),
        "fibre_angle": (-360.0, 360.0),
    },
    "hgo": {
        "C10": _MODULUS,
        "k1": (0.0, 1e12),
        "k1w": (0.0, 1e12),
        "k2": (1e-6, 1e3),
        "fibre_angle": (-360.0, 360.0),
    },
    "compressible_neo_hookean": {"mu": _MODULUS, "K": _MODULUS},
    "ogden": {"mu": _MODULUS, "alpha": (-20.0, 20.0)},
    "gent": {"mu": _MODULUS, "Jm": (1e-3, 1e6)},
    "demiray": {"mu": _MODULUS, "b": (1e-6, 1e3)},
    "fung": {
        "c": _MODULUS,
        "a_v": (0.0, 1e3),
        "a_w": (0.0, 1e3),
        "a_vw": (0.0, 1e3),
        "a_s": (0.0, 1e3),
        "fibre_angle": (-360.0, 360.0),
    },
}
#: Parameters that energies divide by.
NONZERO = ("alpha",)
