"""How well forces and pictures are paired: what lag of their clocks the curve of force and stretch leaves open."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import first_loading, working_stretch
from hypernode.dic.series import Series

#: Share of the largest elongation from which a frame is one of the pull.
_BEGUN = 0.02
#: Fewest frames that tell a curve, and how many of its begin are fitted at least.
_FEWEST, _BEGIN = 5, 6
#: Slope at the begin over the mean one, below which the curve has a toe, and its begin says little.
_TOE = 0.2
#: Least lag in frames, and in standard deviations, that is said.
_SAID, _DEVIATIONS = 0.25, 4.0
#: Largest lag in frames that the curve tells: clocks that are further apart show otherwise, and the curve of a sheet
#: that yields at once begins nowhere.
_FARTHEST = 5.0
#: Uncertainty of a lag that nothing tells, in frames: anywhere within one.
_UNTOLD = 1.0 / np.sqrt(12.0)
#: Smallest uncertainty in frames: shutters and recorders have their own delays.
_LEAST = 0.01
#: Change of the force since the first frame over the largest, below which it has not begun. Load cells of class 1 and
#: their noise stay within it.
STANDS = 0.02
#: Times that a curve is fitted: the second time from where the first one has it begin.
_TURNS = 2


@dataclass(frozen=True, kw_only=True)
class Pairing:
    """What is known of the lag between the clocks.

    Attributes:
        seconds: by which the record is late, as the curve has it; 0 where it tells none, or where it is given.
        uncertainty: its standard deviation [s].
        interval: between frames [s]; of a record that only numbers its pictures, that of their numbers.
        named: whether the record names the pictures.
        zero: what the curve has at rest, which a load cell's zero that is off would make as well [N].
        with_crosshead: whether the crosshead begins to move with the sheet, as the curve of both shows it. A force that
            begins before is no lag then, but a sheet that relaxes or bends.
    """

    seconds: float
    uncertainty: float
    interval: float
    named: bool
    zero: float
    with_crosshead: bool = False

    def told(self, deviations: float) -> bool:
        """Whether the lag is some standard deviations and a part of a frame, and no matter of the sheet."""
        frames = self.seconds / self.interval
        if abs(frames) < _SAID or abs(self.seconds) < deviations * self.uncertainty:
            return False
        return not (self.with_crosshead and frames < 0.0)

    @property
    def findings(self) -> list[Finding]:
        """A sentence where the forces seem to be those of other frames."""
        if not self.told(_DEVIATIONS):
            return []
        frames = self.seconds / self.interval
        way = "later" if frames > 0.0 else "earlier"
        key, other = "force_time_offset", f"{self.seconds:.3g}"
        if self.named:
            key, other = "picture_shift", f"{frames:.0f}"
        sentence = (
            f"the force begins {abs(frames):.2g} frames {way} than the stretch, if its curve is as smooth from rest on "
            f"as it is later: forces may be those of other frames. --set {key}={other} takes them so; --set {key}=0 "
            f"says that they are right, as where a material is soft at first. Or the load cell is {self.zero:.3g} N "
            "off zero: force_offset takes that much more"
        )
        return [Finding(sentence, False)]

    def relative(self, pull: PullRecord, numbers: Int[np.ndarray, " step"]) -> Float[np.ndarray, " step"]:
        """Uncertainty of the force of frames over its size: the rate of the force times what the lag may be."""
        time, force, half = pull.times(numbers), pull.forces(numbers), 0.5 * self.interval
        known, at = np.unique(pull.time, return_index=True)
        near = [np.interp(time + way, known, pull.force[at]) for way in (-half, half)]
        rate = np.max(np.abs(np.array(near) - force), axis=0) / half
        lag = np.hypot(self.seconds, self.uncertainty)
        return np.minimum(rate * lag / np.maximum(np.abs(force), np.finfo(float).tiny), 1.0)


def pairing_of(test: SpecimenTest, pull: PullRecord, series: Series, part: Component) -> Pairing:
    """The pairing of a record with the frames of the first loading.

    A force belongs to its frame where the curve of both, of second degree over its begin, goes through zero. What a
    third degree would say otherwise is its uncertainty, with the scatter about it. Where too few frames tell, a clock
    is anywhere within a frame, and names of pictures are right.
    """
    numbers, course = first_loading(series, working_stretch(series, test.load, *part))
    told = pull.reached(numbers)
    numbers, strain = numbers[told], course[told] - 1.0
    time = pull.times(numbers)
    interval = float(np.median(np.diff(time))) if len(time) > 1 else 1.0
    lag = _of_curve(strain, time, pull.forces(numbers)) if len(numbers) else None
    named = pull.image is not None
    if lag is None or abs(lag[0]) > _FARTHEST * interval:
        return Pairing(
            seconds=0.0, uncertainty=0.0 if named else _UNTOLD * interval, interval=interval, named=named, zero=0.0
        )
    given = test.picture_shift is not None if named else test.force_time_offset not in (None, "estimate")
    together = False
    if pull.displacement is not None and not named:
        way = _of_curve(strain, time, np.interp(time, pull.time, np.abs(pull.displacement - pull.displacement[0])))
        together = way is not None and max(abs(way[0]), way[1]) < _SAID * interval
    return Pairing(
        seconds=0.0 if given else lag[0],
        uncertainty=max(lag[1], _LEAST * interval),
        interval=interval,
        named=named,
        zero=lag[2],
        with_crosshead=together,
    )


def _of_curve(strain, time, force) -> tuple[float, float, float] | None:
    """(lag of the force [s], its standard deviation, the force at rest) as its curve over the strain has it.

    Frames in which the force has not begun are not of its curve.
    """
    pulled = (strain >= _BEGUN * strain.max(initial=0.0)) & (force - force[0] > STANDS * np.abs(force).max())
    count = max(_BEGIN, int((strain[pulled] <= 0.5 * strain.max(initial=0.0)).sum()))
    strain, time, force = (each[pulled][:count] for each in (strain, time, force))
    if len(strain) < _FEWEST or time[-1] <= time[0] or strain[-1] <= strain[0]:
        return None
    at = strain / strain.max()
    pace, begin = (at[-1] - at[0]) / (time[-1] - time[0]), 0.0
    for _ in range(_TURNS):
        at_begin, error, rate, at_rest = _begin(at, force, begin)
        late = begin - at_begin / rate
        # A curve that begins late is carried on to there, and no further.
        begin = max(late, 0.0)
    return (late / pace, error / rate / pace, at_rest) if rate > 0.0 else None


def _begin(at, force, begin: float) -> tuple[float, float, float, float]:
    """(force where a curve begins, its standard deviation, its rate there, force at rest), by shares of the strain."""
    matrix = np.vander(at - begin, 4, increasing=True)
    usual, fuller = (np.linalg.lstsq(matrix[:, :terms], force, rcond=None)[0] for terms in (3, 4))
    rest = force - matrix[:, :3] @ usual
    scatter = np.sqrt((rest @ rest) / (len(at) - 3) * np.linalg.pinv(matrix[:, :3].T @ matrix[:, :3])[0, 0])
    at_rest = usual @ np.vander([-begin], 3, increasing=True)[0]
    return (
        float(usual[0]),
        float(np.hypot(fuller[0] - usual[0], scatter)),
        max(usual[1], _TOE * force[-1]),
        float(at_rest),
    )
