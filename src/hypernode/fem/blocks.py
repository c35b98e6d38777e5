"""Compiled functions of many points, called for blocks of one size: what is compiled serves any number of points."""

from collections.abc import Callable, Sequence

import numpy as np

#: Points in a compiled call: enough that a call costs more than to begin it, and few where lines cut few cells.
BLOCK = 512


def in_blocks(function: Callable, *given: np.ndarray) -> list[np.ndarray]:
    """Results of a compiled function whose last axis are points.

    Args:
        function: of arrays whose last axis are points; answers with a sequence of such arrays.
        given: the arrays; no point at all is none of the results either.
    """
    count = given[0].shape[-1]
    found: list[Sequence] = []
    for first in range(0, max(count, 1), BLOCK):
        block = [each[..., first : first + BLOCK] for each in given]
        if missing := BLOCK - block[0].shape[-1]:
            # What fills the last block is its last point again.
            block = [np.concatenate([each, _filling(each, missing)], axis=-1) for each in block]
        found.append(function(*block))
    return [
        np.concatenate([np.asarray(each) for each in part], axis=-1)[..., :count] for part in zip(*found, strict=True)
    ]


def _filling(each: np.ndarray, missing: int) -> np.ndarray:
    if each.shape[-1]:
        return np.repeat(each[..., -1:], missing, axis=-1)
    return np.ones((*each.shape[:-1], missing))
