"""Loadings of a test: the parts of its course in which the sheet is pulled further, between unloadings."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

#: Share of the whole range by which a course must turn back to be unloaded, or loaded again; noise turns back by less.
_TURNS = 0.1
#: Rise of a loading over the largest one, from which it counts as one of the test.
_COUNTS = 0.5


@dataclass(frozen=True)
class Loading:
    """Where one loading begins and ends, as places of frames."""

    start: int
    peak: int


def loadings(course: Float[np.ndarray, " frame"]) -> list[Loading]:
    """The loadings of a course of mean stretches that count as such, in their order; one at least.

    Args:
        course: NaN where it is not known.
    """
    found = every_loading(course)
    rise = [course[each.peak] - course[each.start] for each in found]
    largest = np.nanmax(rise) if np.isfinite(rise).any() else 0.0
    return [each for each, size in zip(found, rise, strict=True) if not size < _COUNTS * largest]


def every_loading(course: Float[np.ndarray, " frame"]) -> list[Loading]:
    """The same with the smaller ones."""
    known = np.flatnonzero(np.isfinite(course))
    if not len(known):
        return [Loading(0, max(len(course) - 1, 0))]
    turn = _TURNS * float(np.ptp(course[known]))
    rising, low, high, found = True, known[0], known[0], []
    for k in known[1:]:
        if rising:
            if course[k] > course[high]:
                high = k
            elif course[high] - course[k] > turn:
                found.append(Loading(int(low), int(high)))
                rising, low = False, k
        elif course[k] < course[low]:
            low = k
        elif course[k] - course[low] > turn:
            rising, high = True, k
    if rising:
        found.append(Loading(int(low), int(high)))
    return found
