"""What a figure of a folder shows, as plain arrays."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from hypernode.dic.errors import DicError
from hypernode.dic.frames import mean_stretch, select_frames
from hypernode.inspection.field import mean_gradients
from hypernode.inspection.folder import Inspection
from hypernode.inspection.forces import Course


@dataclass(frozen=True, kw_only=True)
class FolderView:
    """A folder for the eye.

    Attributes:
        title: name and load.
        unit: of lengths, ``mm`` or ``pixel``.
        x, y: lines of the grid.
        ring: how many outermost rings of it are dropped.
        frame: number of the frame whose fields these are.
        displacement: NaN where a point was lost.
        numbers: of all frames.
        lost: share of the grid's points that each has lost.
        stretch: mean stretch along x and y and shear of each, NaN where it is not known.
        chosen: numbers of the frames that become load steps.
        courses: forces of the frames.
    """

    title: str
    unit: str
    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]
    ring: int
    frame: int
    displacement: Float[np.ndarray, "row column 2"]
    numbers: list[int]
    lost: Float[np.ndarray, " frame"]
    stretch: Float[np.ndarray, "frame 3"]
    chosen: list[int]
    courses: tuple[Course, ...]

    @property
    def missing(self) -> Bool[np.ndarray, "row column"]:
        """Points that are lost in the frame shown."""
        return np.isnan(self.displacement).any(axis=2)


def view_of(seen: Inspection) -> FolderView:
    """The view of a folder, as far as it is known.

    Raises:
        DicError: it has no frames that can be read.
    """
    if seen.load is None:
        raise DicError("\n".join(remark.sentence for remark in seen.known.missing))
    series, specimen = seen.field.series, seen.known.specimen(seen.folder)
    unit, mm = ("mm", seen.millimetres) if seen.millimetres else (series.unit, 1.0)
    chosen = _chosen(seen)
    shown = chosen[-1] if chosen else seen.load.frame
    field = next(frame.displacement for frame in series.frames if frame.number == shown)
    H = mean_gradients(seen.kept)
    return FolderView(
        title=_title(seen),
        unit=unit,
        x=series.x * mm,
        y=series.y * mm,
        ring=specimen.dropped_rings,
        frame=shown,
        displacement=field * mm,
        numbers=seen.field.numbers,
        lost=np.array([np.isnan(frame.displacement).any(axis=2).mean() for frame in series.frames]),
        stretch=np.stack([1.0 + H[:, 0, 0], 1.0 + H[:, 1, 1], H[:, 0, 1] + H[:, 1, 0]], axis=1),
        chosen=chosen,
        courses=seen.courses,
    )


def _title(seen: Inspection) -> str:
    load = seen.known.settings.get("load", "a load that is not known")
    return f"{seen.name}: {'looks like ' if 'load' in seen.known.guesses else ''}{load}"


def _chosen(seen: Inspection) -> list[int]:
    """The load steps; none where they cannot be chosen yet."""
    if seen.sheet is not None:
        return seen.sheet.cases[0].numbers.tolist()
    test = seen.known.specimen(seen.folder)
    if test.times is not None or not np.isfinite(mean_stretch(seen.kept, test.load)[1:]).any():
        return []
    try:
        return [int(number) for number in select_frames(test, seen.kept)]
    except DicError:
        return []


def largest_strain(
    x: Float[np.ndarray, " column"], y: Float[np.ndarray, " row"], u: Float[np.ndarray, "row column 2"]
) -> Float[np.ndarray, "cell_row cell_column"]:
    """Largest in-plane eigenvalue of the Green-Lagrange strain at the centres of cells, NaN beside a lost point.

    Args:
        x, y: lines of the grid.
        u: displacement.
    """
    along_x, along_y = np.diff(u, axis=1) / np.diff(x)[:, None], np.diff(u, axis=0) / np.diff(y)[:, None, None]
    H = np.stack([0.5 * (along_x[1:] + along_x[:-1]), 0.5 * (along_y[:, 1:] + along_y[:, :-1])], axis=-1)
    E = 0.5 * (H + np.swapaxes(H, -1, -2) + np.einsum("...ki,...kj->...ij", H, H))
    mean, half = 0.5 * (E[..., 0, 0] + E[..., 1, 1]), 0.5 * (E[..., 0, 0] - E[..., 1, 1])
    return mean + np.hypot(half, E[..., 0, 1])
