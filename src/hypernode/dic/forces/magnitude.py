"""Whether machine and sheet speak of one size: the crosshead against the elongation, and factors that units make."""

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.checks import Finding
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import mean_gradient
from hypernode.dic.series import Series
from hypernode.mechanics.loads import tensile_axis

#: Crosshead over elongation beyond which both cannot be of one sheet. Grips that slip, a machine that gives and a field
#: that sees the softer middle of a longer sheet make up to three.
_MORE, _MOST = 3.0, 7.0
#: The same below which the sheet moves more than what pulls it: half for a machine with a part measured on each side.
_LESS, _LEAST = 0.8, 0.3
#: Factors that units and settings make, and how near to one a ratio must be.
_FACTORS = {10.0: "cm for mm, or a setting", 25.4: "inches for mm", 100.0: "percent", 1000.0: "m, mm or micrometres"}
_NEAR = 0.2
#: Least share of its largest motion and of the sheet by which a crosshead moves between two frames that tell.
_LEAST_STRAIN = 1e-3


def crosshead_findings(
    test: SpecimenTest, pull: PullRecord, series: Series, part: Component, sides: tuple[float, float]
) -> list[Finding]:
    """What is strange about the crosshead's way, over a sheet that is pulled along it."""
    if pull.displacement is None or tensile_axis(test.load) != part[0] or part[0] != part[1]:
        return []
    numbers = np.array([frame.number for frame in series.frames])
    stretch = 1.0 + mean_gradient(series, *part)
    seen = np.isfinite(stretch) & pull.reached(numbers)
    if not seen[0] or seen.sum() < 2:
        return []
    time = pull.times(numbers[seen])
    return check_crosshead(stretch[seen], time, pull.time, pull.displacement, sides[part[0]])


def check_crosshead(
    stretch: Float[np.ndarray, " frame"],
    time: Float[np.ndarray, " frame"],
    record_time: Float[np.ndarray, " sample"],
    displacement: Float[np.ndarray, " sample"],
    side: float,
) -> list[Finding]:
    """The crosshead moves by about what the sheet gets longer.

    Args:
        stretch, time: mean stretch of the frames, and when they were taken [s].
        record_time, displacement: of the crosshead [s, mm].
        side: length of the sheet along the pull [mm].
    """
    moved = np.interp(time, record_time, displacement)
    first, last = 0, int(np.argmax(stretch))
    longer, pulled = side * (stretch[last] - stretch[first]), abs(moved[last] - moved[first])
    if longer < _LEAST_STRAIN * side or pulled < _LEAST_STRAIN * longer:
        return []
    ratio = pulled / longer
    if _LESS <= ratio <= _MORE:
        return []
    refused = not _LEAST <= ratio <= _MOST
    sentence = (
        f"the crosshead moves by {pulled:.3g} mm until the largest stretch, and the sheet of {side:.4g} mm gets longer "
        f"by {longer:.3g} mm: a factor of {factor_of(ratio)}; check the unit of the displacements, pixel_size and the "
        "size, or say that the crosshead does not pull the ends of this sheet, --set crosshead=false"
    )
    return [Finding(sentence, refused)]


def factor_of(ratio: float) -> str:
    """A ratio in words, with the unit that makes it where there is one."""
    large = max(ratio, 1.0 / ratio)
    for factor, why in _FACTORS.items():
        if abs(large / factor - 1.0) <= _NEAR:
            return f"{large:.3g}, as {why} would make ({factor:g})"
    return f"{large:.3g}"
