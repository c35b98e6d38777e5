"""Which force belongs to which frame: by the number of the picture where the record has it, else by time."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import ForceRecord
from hypernode.dic.frame_clock import FrameClock

#: Share of the time between two frames by which clocks that are rounded may miss the ends of a record.
_ROUNDED = 0.02


@dataclass(frozen=True)
class Silence:
    """Times [s] between which a record says nothing of the force.

    Attributes:
        begin, end: of it; a frame at its begin is not in it.
        why: in words.
        closed: whether a frame at its end is in it.
    """

    begin: float
    end: float
    why: str
    closed: bool = False

    def holds(self, time: float, rounded: float) -> bool:
        """Whether a time is in it, and not next to a sample that tells the force."""
        return self.begin + rounded < time and (time <= self.end if self.closed else time < self.end - rounded)


@dataclass(frozen=True, kw_only=True)
class PullRecord:
    """The record of one force, with the clock of its frames.

    Attributes:
        record: what the machine wrote.
        time: of every sample, increasing where samples of one time were averaged [s]; of a record without a clock, that
            of its pictures.
        force: of every sample along the pull, without what it reads before the sheet pulls [N].
        displacement: of the crosshead [mm]; None where it is not recorded.
        image: number of the picture of every sample, NaN where there is none; None where it is not recorded.
        clock: when each frame was taken; None where nothing tells.
        silences: when it says nothing.
        preload: mean strain that the sheet has in its first picture, as far as forces were taken for it.
    """

    record: ForceRecord
    time: Float[np.ndarray, " sample"]
    force: Float[np.ndarray, " sample"]
    displacement: Float[np.ndarray, " sample"] | None
    image: Float[np.ndarray, " sample"] | None
    clock: FrameClock | None
    silences: tuple[Silence, ...] = ()
    preload: float = 0.0

    @property
    def rounded(self) -> float:
        """Seconds within which a frame and a sample are of one time."""
        return 0.0 if self.clock is None else _ROUNDED * self.clock.interval

    def times(self, numbers: Int[np.ndarray, " frame"]) -> Float[np.ndarray, " frame"]:
        """Time [s] of frames in the clock of the record.

        Raises:
            DicError: the record numbers its pictures, and one of these is not among them; or nothing tells the time.
        """
        if self.image is None:
            if self.clock is None:
                raise DicError(
                    f"{self.record.path}: neither does it name the pictures, nor do the frames say their times: give "
                    "frame_rate, the number of frames in a second"
                )
            return self.clock.at(numbers)
        return self._of_pictures(self.time, numbers)

    def forces(self, numbers: Int[np.ndarray, " frame"]) -> Float[np.ndarray, " frame"]:
        """Force [N] of frames: the mean of a picture's samples, or interpolated at the frame's time.

        Raises:
            DicError: a frame lies outside the record.
        """
        if self.image is not None:
            return self._of_pictures(self.force, numbers)
        path, time = self.record.path, self.times(numbers)
        late = time > self.time[-1] + self.rounded
        if late.any():
            raise DicError(
                f"{path}: ends at {self.time[-1]:g} s, before frame {numbers[late][0]} at "
                f"{time[late][0]:g} s: check frame_rate and first_frame_time"
            )
        early = time < self.time[0] - self.rounded
        if early.any():
            raise DicError(
                f"{path}: begins at {self.time[0]:.15g} s, after frame {numbers[early][0]} at {time[early][0]:g} s: "
                "set first_frame_time to the time of the first frame in the clock of the record, --set "
                f"first_frame_time={self.time[0]:.15g} where both begin at once"
            )
        return np.interp(time, self.time, self.force)

    def reached(self, numbers: Int[np.ndarray, " frame"]) -> np.ndarray:
        """Which frames lie within the record, and not where it is silent."""
        told = ~np.isin(numbers, list(self.unheard(numbers)))
        if self.image is not None:
            return told & np.isin(numbers, self.image)
        time = self.times(numbers)
        return (time >= self.time[0] - self.rounded) & (time <= self.time[-1] + self.rounded) & told

    def unheard(self, numbers: Int[np.ndarray, " frame"]) -> dict[int, str]:
        """Number of each frame that was taken while the record is silent -> why it is."""
        if not self.silences:
            return {}
        if self.image is not None:
            numbers = np.asarray(numbers)[np.isin(numbers, self.image)]
        found = {}
        for number, time in zip(numbers, self.times(numbers), strict=True):
            why = next((each.why for each in self.silences if each.holds(time, self.rounded)), None)
            if why:
                found[int(number)] = why
        return found

    def _of_pictures(self, values, numbers):
        """Means of the samples of each picture."""
        means = []
        for number in numbers:
            at = self.image == number
            if not at.any():
                known = self.image[np.isfinite(self.image)]
                extent = f"it has {known.min():g} to {known.max():g}" if len(known) else "it numbers none"
                raise DicError(
                    f"{self.record.path}: no sample of picture {number}; {extent}: where pictures are counted "
                    "otherwise than frames, --set picture_shift=N says what their numbers are more than those of the "
                    "frames; else choose others, --set 'frames=[...]'"
                )
            means.append(values[at].mean())
        return np.array(means)


#: Component (i, J) of a resultant: the force along i across the sections whose normal is J.
Component = tuple[int, int]


def pulls_of(
    test: SpecimenTest,
    record: ForceRecord,
    parts: Iterable[Component],
    clock: FrameClock | None,
    numbers: list[int],
) -> dict[Component, PullRecord]:
    """The parts of a test's record that belong to its forces, in the clock of the frames and by their ``numbers``."""
    record = replace(record, image=_shifted(test, record, numbers))
    if test.force_factor != 1.0:
        section = None if record.section is None else record.section * abs(test.force_factor)
        record = replace(record, force=record.force * test.force_factor, section=section)
    axes = {part: "xy"[part[0]] for part in parts}
    if not test.crosshead:
        record = replace(record, displacement=None)
    return {part: pull_record(record, axis, test.force_zero(axis), clock) for part, axis in axes.items()}


def shift_of(test: SpecimenTest, record: ForceRecord, numbers: list[int]) -> int:
    """What the numbers of a record's pictures are more than those of their frames.

    It is given, or one for which every picture has its frame and every frame its picture, and zero otherwise.
    """
    if test.picture_shift is not None or record.image is None:
        return test.picture_shift or 0
    pictures = np.unique(record.image[np.isfinite(record.image)])
    if len(pictures) != len(numbers) or np.isin(numbers, pictures).all():
        return 0
    apart = pictures - np.sort(numbers)
    return int(apart[0]) if (apart == apart[0]).all() else 0


def counted_otherwise(shift: int) -> str:
    """A sentence on a shift that was found."""
    return (
        f"the record counts its pictures by {shift:+d} otherwise than the frames are numbered, and has as many: they "
        f"are taken in their order, --set picture_shift={shift}; --set picture_shift=0 takes the numbers as they are"
    )


def _shifted(test: SpecimenTest, record: ForceRecord, numbers: list[int]) -> Float[np.ndarray, " sample"] | None:
    return None if record.image is None else record.image - shift_of(test, record, numbers)


def best_told(pulls: dict[Component, PullRecord]) -> Component:
    """The force that tells the clock best: the largest."""
    return max(pulls, key=lambda part: np.ptp(pulls[part].force))


def pull_record(record: ForceRecord, axis: str, force_offset: float, clock: FrameClock | None) -> PullRecord:
    """The part of a record that belongs to one force.

    Args:
        record: what the machine wrote.
        axis: along which the force acts, "x" or "y".
        force_offset: what the record reads before the sheet pulls [N].
        clock: when each frame was taken; None where nothing tells.
    """
    column = record.column(axis)
    time, image = record.time, record.image
    if time is None:
        # Neither the record nor the frames need know of time where pictures are numbered: it then counts them.
        time = image if clock is None else clock.at(image)
    columns = [time, record.force[:, column] - force_offset]
    if record.displacement is not None:
        columns.append(record.displacement[:, column])
    if image is None:
        columns = _averaged(columns)
    displacement = columns[2] if len(columns) == 3 else None
    return PullRecord(
        record=record, time=columns[0], force=columns[1], displacement=displacement, image=image, clock=clock
    )


def _averaged(columns: list[np.ndarray]) -> list[np.ndarray]:
    """The columns with samples of one time, the first column, made one; as they are where no time repeats."""
    time, place, count = np.unique(columns[0], return_inverse=True, return_counts=True)
    if len(time) == len(columns[0]):
        return columns
    return [time, *(np.bincount(place, each) / count for each in columns[1:])]
