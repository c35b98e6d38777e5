"""Whether displacements are in the unit of the positions: a sheet that is pulled narrows by less and less."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.optimize
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.frames import first_loading, mean_gradient
from hypernode.dic.series import Series
from hypernode.mechanics.loads import tensile_axis

#: Share of the lines across the pull that count as the middle, away from what holds the ends.
_MIDDLE = 1.0 / 3.0
#: Fewest frames of a curve, and least narrowing over elongation of a sheet whose sides are free.
_FEWEST, _FREE = 5, 0.15
#: Strain by which a factor is told wrong. Rubber, gels, printed sheets and notched ones lie between 0.4 and 1.2; a
#: Poisson ratio that falls from a half to a fifth over a strain of 0.3 has 2.5. One that rises has a negative one.
_TOO_SMALL, _TOO_LARGE = 3.0, 1.0 / 5.0
#: Standard deviations by which it is told.
_DEVIATIONS = 4.0
#: Bend of the curve in strain from which it is one. A sheet that moves by 0.3 mm towards a camera at a distance of one
#: metre seems to grow by as much.
_BEND = 3e-4
#: Elongation from which a curve without a bend is none of a sheet.
_LONG = 0.5
#: The same strains of right sheets: notched ones have the least, held ones with stiff inclusions the largest.
_SHEETS = (0.4, 1.6)
#: What counts as less than these where it is that of per cent of a side, and the elongation from which it tells.
_STRAIGHT, _TOLD = 0.35, 0.3


@dataclass(frozen=True)
class Scale:
    """By which factor displacements seem to be wrong.

    Attributes:
        factor: true elongation over that of the frames, as the curve of the narrowing has it.
        uncertainty: its standard deviation.
        elongation: the largest one of the frames.
        bend: what the curve falls behind a straight line there.
    """

    factor: float
    uncertainty: float
    elongation: float
    bend: float

    @property
    def wrong(self) -> bool:
        """Whether no sheet has such a curve."""
        least, most = (self.factor + way * _DEVIATIONS * self.uncertainty for way in (-1.0, 1.0))
        if least > _TOO_SMALL:
            return self.bend > _BEND
        return least > 0.0 and most < _TOO_LARGE and self.elongation > _LONG

    def is_of(self, factor: float) -> bool:
        """Whether this is the curve of displacements that have to be multiplied by a factor, and of no right ones."""
        error = _DEVIATIONS * self.uncertainty
        if not _SHEETS[0] < self.factor / factor < _SHEETS[1]:
            return False
        if factor > 1.0:
            return self.factor - error > 2.0 * _SHEETS[1] and self.bend > _BEND
        return self.factor + error < _STRAIGHT and self.elongation > _TOLD


def share_of(side: float | None, is_factor: Callable[[float], bool]) -> tuple[float, str] | None:
    """(factor, words) of displacements that are shares or per cent of a side [mm]; None where it is neither."""
    for factor, what in () if side is None else ((side / 100.0, "per cent"), (side, "shares")):
        if is_factor(factor):
            return float(f"{factor:.4g}"), f"{what} of the {side:.4g} mm of the sheet"
    return None


def scale_of(elongation: Float[np.ndarray, " frame"], narrowing: Float[np.ndarray, " frame"]) -> Scale | None:
    """The factor q between true elongations and those of the frames, from c = (1 - (1 + q e)^-n) / q.

    A sheet of a constant Hencky's Poisson ratio n narrows so, whatever its stiffness. Only the unit of the
    displacements enters q: length of a pixel and size of the sheet cancel.

    Args:
        elongation: e of the frames, the reference first.
        narrowing: c of the same frames, positive where the sheet gets narrower.

    Returns:
        None where too few frames tell, or the sides are held.
    """
    known = np.isfinite(elongation) & np.isfinite(narrowing) & (elongation > 0.0)
    e, c = elongation[known], narrowing[known]
    if len(e) < _FEWEST:
        return None
    slope, curvature = np.linalg.lstsq(np.stack([e, e**2], axis=1), c, rcond=None)[0]
    if slope < _FREE:
        return None
    begin = np.array([slope, -2.0 * curvature / (slope * (slope + 1.0))])
    # Scaled, so that both unknowns are of order one.
    size = np.array([1.0, 1.0 / e.max()])
    # The curve exists as long as no elongation shortens the sheet to nothing.
    floor = np.array([0.0, -0.9])
    start = np.clip(begin / size, floor + 1e-6, None)

    def miss(unknown):
        n, q = unknown * size
        return (-np.expm1(-n * np.log1p(q * e)) / q if abs(q) * e.max() > 1e-9 else n * e) - c

    found = scipy.optimize.least_squares(miss, start, bounds=(floor, np.inf))
    variance = 2.0 * found.cost / (len(e) - 2)
    spread = np.sqrt(np.clip(variance * np.linalg.pinv(found.jac.T @ found.jac)[1, 1], 0.0, None))
    n, q = found.x * size
    return Scale(float(q), float(spread * size[1]), float(e.max()), float(n * e.max() - c[np.argmax(e)]))


def narrowing_of(series: Series, axis: int) -> tuple[Float[np.ndarray, " frame"], Float[np.ndarray, " frame"]]:
    """(mean elongation along an axis, narrowing of the middle across it) of every frame; NaN where it is lost."""
    lines = (series.x, series.y)
    count = len(lines[axis])
    edge = int((1.0 - _MIDDLE) / 2.0 * count)
    narrowing = []
    for frame in series.frames:
        u = frame.displacement[..., 1 - axis]
        u = (u if axis == 1 else u.T)[edge : count - edge]
        at = np.broadcast_to(lines[1 - axis], u.shape)
        known = np.isfinite(u)
        enough = known.mean() > 0.5 and len(np.unique(at[known])) > 1
        narrowing.append(-np.polyfit(at[known], u[known], 1)[0] if enough else np.nan)
    return mean_gradient(series, axis, axis), np.array(narrowing)


def unlike_positions(test: SpecimenTest, series: Series, side: float | None = None) -> str:
    """A sentence where displacements seem to be in another unit than positions; empty where they do not.

    A sheet that is pulled along one axis tells it, and none that is held or pulled across.

    Args:
        test: with its load.
        series: the frames.
        side: length of the sheet along the pull [mm], of which displacements may be shares or per cent.
    """
    axis = tensile_axis(test.load)
    if axis is None or test.displacement_factor is not None:
        return ""
    elongation, narrowing = narrowing_of(series, axis)
    numbers, _ = first_loading(series, 1.0 + elongation)
    pulled = np.isin([frame.number for frame in series.frames], numbers)
    scale = scale_of(elongation[pulled], narrowing[pulled])
    share = None if scale is None else share_of(side if series.unit == "mm" else None, scale.is_of)
    if scale is None or not (scale.wrong or share):
        return ""
    ways = [share] if share else []
    power = 10.0 ** np.round(np.log10(scale.factor))
    if scale.wrong and power != 1.0:
        ways.insert(0, (power, "another unit than positions"))
    told = "; or in ".join(f"{unit}, --set displacement_factor={factor:g} multiplies them" for factor, unit in ways)
    way = "bends as it does" if scale.factor > 1.0 else "is as straight"
    return (
        f"the sheet seems to be pulled to a strain of {scale.elongation:.3g}, and its narrowing {way} in one that is "
        f"pulled {scale.factor:.2g} times as far: displacements may be in {told}; --set displacement_factor=1 says "
        "that they are right"
    )
