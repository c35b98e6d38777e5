"""What the pattern of the displacements that are missed says of its cause.

Noise differs from picture to picture. What the description misses is the same in every step, and grows with the test.
An error of the reference picture is the same in every step and does not grow. Elements that are too coarse, and lines
in the wrong place, miss displacements beside lines. A wrong law misses them all over the sheet.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from hypernode.fem.mesh import Mesh

#: Steps of the iteration that splits what steps share from what is of each alone: it halves its error in each.
SPLITS = 40
#: How often the mean square around lines must be that elsewhere so that lines count as its place.
AT_LINES = 2.0


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """Of residuals over their noise.

    Attributes:
        beyond: mean square beyond that of noise, not below zero.
        repeats: share of it that steps have in common, 0 to 1; None where there is one step.
        smooth: correlation of neighbouring points.
        growth: power of the deformation, 0, 1 or 2, with which the common part grows.
        at_lines: mean square around lines over that elsewhere; None without lines.
        lines_share: share of what is beyond noise that is around lines.
        affine: share of the squares that a camera which moves or turns would make.
    """

    beyond: float
    repeats: float | None
    smooth: float
    growth: int
    at_lines: float | None
    lines_share: float
    affine: float


def pattern_of(
    mesh: Mesh,
    residual: Float[np.ndarray, "step node 2"],
    deformation: Float[np.ndarray, " step"],
    lines: Bool[np.ndarray, " node"],
) -> Pattern:
    """The pattern of residuals.

    Args:
        residual: over noise, NaN where a point is lost.
        deformation: size of that of each step.
        lines: nodes around lines between materials.
    """
    known = np.isfinite(residual)
    r = np.where(known, residual, 0.0)
    size = np.sqrt(np.sum(r**2, axis=(1, 2)) / known.sum(axis=(1, 2)))
    total = float(np.mean(size**2))
    steps = len(r)
    common = None if steps == 1 else common_part(r.reshape(steps, -1), known.reshape(steps, -1))
    beyond = max(total - 1.0, 0.0)
    repeats = None if common is None else float(np.mean(common**2) / total)
    squares = np.sum(r**2, axis=(0, 2)) / np.maximum(known.sum(axis=(0, 2)), 1)
    # Correlation loses points beside lines first: what is lost is no zero.
    told = known.any(axis=(0, 2))
    at_lines, elsewhere = squares[lines & told], squares[~lines & told]
    around = len(at_lines) > 0 and len(elsewhere) > 0
    at, off = (float(at_lines.mean()), float(elsewhere.mean())) if around else (0.0, 1.0)
    return Pattern(
        beyond=beyond,
        repeats=repeats,
        smooth=neighbours(mesh, r, known),
        growth=1 if common is None else growth_of(common, deformation),
        at_lines=at / off if around else None,
        lines_share=max(1.0 - off / at, 0.0) * float(squares[lines].sum() / squares.sum()) if around else 0.0,
        affine=affine_share(mesh, r, known),
    )


def common_part(r, known) -> Float[np.ndarray, " step"]:
    """Root mean square of the one pattern that all steps share, with its sign in each; noise is left out.

    Squares of a step contain its own noise and products of two steps do not. So the diagonal is what the others tell.
    """
    count = np.maximum(known.astype(float) @ known.T, 1.0)
    C = (r @ r.T) / count
    off = C - np.diag(np.diag(C))
    diagonal = np.diag(C)
    for _ in range(SPLITS):
        values, vectors = np.linalg.eigh(off + np.diag(diagonal))
        a = vectors[:, -1] * np.sqrt(max(values[-1], 0.0))
        diagonal = np.minimum(a**2, np.diag(C))
    return a if a.sum() >= 0.0 else -a


def growth_of(common: Float[np.ndarray, " step"], deformation: Float[np.ndarray, " step"]) -> int:
    """Power of the deformation, 0, 1 or 2, that is nearest to how a pattern grows; 2 where it is none of the others."""
    s = deformation / deformation.max()
    # What grows with the square is told in part by the level: it may change its sign.
    curved = s * (s - (s**3).sum() / (s**2).sum())
    shapes = {0: np.ones_like(s), 1: s, 2: s**2}
    fits = {power: abs(common @ shape) / np.linalg.norm(shape) for power, shape in shapes.items()}
    if np.linalg.norm(curved) > 1e-9:
        fits[2] = max(fits[2], abs(common @ curved) / np.linalg.norm(curved))
    return max(fits, key=fits.get)


def neighbours(mesh: Mesh, r, known) -> float:
    """Correlation of points that are one side of a cell apart."""
    sides = np.concatenate([mesh.cells[:, [k, (k + 1) % 4]] for k in range(4)])
    a, b = np.unique(np.sort(sides, axis=1), axis=0).T
    both = known[:, a] & known[:, b]
    square = float((r**2).sum() / max(known.sum(), 1))
    return float((r[:, a] * r[:, b]).sum() / max(both.sum(), 1)) / max(square, 1e-300)


def affine_share(mesh: Mesh, r, known) -> float:
    """Share of the squares that is affine in the position, beyond what chance makes of so many numbers."""
    X = np.column_stack([np.ones(len(mesh.nodes)), mesh.nodes - mesh.nodes.mean(axis=0)])
    left = 0.0
    for step, i in np.ndindex(r.shape[0], 2):
        here = known[step, :, i]
        fitted = np.linalg.lstsq(X[here], r[step, here, i], rcond=None)[0]
        left += float(((r[step, here, i] - X[here] @ fitted) ** 2).sum())
    by_chance = 6.0 * len(r) / known.sum()
    return max(1.0 - left / max(float((r**2).sum()), 1e-300) - by_chance, 0.0)
