"""When each picture was taken, in the clock of the force record."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.series import Series


@dataclass(frozen=True)
class FrameClock:
    """Times of frames by their numbers, linear between those that are known and beyond them.

    Attributes:
        number: of two or more frames, increasing.
        time: of each [s].
    """

    number: Float[np.ndarray, " known"]
    time: Float[np.ndarray, " known"]

    def at(self, numbers) -> Float[np.ndarray, " frame"]:
        """Times of frames [s]; NaN where there is no number."""
        numbers = np.asarray(numbers, dtype=float)
        place = np.clip(np.searchsorted(self.number, numbers, side="right") - 1, 0, len(self.number) - 2)
        pace = (self.time[place + 1] - self.time[place]) / (self.number[place + 1] - self.number[place])
        return self.time[place] + (numbers - self.number[place]) * pace

    @property
    def interval(self) -> float:
        """Usual time between two frames [s]."""
        return float(np.median(np.diff(self.time) / np.diff(self.number)))

    def later(self, seconds: float) -> "FrameClock":
        """The same frames so much later."""
        return FrameClock(self.number, self.time + seconds)


def frame_clock(test: SpecimenTest, series: Series) -> FrameClock | None:
    """The times of a test's frames by its frame rate, else as the files say them; None where neither does.

    ``first_frame_time`` and a given offset of the record's clock are added.
    """
    given = test.force_time_offset
    later = test.first_frame_time + (given if isinstance(given, float) else 0.0)
    first = series.frames[0].number
    if test.frame_rate is not None:
        # Linear but for the pictures that took no time.
        ends = (first, max(series.frames[-1].number, first + 1) + 1)
        numbers = np.unique([*ends, *(n - back for n in series.inserted for back in (0, 1))]).astype(float)
        taken = numbers - first - np.searchsorted(series.inserted, numbers, side="right")
        return FrameClock(numbers, later + taken / test.frame_rate)
    said = _said(series)
    return said and said.later(later)


def _said(series: Series) -> FrameClock | None:
    """The times that the files say; None where fewer than two do, or they do not increase."""
    known = [(frame.number, frame.time) for frame in series.frames if frame.time is not None]
    if len(known) < 2 or not (np.diff([time for _, time in known]) > 0.0).all():
        return None
    number, time = map(np.array, zip(*known, strict=True))
    return FrameClock(number.astype(float), time.astype(float))


def times_contradicted(test: SpecimenTest, series: Series) -> str:
    """A sentence if the frame rate and the files differ by more than a frame. Empty if they agree."""
    said = _said(series)
    if test.frame_rate is None or said is None:
        return ""
    numbers = said.number[[0, -1]]
    by_rate, by_files = float(np.ptp(numbers)) / test.frame_rate, float(np.ptp(said.at(numbers)))
    if abs(by_files - by_rate) <= by_files / np.ptp(numbers):
        return ""
    return (
        f"frame_rate = {test.frame_rate:g} takes frame {numbers[1]:g} for {by_rate:.4g} s after frame {numbers[0]:g}, "
        f"and the files say {by_files:.4g} s ({said.time[0]:.4g} to {said.time[-1]:.4g} s): leave frame_rate out if "
        "they are right"
    )
