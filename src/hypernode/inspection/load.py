"""Which load a test looks like, from mean gradients and from what its end lines do."""

from dataclasses import KW_ONLY, dataclass

import numpy as np
from jaxtyping import Float

from hypernode.dic.series import Series
from hypernode.inspection.ends import Ends, ends_of
from hypernode.inspection.field import mean_gradients

#: Share of the largest mean gradient between outermost points, below which a frame has not the largest one.
_FAR = 0.5
#: Mean strain below which a sheet hardly deforms: no law of a soft material can be told from so little.
LEAST_STRAIN = 1e-3
#: Uncertainties within which a mean gradient is none.
_CHANCE = 3.0
#: Shear over stretch from which both count; at its inverse the stretch no longer does.
_MIXED = 0.5
#: Elongation across over that along the pull from which a sheet is pulled along both.
_PULLED = 0.1
#: Change of length of the end lines over that of the middle, below which something holds them. Free ends have 1, ends
#: next to a clamp 0, and lines further away from it up to 1. In doubt they are held: free ends would say more than is
#: known, that no force acts across.
_HELD = 0.7
#: The same of two ends that are not alike: one is clearly held, the other clearly not.
_CLEARLY = (0.3, 0.9)
#: Scatter of an end line about a straight one, over the elongation between the ends, up to which it is straight.
_STRAIGHT = 0.1
#: Turn of the other side against the shear over it, from which a pull whose columns are swapped looks the same. Sheets
#: that are sheared across less than a third of their width turn by 0.03.
_TURNS = 0.05
#: Change of length of the middle over that along the pull, below which held and free ends look alike: a twentieth of
#: what sheets of constant volume do.
_CONTRACTS = 0.025


@dataclass(frozen=True)
class LoadSeen:
    """What a load looks like.

    Attributes:
        kind: as the configuration calls it; None where nothing can be told.
        reason: why, in one sentence.
        frame: number of the frame that tells.
        gradient: its mean displacement gradient between end lines, NaN where nothing tells it.
        question: what only its owner knows, where other frames look the same; empty where there are none.
    """

    kind: str | None
    reason: str
    frame: int
    gradient: Float[np.ndarray, "2 2"]
    _: KW_ONLY
    question: str = ""

    @property
    def still(self) -> bool:
        """Whether the sheet deforms too little to show a load."""
        return self.kind is None and strain_of(self.gradient) < LEAST_STRAIN


def strain_of(gradient: Float[np.ndarray, "2 2"]) -> float:
    """The largest of both stretches less one and the shear."""
    return float(np.abs([*np.diag(gradient), gradient[0, 1] + gradient[1, 0]]).max())


def recognised(series: Series) -> LoadSeen:
    """Which load a series looks like, by the frame in which its mean gradient is largest.

    Args:
        series: without the points at the outline that cannot be relied on.
    """
    largest, best = -1.0, None
    rough = np.linalg.norm(mean_gradients(series), axis=(1, 2))
    # Most frames are far from the largest, and straight lines need not be fitted in them.
    far = rough < _FAR * np.nanmax(rough, initial=0.0)
    for frame in (each for each, skip in zip(series.frames, far, strict=True) if not skip):
        pair = tuple(ends_of(series.x, series.y, frame.displacement, axis) for axis in (0, 1))
        if None in pair:
            continue
        size = float(np.linalg.norm([each.gradient for each in pair]))
        if size > largest:
            largest, best = size, (frame.number, pair)
    if best is None:
        reason = "in no frame are lines at all four ends measured by half"
        return LoadSeen(None, reason, series.frames[0].number, np.full((2, 2), np.nan))
    number, pair = best
    kind, reason = _kind(pair)
    H = np.stack([each.gradient for each in pair], axis=1)
    return LoadSeen(kind, reason, number, H, question=_swapped(H, kind))


def _swapped(H: Float[np.ndarray, "2 2"], kind: str | None) -> str:
    """A question where a pull whose columns are swapped looks the same: its narrowing turns the other side."""
    stretch, (one, other) = np.abs(np.diag(H)).max(), sorted((H[0, 1], H[1, 0]), key=abs)
    if kind not in ("shear", "general") or abs(one + other) * _MIXED <= stretch or other == 0.0:
        return ""
    if -_TURNS < one / other < _PULLED:
        return ""
    axes = "[y, x]" if other > 0.0 else "[-y, -x]"
    return (
        f"it looks like {kind}, and would be pulled to a stretch of {1.0 + abs(other):.3f} if u and v were swapped: "
        f"--set 'displacement_axes={axes}' swaps them, and --load {kind} says that they are right"
    )


def _kind(pair: tuple[Ends, Ends]) -> tuple[str | None, str]:
    H = np.stack([each.gradient for each in pair], axis=1)
    shear, stretch = H[0, 1] + H[1, 0], np.diag(H)
    least = max(LEAST_STRAIN, _CHANCE * max(float(each.uncertainty.max()) for each in pair))
    if strain_of(H) < least:
        size = f"its largest mean strain is {strain_of(H):.2g}"
        if least > LEAST_STRAIN:
            return None, f"end lines scatter by more than the sheet deforms: {size}, known to {least / _CHANCE:.2g}"
        other = "or displacements are in another unit than positions, displacement_factor"
        return None, f"the sheet hardly deforms: {size}; {other}"
    if abs(shear) * _MIXED > np.abs(stretch).max():
        return _sheared(H, shear)
    if stretch.max() <= 0.0:
        axes = "[-x, y]" if stretch[0] < stretch[1] else "[x, -y]"
        return None, (
            f"the sheet gets shorter, by {-stretch[0]:.1%} along x and {-stretch[1]:.1%} along y: the first frame must "
            "be that of the sheet without force, and displacements must point as positions do, else --set "
            f"'displacement_axes={axes}'"
        )
    if abs(shear) > _MIXED * stretch.max():
        return "general", f"it is sheared by {shear:.3f} and stretched by {stretch.max():.3f} at once"
    axis = int(np.argmax(stretch))
    ratio = stretch[1 - axis] / stretch[axis]
    if ratio < -1.0:
        name, other = "xy"[axis], "yx"[axis]
        return "general", (
            f"it gets shorter along {other} by more than it gets longer along {name}: if it is pulled along {other}, "
            "the first frame is not the sheet without force, or displacements point the other way (displacement_axes)"
        )
    return _pulled_twice(pair, stretch) if ratio > _PULLED else _pulled_once(pair[axis], axis, stretch[axis])


def _sheared(H: Float[np.ndarray, "2 2"], shear: float) -> tuple[str, str]:
    if abs(H[0, 1]) * _MIXED > abs(H[1, 0]):
        return "shear", f"the upper end moves along x by {H[0, 1]:.3f} of the distance of the ends, and hardly along y"
    if abs(H[1, 0]) * _MIXED > abs(H[0, 1]):
        return "general", (
            f"the right end moves along y by {H[1, 0]:.3f} of the distance of the ends: shear has a name where the "
            "upper end moves along x; turn the pictures, or go on with general"
        )
    return "general", f"it is sheared by {shear:.3f} along both axes alike"


def _held(ends: Ends) -> Float[np.ndarray, " 2"]:
    """Change of length of each end line over that of the middle."""
    return ends.across / ends.middle


def _pulled_once(ends: Ends, axis: int, stretch: float) -> tuple[str, str]:
    name, extension = "xy"[axis], stretch * ends.distance
    pulled = f"pulled along {name} to a mean stretch of {1.0 + stretch:.3f}"
    bend = ends.bend / extension
    if bend > _STRAIGHT:
        return (
            "general",
            f"{pulled}, and its end lines bend by {bend:.0%} of the extension: nothing holds them straight",
        )
    straight = f"end lines straight within {bend:.1%} of the extension"
    if abs(ends.middle) < max(_CONTRACTS * stretch, _CHANCE * ends.middle_uncertainty):
        return f"clamped_{name}", (
            f"{pulled}, {straight}; its middle hardly contracts, so that held and free ends look alike, and held ones "
            "are the safe choice"
        )
    low, high = sorted(_held(ends))
    changes = f"middle {_changed(ends.middle)} across, ends {_changed(float(np.mean(ends.across)))}"
    if low < _CLEARLY[0] and high > _CLEARLY[1]:
        return "general", f"{pulled}, {straight}, {changes}: one end is held across and the other is not"
    if 0.5 * (low + high) < _HELD:
        return f"clamped_{name}", f"{pulled}, {straight}, {changes}: something holds the ends"
    return f"uniaxial_{name}", f"{pulled}, {straight}, {changes}: nothing holds the ends across"


def _pulled_twice(pair: tuple[Ends, Ends], stretch: np.ndarray) -> tuple[str, str]:
    pulled = f"pulled along x and y to mean stretches of {1.0 + stretch[0]:.3f} and {1.0 + stretch[1]:.3f}"
    shares = [float(np.mean(_held(ends))) for ends in pair]
    ends = f"end lines get longer by {shares[0]:.0%} and {shares[1]:.0%} of what the middle between them does"
    if max(shares) < _HELD:
        return "biaxial_clamped", f"{pulled}, {ends}: something holds them"
    return "biaxial", f"{pulled}, {ends}: they go with the sheet"


def _changed(slope: float) -> str:
    return f"{'shorter' if slope < 0 else 'longer'} by {abs(slope):.1%}"
