"""Where a camera sees a place of the sheet's plane, and which place a pixel sees."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

#: Steps of Newton's method for the radius before the lens, whose cubic is nearly straight: each doubles the digits.
_STEPS = 6


@dataclass(frozen=True, kw_only=True)
class View:
    """A camera that looks straight at the plane of the sheet, through a lens that distorts radially.

    Attributes:
        rows, columns: of the picture.
        mm_per_pixel: length of a pixel on the sheet, in the unit of its lengths.
        origin_column, origin_row: pixel at which x = 0, y = 0 would be seen without distortion; the centre of a pixel
            has whole numbers, and row 0 is at the top.
        distortion: how far the corners of the picture are moved outward, over their distance from its centre; the
            first term of Brown, Close-range camera calibration (1971).
    """

    rows: int
    columns: int
    mm_per_pixel: float
    origin_column: float
    origin_row: float
    distortion: float = 0.0

    @property
    def _centre(self) -> Float[np.ndarray, " 2"]:
        return 0.5 * np.array([self.columns - 1.0, self.rows - 1.0])

    def pixels(self, x: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, "point 2"]:
        """(column, row) at which places of the plane are seen."""
        straight = np.array([self.origin_column, self.origin_row]) + x * (1.0, -1.0) / self.mm_per_pixel
        offset = straight - self._centre
        return self._centre + offset * (1.0 + self.distortion * self._share(offset) ** 2)[:, None]

    def places(self, pixels: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, "point 2"]:
        """Places of the plane that are seen at (column, row)."""
        offset = pixels - self._centre
        if self.distortion:
            seen = self._share(offset)
            share = seen.copy()
            for _ in range(_STEPS):
                cubic = self.distortion * share**2
                share -= (share * (1.0 + cubic) - seen) / (1.0 + 3.0 * cubic)
            offset = offset / (1.0 + self.distortion * share**2)[:, None]
        return (self._centre + offset - (self.origin_column, self.origin_row)) * self.mm_per_pixel * (1.0, -1.0)

    def _share(self, offset: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, " point"]:
        """Distance from the centre over that of the corners."""
        return np.hypot(*offset.T) / np.hypot(*self._centre)


def view_of(
    moved: Float[np.ndarray, "frame node 2"], mm_per_pixel: float, margin: int, distortion: float = 0.0
) -> View:
    """The view in which every place of some nodes is seen, with a margin around them.

    Args:
        moved: places of the nodes in every frame.
        margin: least pixels between them and the edge of the picture, were there no distortion.

    Raises:
        ValueError: the lens moves a node out of the picture.
    """
    places = moved.reshape(-1, 2) / mm_per_pixel
    low, high = np.floor(places.min(axis=0)), np.ceil(places.max(axis=0))
    columns, rows = (high - low).astype(int) + 2 * margin
    # Half a pixel, so that a sheet whose corner is the origin begins where a pixel does.
    view = View(
        rows=int(rows),
        columns=int(columns),
        mm_per_pixel=mm_per_pixel,
        origin_column=margin - 0.5 - low[0],
        origin_row=margin - 0.5 + high[1],
        distortion=float(distortion),
    )
    seen = view.pixels(moved.reshape(-1, 2))
    if (seen < -0.5).any() or (seen > np.array([columns, rows]) - 0.5).any():
        raise ValueError(f"the lens moves the sheet out of the picture: choose a margin of more than {margin} pixels")
    return view
