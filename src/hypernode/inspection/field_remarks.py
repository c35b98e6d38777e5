"""What of a field only who made the test can tell: a hole from lost points, up from down."""

from collections.abc import Mapping

import numpy as np
import scipy.ndimage

from hypernode.inspection.field import Field
from hypernode.inspection.known import Known, odd

#: Fewest points that make a hole, two each way; single points are lost on speckles.
_FEWEST = 4


def remarks_on(field: Field, given: Mapping[str, object]) -> Known:
    """What may be another sheet than it is taken for.

    Args:
        field: the frames.
        given: keys of the specimen that are known.
    """
    known = sum((odd(finding) for finding in field.series.findings), Known())
    known += _outline(field)
    missing = _hole(field)
    if missing:
        known += odd(
            f"{missing} neighbouring points inside are measured in no deformed frame: they count as lost ones with "
            "material beneath; if the sheet has a hole there, declare it, hole of its case"
        )
    if field.dialect in ("table", "arrays") and field.series.unit == "pixel" and "y_points" not in given:
        known += odd(
            "y of the table is taken to point upward, and that of pictures points downward: --set y_points=down where "
            "it does, or =up",
            "y_points",
        )
    return known


def _outline(field: Field) -> Known:
    """A question for each region at the rim that no deformed frame shows, but for a whole outermost line."""
    series, known = field.series, Known()
    regions, count = _unseen(field)
    rows, columns = regions.shape
    for k in range(1, count + 1):
        row, column = np.nonzero(regions == k)
        rim = {"left": column == 0, "right": column == columns - 1, "bottom": row == 0, "top": row == rows - 1}
        sides = [name for name, at in rim.items() if at.any()]
        whole = any(at.sum() == (rows if name in ("left", "right") else columns) for name, at in rim.items())
        # Outermost points alone are those that a window of the correlation loses.
        if not sides or whole or len(row) < _FEWEST or np.any(list(rim.values()), axis=0).all():
            continue
        x, y = series.x[column], series.y[row]
        known += odd(
            f"{len(row)} neighbouring points at the {' and '.join(sides)} of the field, x {x.min():.4g} to "
            f"{x.max():.4g} and y {y.min():.4g} to {y.max():.4g} {series.unit}, are measured in no deformed frame: "
            "they count as lost ones with material beneath; if the sheet ends there (a notch, a cut corner, a hole), "
            "declare it, hole of its case"
        )
    return known


def _unseen(field: Field) -> tuple[np.ndarray, int]:
    """(grid of regions that no deformed frame shows, their number)."""
    frames = field.series.frames[1:]
    if not frames:
        return np.zeros((len(field.series.y), len(field.series.x)), dtype=int), 0
    return scipy.ndimage.label(np.all([np.isnan(f.displacement).any(axis=2) for f in frames], axis=0))


def _hole(field: Field) -> int:
    """Points of the largest region inside that no deformed frame shows; 0 where it is small."""
    regions, count = _unseen(field)
    rim = np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]])
    sizes = [int((regions == k).sum()) for k in range(1, count + 1) if k not in rim]
    largest = max(sizes, default=0)
    return largest if largest >= _FEWEST else 0
