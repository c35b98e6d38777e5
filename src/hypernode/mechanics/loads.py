"""Load cases: which edges move, by how much, and which are free.

Every load moves its constrained (edge, component) pairs by an affine map u = H X of the bounding
rectangle. That one description gives the boundary values, the first guess of Newton's method and
the list of edges whose traction vanishes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

_ROLLERS_X = (("left", 0), ("right", 0))
_ROLLERS_Y = (("bottom", 1), ("top", 1))
_CLAMPS_Y = (("bottom", 0), ("bottom", 1), ("top", 0), ("top", 1))
_CLAMPS_X = (("left", 0), ("left", 1), ("right", 0), ("right", 1))
_XX, _YY, _XY = (0, 0), (1, 1), (0, 1)
#: Kind of load -> constrained (edge, component) pairs; every other pair is free of traction. In a
#: ``general`` test the outline moves as it was measured, and nothing is free. Of kinds with the same pairs the last one
#: says least of how they move, but for shear.
CONSTRAINED = {
    "equibiaxial": _ROLLERS_X + _ROLLERS_Y,
    "biaxial": _ROLLERS_X + _ROLLERS_Y,
    "uniaxial_x": _ROLLERS_X,
    "uniaxial_y": _ROLLERS_Y,
    "clamped_x": _CLAMPS_X,
    "clamped_y": _CLAMPS_Y,
    "shear": _CLAMPS_Y,
    "biaxial_clamped": _CLAMPS_X + _CLAMPS_Y,
    "general": _CLAMPS_X + _CLAMPS_Y,
}
#: Kind of load -> components (i, J) of the resultants that a testing machine measures: the force along i across the
#: sections whose normal is J. Those of ``general`` are as many as the machine has channels.
RESULTANTS = {
    "equibiaxial": (_XX, _YY),
    "biaxial": (_XX, _YY),
    "uniaxial_x": (_XX,),
    "uniaxial_y": (_YY,),
    "clamped_x": (_XX,),
    "clamped_y": (_YY,),
    "shear": (_XY,),
    "biaxial_clamped": (_XX, _YY),
    "general": (_XX, _YY),
}


#: Loads that pull along both axes.
BOTH_AXES = ("equibiaxial", "biaxial", "biaxial_clamped")


def tensile_axis(kind: str) -> int | None:
    """Axis along which alone a load pulls, or None of those that do not pull along one."""
    axes = {i for i, J in RESULTANTS[kind] if i == J}
    return axes.pop() if len(axes) == 1 else None


@dataclass(frozen=True)
class Load:
    """A load case: its kind and the displacement gradient H[step, i, J] of its edges."""

    kind: str
    H: Float[np.ndarray, "step 2 2"]

    @property
    def constrained(self) -> tuple[tuple[str, int], ...]:
        """The (edge, displacement component) pairs whose displacement is prescribed."""
        return CONSTRAINED[self.kind]

    @property
    def stretch(self) -> Float[np.ndarray, " step"]:
        """One number a step that names it: the largest edge stretch (1 + shear for ``shear``)."""
        return 1.0 + self.H.reshape(len(self.H), 4).max(axis=1)


def make_load(kind: str, stretches: Sequence) -> Load:
    """A load from its stretches: a number a step, or [x, y] a step where ``kind`` is biaxial.

    For ``shear`` the number less one is the shear displacement over the height.
    """
    stretches = np.asarray(stretches, dtype=float)
    H = np.zeros((len(stretches), 2, 2))
    if kind == "biaxial":
        H[:, 0, 0], H[:, 1, 1] = stretches[:, 0] - 1.0, stretches[:, 1] - 1.0
        return Load(kind, H)
    if kind == "shear":
        H[:, 0, 1] = stretches - 1.0
        return Load(kind, H)
    if kind in ("equibiaxial", "biaxial_clamped", "uniaxial_x", "clamped_x"):
        H[:, 0, 0] = stretches - 1.0
    if kind in ("equibiaxial", "biaxial_clamped", "uniaxial_y", "clamped_y"):
        H[:, 1, 1] = stretches - 1.0
    return Load(kind, H)
