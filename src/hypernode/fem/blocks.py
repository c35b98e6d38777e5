"""Compiled functions of many points, called for blocks of one size or two: what is compiled serves any number."""

from collections.abc import Callable

import jax
import numpy as np

#: Points in a compiled call: enough that a call costs more than to begin it, and few where lines cut few cells.
BLOCK = 512
#: The same of large sheets, of which there are so many blocks at least: what takes least time a point.
LARGE, LEAST_LARGE = 8192, 4


def in_blocks(function: Callable, *given: np.ndarray):
    """What a compiled function answers, an array or several, whose last axis are points.

    Args:
        function: of arrays whose last axis are points.
        given: the arrays.
    """
    count, found = given[0].shape[-1], []
    size = LARGE if count >= LEAST_LARGE * LARGE else BLOCK
    for first in range(0, max(count, 1), size):
        block = [each[..., first : first + size] for each in given]
        if missing := size - block[0].shape[-1]:
            block = [np.concatenate([each, _filling(each, missing)], axis=-1) for each in block]
        found.append(function(*block))
    return jax.tree.map(
        lambda *parts: np.concatenate([np.asarray(each) for each in parts], axis=-1)[..., :count], *found
    )


def _filling(each: np.ndarray, missing: int) -> np.ndarray:
    """What fills a block: its last point again, or ones where it has none."""
    if each.shape[-1]:
        return np.repeat(each[..., -1:], missing, axis=-1)
    return np.ones((*each.shape[:-1], missing))
