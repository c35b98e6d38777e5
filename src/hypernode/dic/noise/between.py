"""Noise that differs from frame to frame, from differences in time: a motion that is smooth in time has none.

Deformation may be as rough in space as noise is, as at interfaces and clamps. In time it is smooth. What engine and
speckle do alike in all frames is not seen here (:mod:`.local` sees it as far as it is rough).
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from hypernode.dic.noise.local import STENCIL
from hypernode.dic.noise.static import says_something, static_fit

#: Third difference, beside the fourth one: of noise both have the same level, and of a motion that is not smooth the
#: third is larger.
_THIRD = np.array([-1.0, 3.0, -3.0, 1.0])
#: Ratio of both levels from which the motion is not smooth enough.
_SMOOTH = 1.1
#: Frames that a fourth difference and two patterns of the motion take, and as many differences again.
_FEWEST = 9
#: Differences that are looked at: at least, and at most, as long as they have no more than so many points. A level is
#: then known to a hundredth.
_LEAST, _MOST, _POINTS = 3, 24, 100_000


def between_frames(
    frames: Sequence[Float[np.ndarray, "row column 2"]],
) -> tuple[Float[np.ndarray, " 2"], Float[np.ndarray, " 2"]] | None:
    """(standard deviation of what differs from frame to frame, its correlation length in grid steps), by component.

    Fourth differences of consecutive frames are scaled to the level of one frame. A motion of the camera and a pace
    that changes leave multiples of affine motions and of the displacements of other frames: these are taken out.

    Args:
        frames: displacements in their order in time, NaN where a point was lost.

    Returns:
        None where there are too few frames, or where their motion is not smooth in time.
    """
    moved = [u for u in frames if np.nan_to_num(u).any()]
    if len(moved) < _FEWEST:
        return None
    fourth, third = (_differences(moved, stencil / np.linalg.norm(stencil)) for stencil in (STENCIL, _THIRD))
    if fourth is None or third is None:
        return None
    level, length = static_fit(fourth, range(len(fourth)))
    usual = np.median(level, axis=0)
    rougher = np.median(np.sqrt(np.nanmean(third**2, axis=(1, 2))), axis=0)
    if (usual == 0.0).any() or (rougher > _SMOOTH * usual).any():
        return None
    return usual, length


def _differences(moved: list[np.ndarray], stencil: np.ndarray) -> Float[np.ndarray, "difference row column 2"] | None:
    """Differences in time, without what affine motions and displacements of other frames explain of them."""
    count = np.clip(_POINTS // moved[0][..., 0].size, _LEAST, _MOST)
    starts = np.unique(np.linspace(0, len(moved) - len(stencil), count).astype(int))
    found = []
    for start in starts:
        own = range(start, start + len(stencil))
        others = [k for k in (0, len(moved) // 2, len(moved) - 1) if k not in own][-2:]
        left = _unexplained(np.tensordot(stencil, np.stack([moved[k] for k in own]), 1), [moved[k] for k in others])
        if says_something(left):
            found.append(left)
    return np.stack(found) if found else None


def _unexplained(difference: np.ndarray, patterns: list[np.ndarray]) -> Float[np.ndarray, "row column 2"]:
    row, column = np.indices(difference.shape[:2])
    design = np.concatenate([np.stack([np.ones(row.shape), row, column], axis=-1), *patterns], axis=-1)
    known = np.isfinite(design).all(axis=-1) & np.isfinite(difference).all(axis=-1)
    left = np.full(difference.shape, np.nan)
    if known.any():
        share = np.linalg.lstsq(design[known], difference[known], rcond=None)[0]
        left[known] = difference[known] - design[known] @ share
    return left
