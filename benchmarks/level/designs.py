"""The sheets of four studies: seen in part, records that err, laws that are right or wrong, volumes that change."""

from collections.abc import Mapping

import numpy as np

from benchmarks.strangers.design import MODULUS, Sheet

#: Of every sheet unless its study says otherwise: strain, grid and noise of a good camera, a load cell of class 0.5.
USUAL = {
    **{"shape": "none", "kind": "neo_hookean", "load": "clamped_y", "top": 0.25, "across": 1.0, "points": 25},
    **{"seen": 1.0, "window": 0.0, "noise": 0.02, "step_pixels": 20.0},
    **{"force_scatter": 0.002, "force_gain": 0.0, "force_zero": 0.0},
}
CONTRASTS, SEEN, SHAPES = (1.0, 2.0, 5.0), (0.6, 0.8, 1.0), ("disc", "stripe")
PRELOADS, LATE = (0.0, 0.01, 0.02), (0, 1, 3)
#: Bulk over shear modulus; none where the volume is kept.
BULK = (1.0, 3.0, 10.0, None)
#: Kind of law -> its numbers beside the shear modulus.
ELASTIC = {
    "neo_hookean": {},
    "yeoh": {"second": 0.15, "third": 0.03},
    "ogden": {"alpha": -4.0},
}
RIGHT = ELASTIC | {"mooney_rivlin": {"share": 0.3}, "gent": {"J": 3.0}, "arruda_boyce": {"N": 3.0}}
#: Name -> (kind, its numbers, what else differs from a disc of contrast 2).
WRONG = {
    "fung": ("fung", {"a1": 6.0, "a2": 12.0, "a3": 2.0, "a4": 4.0, "angle": 0.4}, {}),
    "crossed": ("crossed", {"k1": 2.0, "k2": 1.0, "angle": 0.3}, {}),
    "softening": ("softening", {"n": 0.3, "power": 0.5}, {}),
    "yielding": ("yielding", {"start": 0.06, "share": 0.5}, {}),
    "trellis": ("trellis", {"k": 2.0, "angle": 0.4}, {}),
    "porous_fibres": ("porous_fibres", {"bulk": 3.0, "k1": 1.0, "angle": 0.9}, {}),
    "turning": ("goh", {"k1": 1.0, "k2": 0.5, "kappa": 0.0, "angle": (0.3, 1.8)}, {"shape": "slope"}),
    "creep": ("neo_hookean", {}, {"fades": 0.4}),
    "growth": ("grown", {}, {"grows": 0.05}),
    "thickness": ("neo_hookean", {}, {"shape": "none", "thins": 0.3}),
}
#: Noises of each law, and points along a side: laws that are wrong take the longest searches.
REPEATS, FEW_POINTS = 3, 17


def _sheet(seed: int, contrast: float = 1.0, further: Mapping[str, float] | None = None, **changed) -> Sheet:
    phases = 1 if changed.get("shape", "none") == "none" else 2
    laws = {"mu": MODULUS * np.array([1.0, contrast])[:phases]}
    laws |= {name: np.broadcast_to(value, phases) for name, value in (further or {}).items()}
    return Sheet(seed=seed, laws=laws, **(USUAL | changed))


def _seen() -> dict[str, Sheet]:
    """Discs and stripes of neo-Hookean sheets, of which the middle is seen; contrast 1 is a sheet without either."""
    found = {}
    for contrast in CONTRASTS:
        for shape in SHAPES if contrast > 1.0 else ("none",):
            for seen in SEEN:
                name = f"{shape}_{contrast:g}_seen_{seen:g}"
                found[name] = _sheet(len(found) + 1, contrast, shape=shape, seen=seen)
    return found


def _records() -> dict[str, Sheet]:
    """Sheets of one elastic material, stretched in the first picture, under a clock that is late."""
    found = {}
    for kind, further in ELASTIC.items():
        for preload in PRELOADS:
            for late in LATE:
                name = f"{kind}_preload_{100 * preload:g}_late_{late}"
                # Points at the very edge of a stretched sheet would lie beside it at rest.
                changed = {"kind": kind, "preload": preload, "late": late, "window": 1.5}
                found[name] = _sheet(len(found) + 101, further=further, **changed)
    return found


def _laws() -> dict[str, Sheet]:
    """Sheets of laws that a sum of convex terms comes near, and of laws or sheets that it cannot be."""
    found = {}
    kinds = {f"right_{kind}": (kind, further, {}) for kind, further in RIGHT.items()}
    kinds |= {f"wrong_{name}": each for name, each in WRONG.items()}
    for name, (kind, further, other) in kinds.items():
        for repeat in range(REPEATS):
            changed = {"kind": kind, "shape": "disc", "points": FEW_POINTS} | other
            found[f"{name}_{repeat + 1}"] = _sheet(len(found) + 1, 2.0, further, **changed)
    return found


def _volume() -> dict[str, Sheet]:
    """Discs of contrast 2 whose volume changes, by their bulk modulus over the shear modulus, or is kept."""
    found = {}
    for load in ("clamped_y", "biaxial"):
        for bulk in BULK:
            kind, further = ("neo_hookean", {}) if bulk is None else ("compressible", {"bulk": bulk})
            changed = {"kind": kind, "shape": "disc", "load": load, "across": 0.8, "points": FEW_POINTS}
            found[f"{load}_{'kept' if bulk is None else format(bulk, 'g')}"] = _sheet(
                len(found) + 1, 2.0, further, **changed
            )
    return found


#: Study -> its sheets by name.
STUDIES = {"seen": _seen, "records": _records, "laws": _laws, "volume": _volume}
