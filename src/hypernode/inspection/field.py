"""What the frames of a folder are: dialect, grid, numbers, lost points and how far the sheet moves."""

from collections import Counter
from dataclasses import dataclass
from itertools import islice

import numpy as np
import scipy.ndimage
from jaxtyping import Bool, Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.data.boundary import LEAST_MEASURED
from hypernode.dic.folder import Found
from hypernode.dic.frames import mean_gradient
from hypernode.dic.reading import read_test
from hypernode.dic.series import Series
from hypernode.progress import heard


@dataclass(frozen=True)
class Lost:
    """Grid points without displacement in one frame: connected with the outline through others, or inside."""

    frame: int
    outline: int
    inside: int

    @property
    def points(self) -> int:
        """All of them."""
        return self.outline + self.inside


#: Most missing frames that are listed.
_MOST_ABSENT = 1000


@dataclass(frozen=True, kw_only=True)
class Field:
    """The frames of a folder.

    Attributes:
        software, dialect: what wrote them, in words and in the configuration.
        y_points: where y of the files points, ``up`` or ``down``.
        stereo: whether they have a third coordinate.
        series: all frames on their grid.
        said: what the import says of them.
    """

    software: str
    dialect: str
    y_points: str
    stereo: bool
    series: Series
    said: tuple[str, ...]

    @property
    def notes(self) -> tuple[str, ...]:
        """What the import says of the grid: all but the first, which is what other attributes hold."""
        return self.said[1:]

    @property
    def numbers(self) -> list[int]:
        """Numbers of the frames, the reference first."""
        return [frame.number for frame in self.series.frames]

    @property
    def every(self) -> int:
        """Usual difference between the numbers of neighbouring frames."""
        return Counter(np.diff(self.numbers).tolist()).most_common(1)[0][0] if len(self.numbers) > 1 else 1

    @property
    def absent(self) -> list[int]:
        """Numbers that are missing between the first and the last frame, at their usual difference: the first of them.

        Frames that are named by a clock, or misnamed, are as far apart as their digits say.
        """
        numbers = self.numbers
        there = set(numbers)
        gone = (number for number in range(numbers[0], numbers[-1] + 1, self.every) if number not in there)
        return list(islice(gone, _MOST_ABSENT))

    @property
    def absent_count(self) -> int:
        """How many are missing, those beyond the first among them."""
        numbers = self.numbers
        expected = range(numbers[0], numbers[-1] + 1, self.every)
        return len(expected) - sum(number in expected for number in set(numbers))

    @property
    def step(self) -> tuple[float, float]:
        """Of the grid along x and y."""
        return tuple(float(np.median(np.diff(lines))) for lines in (self.series.x, self.series.y))

    @property
    def extent(self) -> tuple[float, float]:
        """Of the grid along x and y."""
        return float(self.series.x[-1]), float(self.series.y[-1])

    @property
    def lost(self) -> list[Lost]:
        """Lost points of every frame."""
        return [_lost(frame.number, np.isnan(frame.displacement).any(axis=2)) for frame in self.series.frames]


def read_field(test: SpecimenTest, found: Found) -> Field:
    """Read the frames of a test.

    Raises:
        DicError: as :func:`read_test`.
    """
    with heard() as said:
        series = read_test(test)
    up = found.dialect.y_up if test.y_points is None else test.y_points == "up"
    return Field(
        software=found.dialect.software,
        dialect=found.dialect.name,
        y_points="up" if up else "down",
        stereo=_is_stereo(found, series),
        series=series,
        said=tuple(each for each in said if not each.startswith("warning: ")),
    )


def _is_stereo(found: Found, series: Series) -> bool:
    return bool(found.dialect.z) and series.out_of_plane > 0.0


def _lost(number: int, lost: Bool[np.ndarray, "row column"]) -> Lost:
    regions, _ = scipy.ndimage.label(lost)
    rim = np.concatenate([regions[0], regions[-1], regions[:, 0], regions[:, -1]])
    outline = int((lost & np.isin(regions, rim[rim > 0])).sum())
    return Lost(number, outline, int(lost.sum()) - outline)


def mean_gradients(series: Series) -> Float[np.ndarray, "frame 2 2"]:
    """Mean displacement gradient between end lines of every frame, as load steps are chosen by it."""
    return np.stack([[mean_gradient(series, i, J) for J in (0, 1)] for i in (0, 1)]).transpose(2, 0, 1)


def least_ring(series: Series) -> int | None:
    """Fewest outer rings to drop, so that the edges of the rest are measured in most frames. None if none will do."""
    measured = np.mean([np.isfinite(frame.displacement).all(axis=2) for frame in series.frames], axis=0) >= 0.5
    for ring in range((min(measured.shape) - 1) // 2):
        inner = measured[ring : measured.shape[0] - ring, ring : measured.shape[1] - ring]
        if min(line.mean() for line in (inner[0], inner[-1], inner[:, 0], inner[:, -1])) >= LEAST_MEASURED:
            return ring
    return None
