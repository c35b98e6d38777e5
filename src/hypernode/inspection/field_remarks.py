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
    missing = _hole(field)
    if missing:
        known += odd(
            f"{missing} neighbouring points inside are measured in no deformed frame: they count as lost ones with "
            "material beneath; if the sheet has a hole there, declare it, hole of its case"
        )
    if field.dialect == "table" and field.series.unit == "pixel" and "y_points" not in given:
        known += odd(
            "y of the table is taken to point upward, and that of pictures points downward: --set y_points=down where "
            "it does, or =up",
            "y_points",
        )
    return known


def _hole(field: Field) -> int:
    """Points of the largest region inside that no deformed frame shows; 0 where it is small."""
    frames = field.series.frames[1:]
    if not frames:
        return 0
    regions, count = scipy.ndimage.label(np.all([np.isnan(f.displacement).any(axis=2) for f in frames], axis=0))
    rim = np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]])
    sizes = [int((regions == k).sum()) for k in range(1, count + 1) if k not in rim]
    largest = max(sizes, default=0)
    return largest if largest >= _FEWEST else 0
