"""Whether machine and sheet speak of one size: crosshead and elongation, force and section, factors that units make."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import LIMITS, Finding, ForceLimits
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import mean_gradient
from hypernode.dic.narrowing import share_of
from hypernode.dic.series import Series
from hypernode.mechanics.loads import BOTH_AXES, tensile_axis

#: Crosshead over elongation beyond which both cannot be of one sheet. Grips that slip, a machine that gives and a field
#: that sees the softer middle of a longer sheet make up to three.
_MORE, _MOST = 3.0, 7.0
#: The same of a field that reaches over so much of the sheet that nothing is softer beside it: twice is grips that lose
#: as much as the sheet gets longer, or frames taken at half the pace.
_WHOLE, _MORE_OF_WHOLE = 0.8, 1.8
#: The same below which the sheet moves more than what pulls it: half for a machine with a part measured on each side.
_LESS, _LEAST = 0.8, 0.3
#: Factors that units and settings make, and how near to one a ratio must be.
_FACTORS = {10.0: "cm for mm, or a setting", 25.4: "inches for mm", 100.0: "percent", 1000.0: "m, mm or micrometres"}
_NEAR = 0.2
#: How near the ratio is to a share or to a per cent of the sheet's side where displacements are of that unit, and how
#: near to one it is of any right sheet. Crosshead and frames tell it within a hundredth.
_SHARE, _ALIKE = 0.01, 0.1
#: The same of forces, and how far a section may be from that of the sheet: a width read off by eye.
_FORCE_FACTORS = {
    **{4.4482: "pounds for N", 9.80665: "kilograms or grams for N", 10.0: "cm for mm"},
    **{100.0: "a setting", 1000.0: "kN, N or mN"},
}
_SECTION = 1.5
#: Least share of its largest motion and of the sheet by which a crosshead moves between two frames that tell.
_LEAST_STRAIN = 1e-3


def crosshead_findings(
    test: SpecimenTest, pull: PullRecord, series: Series, part: Component, sides: tuple[float, float]
) -> list[Finding]:
    """What is strange about the crosshead's way, over a sheet that is pulled along it."""
    courses = _courses(test, pull, series, part)
    if courses is None:
        return []
    side, lines = sides[part[0]], (series.x, series.y)[part[0]]
    whole = (lines[-1] - lines[0]) * series.millimetres(test.pixel_size) >= _WHOLE * side
    found = check_crosshead(*courses, pull.time, pull.displacement, side, whole)
    if test.increments:
        summed = "; increments: true adds displacements up, and these may be since the reference already"
        return [replace(each, sentence=each.sentence + summed) for each in found]
    return found


def crosshead_agrees(
    test: SpecimenTest, pull: PullRecord, series: Series, part: Component, sides: tuple[float, float]
) -> bool:
    """Whether the crosshead moves as the sheet gets longer, within a quarter: frames are then of their times."""
    courses = _courses(test, pull, series, part)
    moved = None if courses is None else _moved(*courses, pull.time, pull.displacement, sides[part[0]])
    return moved is not None and _LESS <= moved[0] / moved[1] <= 1.0 / _LESS


def _courses(test: SpecimenTest, pull: PullRecord, series: Series, part: Component):
    """(mean stretch of the frames that the record reaches, their times); None where the crosshead tells nothing."""
    alone = tensile_axis(test.load) == part[0]
    if pull.displacement is None or part[0] != part[1] or not (alone or test.load in BOTH_AXES):
        return None
    numbers = np.array([frame.number for frame in series.frames])
    stretch = 1.0 + mean_gradient(series, *part)
    seen = np.isfinite(stretch) & pull.reached(numbers)
    if not seen[0] or seen.sum() < 2:
        return None
    return stretch[seen], pull.times(numbers[seen])


def _moved(stretch, time, record_time, displacement, side: float) -> tuple[float, float] | None:
    """(way of the crosshead, what the sheet gets longer) until the largest stretch [mm]; None where neither moves."""
    moved = np.interp(time, record_time, displacement)
    last = int(np.argmax(stretch))
    longer, pulled = side * (stretch[last] - stretch[0]), abs(moved[last] - moved[0])
    return None if longer < _LEAST_STRAIN * side or pulled < _LEAST_STRAIN * longer else (pulled, longer)


def check_crosshead(
    stretch: Float[np.ndarray, " frame"],
    time: Float[np.ndarray, " frame"],
    record_time: Float[np.ndarray, " sample"],
    displacement: Float[np.ndarray, " sample"],
    side: float,
    whole: bool = False,
) -> list[Finding]:
    """The crosshead moves by about what the sheet gets longer.

    Args:
        stretch, time: mean stretch of the frames, and when they were taken [s].
        record_time, displacement: of the crosshead [s, mm].
        side: length of the sheet along the pull [mm].
        whole: whether the field reaches over it.
    """
    both = _moved(stretch, time, record_time, displacement, side)
    if both is None:
        return []
    pulled, longer = both
    ratio = pulled / longer
    share = share_of(side, lambda factor: abs(ratio / factor - 1.0) < _SHARE)
    if _LESS <= ratio <= (_MORE_OF_WHOLE if whole else _MORE) and (share is None or abs(ratio - 1.0) < _ALIKE):
        return []
    refused = not _LEAST <= ratio <= _MOST
    ways = "check the unit of the displacements, pixel_size and the size"
    if refused and (factor := _power_of_ten(ratio)):
        ways = f"--set displacement_factor={factor:g} where displacements are in another unit than positions; {ways}"
        if ratio < 1.0:
            ways = f"the crosshead may be in another unit than its header says, which you may correct; {ways}"
    if share:
        factor, unit = share
        ways = f"--set displacement_factor={factor:g} where displacements are {unit}; {ways}"
    if not refused:
        ways += "; frames may be taken at another pace, --frame-rate, or grips slip"
    sentence = (
        f"the crosshead moves by {pulled:.3g} mm until the largest stretch, and the sheet of {side:.4g} mm gets longer "
        f"by {longer:.3g} mm: a factor of {factor_of(ratio)}; {ways}; or say that the crosshead does not pull the ends "
        "of this sheet, --set crosshead=false"
    )
    return [Finding(sentence, refused)]


def _power_of_ten(ratio: float) -> float | None:
    """The power of ten that a ratio nearly is; None where it is none."""
    power = np.round(np.log10(ratio))
    return float(10.0**power) if power and abs(np.log10(ratio) - power) < np.log10(1.0 + _NEAR) else None


def section_findings(pull: PullRecord, area: float) -> list[Finding]:
    """What is strange about the section by which the record itself divides its force [mm^2]."""
    own = pull.record.section
    if own is None or 1.0 / _SECTION <= own / area <= _SECTION:
        return []
    sentence = (
        f"the record divides its force by a section of {own:.3g} mm2, and that of the sheet is {area:.3g} mm2: a "
        f"factor of {factor_of(own / area, _FORCE_FACTORS)}; check width, thickness and "
        f"the unit of the force, --set force_factor={area / own:.5g} if that is it"
    )
    return [Finding(sentence, False)]


def factor_of(ratio: float, factors: Mapping[float, str] = _FACTORS) -> str:
    """A ratio in words, with the unit that makes it where there is one."""
    large = max(ratio, 1.0 / ratio)
    for factor, why in sorted(factors.items(), key=lambda each: abs(np.log(large / each[0]))):
        if abs(large / factor - 1.0) <= _NEAR:
            return f"{large:.3g}, as {why} would make ({factor:g})"
    return f"{large:.3g}"


def check_stiffness(
    stretch: Float[np.ndarray, " step"],
    force: Float[np.ndarray, " step"],
    area: float,
    numbers,
    limits: ForceLimits = LIMITS,
) -> list[Finding]:
    """The secant stiffness f/(A (s - 1)) of the load steps is that of a sheet.

    Args:
        stretch, force: of the load steps [N].
        area: of the section [mm^2].
        numbers: of their frames, for messages.
        limits: where it is not.
    """
    known = stretch > 1.0
    stretch, force, numbers = stretch[known], force[known], np.asarray(numbers)[known]
    if not len(force):
        return []
    stiffness = force / (area * (stretch - 1.0))
    if (stiffness <= 0.0).any():
        at = int(np.argmin(stiffness))
        return [
            Finding(
                f"the force at frame {numbers[at]}, at the stretch {stretch[at]:.4g}, is {force[at]:.4g} N: a "
                "stretched sheet pulls; check the sign of the record, force_offset, and the clock (first_frame_time, "
                "or picture_shift where pictures are named)",
                True,
            )
        ]
    findings, later = [], stiffness[1:]
    change = later.max() / later.min() if len(later) else 1.0
    if change > limits.stiffening:
        impossible = change > limits.impossible_stiffening
        findings.append(
            Finding(
                f"force per area over stretch less one changes by a factor of {change:.3g} over the load steps beyond "
                f"the first ({later.min():.3g} to {later.max():.3g} MPa), "
                + ("as no sheet does: a unit or a channel is wrong" if impossible else "as very few sheets do"),
                impossible,
            )
        )
    middle = float(np.median(stiffness))
    what = f"a stiffness of {middle:.3g} MPa on {area:.4g} mm2 is that of no sheet"
    if middle < limits.softest:
        findings.append(Finding(f"{what}: is the record in volts, or in kN, --set force_factor=1000?", False))
    elif middle > limits.stiffest:
        findings.append(Finding(f"{what}: is the record in mN, --set force_factor=0.001, or in counts?", False))
    elif middle > limits.flowing and stretch.max() > limits.stretched:
        what += f" that springs back from a stretch of {stretch.max():.3g}"
        units = "in mN (--set force_factor=0.001), in grams (=0.00980665) or in counts"
        findings.append(Finding(f"{what}: is the record {units}, or the thickness off?", False))
    return findings
