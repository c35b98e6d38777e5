"""A stereo sheet in the plane that fits it best."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from hypernode.dic.errors import DicError
from hypernode.dic.points import Points

#: Largest angle between a stereo sheet and the x-y plane of its export [degrees].
_MAX_TILT = 45.0


@dataclass(frozen=True)
class Plane:
    """The best-fit plane of a stereo sheet.

    Attributes:
        centre: a point of it.
        axes: unit vectors along x and y within it, and its normal, as rows.
    """

    centre: Float[np.ndarray, " 3"]
    axes: Float[np.ndarray, "3 3"]

    def seen(self, points: Points) -> Points:
        """Points with their components in the plane and, third, out of it."""
        return replace(
            points,
            position=np.einsum("pi,ki->pk", points.position - self.centre, self.axes),
            displacement=np.einsum("pi,ki->pk", points.displacement, self.axes),
        )


def plane_of(points: Points) -> Plane:
    """The best-fit plane of the reference's points, y of it nearest to the y of the files.

    Raises:
        DicError: the sheet stands steeply in the coordinates of its export.
    """
    centre = points.position.mean(axis=0)
    offset = points.position - centre
    normal = np.linalg.eigh(np.einsum("pi,pj->ij", offset, offset))[1][:, 0]
    normal = normal if normal[2] >= 0 else -normal
    tilt = np.degrees(np.arccos(min(normal[2], 1.0)))
    if tilt > _MAX_TILT:
        raise DicError(
            f"{points.path}: the sheet stands at {tilt:.0f} degrees to the x-y plane: export in its own coordinates"
        )
    along = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    along /= np.linalg.norm(along)
    return Plane(centre, np.stack([along, np.cross(normal, along), normal]))
