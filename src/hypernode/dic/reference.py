"""Whether the first frame shows the sheet at rest."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.points import Points
from hypernode.dic.sheet import Sheet

#: Largest displacement of a reference, in steps of its grid: noise of a second picture of the sheet at rest.
_AT_REST = 0.05
#: The same where it is the picture that the others were compared with: rounding. Noise is a hundred times as large.
_ITSELF = 1e-5


def is_compared_with_itself(points: Points) -> bool:
    """Whether a frame is the reference: its displacement is none but for rounding."""
    step = np.sqrt(np.prod(np.ptp(points.position[:, :2], axis=0)) / len(points.position))
    return bool(np.abs(np.nan_to_num(points.displacement)).max() <= _ITSELF * step)


def refuse_deformed_reference(
    sheet: Sheet, dialect: Dialect, last: Callable[[], Points], newest_first: bool = False
) -> None:
    """Nothing, where the first frame shows the sheet at rest.

    Args:
        sheet: as the first frame has it.
        dialect: of the files.
        last: reads the last frame.
        newest_first: whether the numbers are said to run backwards, so that the first frame has the largest one.

    Raises:
        DicError: it does not, or holds all frames. The message says which key does, where the last frame is at rest or
            none of them is.
    """
    points, step = sheet.at_rest, float(min(sheet.grid.step))
    _refuse_several_frames(points, dialect)
    size = _moved(points)
    if not np.isfinite(size).any() or np.nanmax(size) <= _AT_REST * step:
        return
    worst = int(np.nanargmax(size))
    about = f"{points.path}:{points.line[worst]}: the first frame is moved by {size[worst]:.4g} {points.unit}: "
    moved = int((size > _AT_REST * step).sum())
    if 2 * moved < int(np.isfinite(size).sum()):
        raise DicError(
            f"{about}{moved} of {len(size)} points are, and the others are at rest: where the program failed at them, "
            "mark them by a column that tells so, --set 'valid={COLUMN: [LOW, HIGH]}', or delete their rows; where the "
            "sheet is stretched, export its reference, whose displacement is zero, as the first frame"
        )
    end = last()
    if np.nanmax(_moved(end), initial=0.0) <= _AT_REST * step and newest_first:
        raise DicError(
            f"{about}{end.path.name} shows the sheet at rest, so that the numbers run forward: leave newest_first out"
        )
    if np.nanmax(_moved(end), initial=0.0) <= _AT_REST * step:
        raise DicError(
            f"{about}the last one, {end.path.name}, shows the sheet at rest, so that the numbers run backwards: say "
            "newest_first: true (--set newest_first=true), or number the files in the order of the pictures"
        )
    raise DicError(
        f"{about}export the reference of {dialect.software}, whose displacement is zero, as its first frame; where "
        "displacements are from the sheet at rest, which is in no file, say implied_reference: true (--set "
        "implied_reference=true)"
    )


def _refuse_several_frames(points: Points, dialect: Dialect) -> None:
    """Nothing, where the first frame has each of its points once.

    Raises:
        DicError: most of them stand there several times, as in a table of all frames.
    """
    places, position = len(np.unique(points.position[:, :2], axis=0)), len(points.position)
    if 2 * places > position or dialect.content != "frame":
        return
    option = replace(dialect, frame="NAME").option(unit=points.unit)
    raise DicError(
        f"{points.path}: {position} rows have {places} positions, so that each stands there {position / places:.3g} "
        f"times: if it is a table of all frames, say which column has their number, {option}"
    )


def _moved(points: Points) -> np.ndarray:
    return np.linalg.norm(points.displacement[:, :2], axis=1)
