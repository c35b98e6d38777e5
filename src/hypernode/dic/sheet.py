"""Where the points of a sheet at rest lie, and every other frame among them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hypernode.dic.errors import DicError
from hypernode.dic.grid import ExactGrid, NearGrid, grid_of
from hypernode.dic.plane import Plane, plane_of
from hypernode.dic.points import Points, refuse_strays
from hypernode.dic.series import Frame
from hypernode.dic.tilt import Tilt, tilt_of

#: Largest range of the out-of-plane displacement over the size of the sheet.
MAX_OUT_OF_PLANE = 0.05
#: Percentiles between which that range is taken: a few points that a camera mistook are not the sheet.
_RANGE = (1.0, 99.0)


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """The sheet at rest, in its own plane and along the axes of its grid.

    Attributes:
        at_rest: its points.
        reference: the number of their frame.
        plane: in which a stereo sheet lies; None of one camera.
        tilt: of the grid against the axes of the files; None where there is none.
        grid: on which the points lie.
        times: number -> time [s] that the name of a file says.
        bent: whether the sheet may move far out of its plane.
    """

    at_rest: Points
    reference: int
    plane: Plane | None
    tilt: Tilt | None
    grid: ExactGrid | NearGrid
    times: Mapping[int, float]
    bent: bool

    def frame(self, points: Points, number: int) -> Frame:
        """A frame on the grid.

        Raises:
            DicError: its points lie off the grid, or it moves out of its plane.
        """
        self.out_of_plane(points)
        points = self.plane.seen(points) if self.plane else points
        points = self.tilt.seen(points) if self.tilt else points
        values = self.grid.values(points, self.reference)
        return Frame(
            number, values, time=self.times.get(number, points.time), force=points.force, crosshead=points.crosshead
        )

    def out_of_plane(self, points: Points) -> float:
        """Range of a frame's out-of-plane displacement over the size of the sheet; 0 of one camera.

        Raises:
            DicError: it is large, and the configuration does not allow it.
        """
        if self.plane is None:
            return 0.0
        w = self.plane.seen(points).displacement[:, 2]
        size = np.ptp(self.at_rest.position[:, :2], axis=0).max()
        share = float(np.ptp(np.nanpercentile(w, _RANGE)) / size) if np.isfinite(w).any() else 0.0
        if share > MAX_OUT_OF_PLANE and not self.bent:
            raise DicError(
                f"{points.path}: the sheet moves out of its plane by {share:.0%} of its size, more than "
                f"{MAX_OUT_OF_PLANE:.0%}: it is not in plane stress; allow_out_of_plane: true reads it all the same"
            )
        return share


def sheet_of(at_rest: Points, reference: int, times: Mapping[int, float], bent: bool) -> Sheet:
    """The sheet whose points at rest are given.

    Raises:
        DicError: they span no plane or no grid, or one lies far from all others.
    """
    plane = plane_of(at_rest) if at_rest.position.shape[1] == 3 else None
    seen = plane.seen(at_rest) if plane else at_rest
    refuse_strays(seen)
    tilt = tilt_of(seen)
    seen = tilt.seen(seen) if tilt else seen
    return Sheet(
        at_rest=seen,
        reference=reference,
        plane=plane,
        tilt=tilt,
        grid=tilt.grid if tilt else grid_of(seen),
        times=times,
        bent=bent,
    )
