"""Displacements that are equal to the last bit: of no measurement, since noise never repeats."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.ndimage
from jaxtyping import Bool, Float, Int

from hypernode.dic.errors import DicError
from hypernode.dic.series import Frame

#: Share of the points known in two frames from which equal ones make the frames equal; the others were lost in one.
_WHOLE = 0.9
#: Robust standard deviations of what is left of a smooth motion, beyond which a point that stands still does not move
#: with the sheet.
_LEFT_BEHIND = 5.0
#: Pairs of opposite neighbours that tell how a point moves: one in a held end has none but along the end.
_PAIRS = 2
#: Frames on either side of equal ones that tell how far the sheet moves in one step.
_NEIGHBOURS = 3
#: How far beyond one step a jump may be, in further steps, and still be one: half, with room for an uneven motion.
_CLEARLY = (0.35, 0.65)
#: Most copies in a row that the motion explains: a longer row is a camera that stood still, or a sheet that did.
_MOST_IN_A_ROW = 2
#: Scatter about a smooth field over the largest displacement, below which a field is computed and has no noise.
_COMPUTED = 1e-6
#: Motion over its uncertainty from which it tells steps apart.
_TOLD = 5.0
_MAD = 1.4826
Field = Float[np.ndarray, "row column 2"]


@dataclass(frozen=True)
class Copies:
    """Frames without copies.

    Attributes:
        frames: those that are measurements of their own; points that stood still are lost in them.
        inserted: numbers of copies that take no time: the picture after them is the next one.
        findings: sentences on what was found.
    """

    frames: list[Frame]
    inserted: tuple[int, ...] = ()
    findings: tuple[str, ...] = ()


def without_copies(frames: Sequence[Frame], choice: str | None, timed: bool, where: str) -> Copies:
    """Frames of which none repeats another, nor a point its place while the sheet moves on.

    Args:
        frames: in order, the reference first.
        choice: ``inserted`` or ``missed``, where the configuration says what copies are.
        timed: whether files say their times, so that copies shift nothing.
        where: the folder, for messages.

    Raises:
        DicError: whether frames after a copy are later than their numbers cannot be told.
    """
    copy_of: dict[int, int] = {}
    for k in range(1, len(frames)):
        if _equal(frames[k - 1].displacement, frames[k].displacement):
            copy_of[k] = copy_of.get(k - 1, k - 1)
    kept = [k for k in range(len(frames)) if k not in copy_of]
    inserted = () if timed or not copy_of else _inserted(frames, kept, choice, where)
    findings = _said(frames, copy_of, inserted, timed)
    findings += _reference_again(frames)
    cleaned, stuck = [frames[0]], {}
    since = np.zeros(frames[0].displacement.shape[:2], dtype=int)
    for before, k in pairwise(kept):
        u = frames[k].displacement
        since = np.where(_both(frames[before].displacement == u), since, k)
        lost = _left_behind(u, {begin: frames[begin].displacement for begin in np.unique(since[since < k])}, since)
        if lost.any():
            stuck[frames[k].number] = int(lost.sum())
        cleaned.append(replace(frames[k], displacement=np.where(lost[..., None], np.nan, u)))
    if stuck:
        worst = max(stuck, key=stuck.get)
        findings += (
            f"{sum(stuck.values())} displacements in {len(stuck)} frames are zero, or equal to the last bit to those "
            f"of the frame before, while the sheet moves on ({stuck[worst]} of them in frame {worst}): they are no "
            "measurement and count as lost",
        )
    return Copies(cleaned, inserted, findings)


def _both(components: Bool[np.ndarray, "row column 2"]) -> Bool[np.ndarray, "row column"]:
    """Where both components are so."""
    return components[..., 0] & components[..., 1]


def _equal(before: Field, after: Field) -> bool:
    """Whether two frames are one, as far as points are known in both."""
    same = _both(before == after)
    if not same.any():
        return False
    known = _both(np.isfinite(before)) & _both(np.isfinite(after))
    # Sheets without any displacement are the reference again, and no copy of a measurement.
    whole = known.any() and (same & known).sum() >= _WHOLE * known.sum()
    return bool(whole and after[known].any()) and _has_noise(after, known)


def _reference_again(frames: Sequence[Frame]) -> tuple[str, ...]:
    """A sentence where frames without any displacement follow the reference, although others have noise."""
    known = [np.isfinite(frame.displacement) for frame in frames]
    still = [k for k, frame in enumerate(frames) if k and known[k].any() and not frame.displacement[known[k]].any()]
    noisy = [frame for k, frame in enumerate(frames) if k and k not in still and known[k].any()]
    if not still or not any(_has_noise(f.displacement, _both(np.isfinite(f.displacement))) for f in noisy):
        return ()
    return (
        f"frame {frames[still[0]].number} has no displacement at all, as only the reference has: "
        "if the camera or the export repeated the reference, leave that frame out and number those after it anew",
    )


def _has_noise(u: Field, known: Bool[np.ndarray, "row column"]) -> bool:
    found = _smooth(u, known)
    return found is None or bool((found[1] > _COMPUTED * np.abs(u[known]).max()).any())


def _said(frames: Sequence[Frame], copy_of: dict[int, int], inserted: tuple[int, ...], timed: bool) -> tuple[str, ...]:
    if not copy_of:
        return ()
    listed = ", ".join(f"{frames[k].number} (as {frames[origin].number})" for k, origin in copy_of.items())
    later = "the frames after them keep the times of their numbers"
    if timed:
        later = "times are those that the files say"
    elif inserted:
        later = "the sheet moves on from them by one step only: they took no time, and those after them are earlier"
    return (
        f"frames are equal to the last bit to one before, and are not used: {listed}; {later} (repeated_frames says "
        "otherwise)",
    )


def _inserted(frames: Sequence[Frame], kept: list[int], choice: str | None, where: str) -> tuple[int, ...]:
    """Numbers of copies that take no time, as the motion before and after them tells."""
    pairs = list(pairwise(kept))
    moved = {pair: _motion(frames[pair[0]].displacement, frames[pair[1]].displacement) for pair in pairs}
    found: list[int] = []
    for at, (low, high) in enumerate(pairs):
        if high - low == 1:
            continue
        copies = [frames[k].number for k in range(low + 1, high)]
        if choice is not None:
            found += copies if choice == "inserted" else []
            continue
        near = pairs[max(at - _NEIGHBOURS, 0) : at + _NEIGHBOURS + 1]
        single = [moved[pair] for pair in near if pair[1] - pair[0] == 1]
        step = np.median([size for size, _ in single]) if single else 0.0
        jump, error = moved[low, high]
        told = step > _TOLD * error and len(copies) <= _MOST_IN_A_ROW
        further = (jump / step - 1.0) / (high - low - 1) if told else np.nan
        if further <= _CLEARLY[0]:
            found += copies
        elif not further >= _CLEARLY[1]:
            raise DicError(
                f"{where}: frame {copies[0]} is equal to the last bit to frame {frames[low].number}, and the motion "
                "does not tell whether the camera missed a picture or one was inserted: say repeated_frames=missed "
                "where later frames keep the times of their numbers, or repeated_frames=inserted where they are "
                "earlier (--set repeated_frames=...)"
            )
    if choice == "inserted" and kept[-1] < len(frames) - 1:
        found += [frame.number for frame in frames[kept[-1] + 1 :]]
    return tuple(found)


def _basis(shape: tuple[int, int]) -> np.ndarray:
    """Polynomials of third degree at the points of a grid (row, column, term)."""
    y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, size) for size in shape), indexing="ij")
    return np.stack([x**i * y**j for i in range(4) for j in range(4 - i)], axis=-1)


def _smooth(difference: Field, known: Bool[np.ndarray, "row column"]) -> tuple[Field, Float[np.ndarray, " 2"]] | None:
    """(the smooth part of a motion, robust scatter about it by component); None where too few points are known."""
    basis = _basis(difference.shape[:2])
    if known.sum() < 2 * basis.shape[-1]:
        return None
    factor = np.linalg.lstsq(basis[known], difference[known], rcond=None)[0]
    smooth = np.einsum("rct,ta->rca", basis, factor)
    return smooth, _MAD * np.median(np.abs((difference - smooth)[known]), axis=0)


def _motion(before: Field, after: Field) -> tuple[float, float]:
    """(mean size of the smooth motion between two frames, its standard deviation)."""
    difference = after - before
    known = _both(np.isfinite(difference))
    found = _smooth(difference, known)
    if found is None:
        return 0.0, np.inf
    smooth, scatter = found
    terms = _basis(difference.shape[:2]).shape[-1]
    return float(np.sqrt((smooth[known] ** 2).sum(axis=1).mean())), float(
        np.linalg.norm(scatter) * np.sqrt(terms / known.sum())
    )


def _left_behind(
    u: Field, earlier: Mapping[int, Field], since: Int[np.ndarray, "row column"]
) -> Bool[np.ndarray, "row column"]:
    """Points that keep the displacement of a frame before, or have none at all, while those around them move.

    Args:
        u: displacement of a frame.
        earlier: number of a frame before -> its displacement.
        since: number of the frame since which each point stands.
    """
    lost, known = np.zeros(u.shape[:2], dtype=bool), _both(np.isfinite(u))
    # Zero is the reference's displacement, with which a program fills up what it could not find.
    origins = [(field, since == begin) for begin, field in earlier.items()]
    for origin, still in (*origins, (np.zeros_like(u), _both(u == 0.0))):
        still = known & still
        found = _smooth(u - origin, known & ~still & _both(np.isfinite(origin))) if still.any() else None
        if found is not None:
            smooth, scatter = found
            behind = (np.abs(smooth) > _LEFT_BEHIND * scatter + 1e-9 * np.abs(smooth).max()).any(axis=2)
            # A program fails at regions: what hangs together with such a point failed as well, however little it moves.
            regions, _ = scipy.ndimage.label(still, np.ones((3, 3)))
            lost |= still & np.isin(regions, regions[still & behind])
            lost |= still & _unlike_neighbours(np.where((known & ~still)[..., None], u - origin, np.nan))
    return lost


def _unlike_neighbours(moved: Field) -> Bool[np.ndarray, "row column"]:
    """Points between whose neighbours all pairs move, one way in a component, by more than neighbours scatter.

    Args:
        moved: motion of the points that do move, NaN elsewhere.
    """
    padded = np.pad(moved, ((1, 1), (1, 1), (0, 0)), constant_values=np.nan)
    rows, columns = moved.shape[:2]
    places = {(i, j): padded[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i in (-1, 0, 1) for j in (-1, 0, 1)}
    between = np.stack([0.5 * (places[way] + places[-way[0], -way[1]]) for way in ((0, 1), (1, 0), (1, 1), (1, -1))])
    told = np.isfinite(between)
    apart = np.abs(between - moved)[np.isfinite(between - moved).all(axis=-1)]
    if not len(apart):
        return np.zeros((rows, columns), dtype=bool)
    least = _LEFT_BEHIND * _MAD * np.median(apart, axis=0)
    up, down = (np.where(told, way * between, np.inf).min(axis=0) > least for way in (1.0, -1.0))
    return (_both(told.sum(axis=0) >= _PAIRS)) & (up | down).any(axis=2)
