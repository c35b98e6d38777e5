"""Displacements from frame to frame: added up on request, and told by the force where nobody says so."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from hypernode.dic.errors import DicError
from hypernode.dic.forces.matching import PullRecord
from hypernode.dic.series import Frame

#: Fewest frames near the largest strain whose forces tell increments from displacements.
_FEWEST = 4
#: Share of the largest strain from which a strain is near it.
_NEAR = 0.8
#: Rise of the force among those, over the largest force, which no law has at nearly one strain.
_RISE = 0.4
#: Way of the force up and down over its rise, up to which it does nothing but rise.
_RISES_ONLY = 1.2
#: How much longer that way is in the order of the strain than in that of its sum, where the sum is the strain.
_LONGER = 1.3
#: Fewest steps that tell totals from increments; how much strain per rise of the force varies from step to step, as a
#: logarithm, where they are totals; and how many times less strain per force does. A stiffening sheet has a third.
_STEPS, _APART, _ALIKE = 5, 0.4, 3.0


def accumulated(frames: Sequence[Frame]) -> list[Frame]:
    """Frames whose displacements are sums of those of a point, which moves with the sheet, up to each frame.

    A point that is lost once is lost from then on.
    """
    total, sums = np.zeros_like(frames[0].displacement), []
    for k, frame in enumerate(frames):
        # Zero displacement of the reference, or the noise of its picture, belongs to no increment.
        total = total + frame.displacement if k else np.where(np.isnan(frame.displacement), np.nan, 0.0)
        sums.append(replace(frame, displacement=total))
    return sums


def said_without_force(strain: Float[np.ndarray, " frame"]) -> str:
    """A sentence where all deformed frames have about the strain of the first one, and no force tells why."""
    known = strain[1:][np.isfinite(strain[1:])]
    if len(known) < _FEWEST or not known.min() > _NEAR * known.max():
        return ""
    return (
        f"all {len(known)} deformed frames have a mean strain of {known.min():.3g} to {known.max():.3g}: if "
        "displacements are those since the frame before, --set increments=true adds them up"
    )


def refuse_where_reached(
    folder: str, strain: Float[np.ndarray, " frame"], numbers: Int[np.ndarray, " frame"], pull: PullRecord
) -> None:
    """:func:`refuse_increments` of the frames whose force a record tells, where these follow one another."""
    seen = pull.reached(numbers) & np.isfinite(strain)
    if np.diff(numbers[seen]).max(initial=0) == 1:
        refuse_increments(folder, strain[seen], pull.forces(numbers[seen]))


def refuse_increments(folder: str, strain: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"]) -> None:
    """Nothing, where the force follows the strain of the frames rather than its sum.

    Args:
        folder: for the message.
        strain: mean strain along the force, the reference first, in the order of the frames.
        force: of the same frames.

    Raises:
        DicError: the force follows the sum of the strains of all frames so far, and not the strain.
    """
    strain = strain * (np.sign(strain.sum()) or 1.0)
    near, largest = strain >= _NEAR * strain.max(), np.abs(force).max()
    if near.sum() < _FEWEST or strain.max() <= 0.0:
        return
    rise = force[near][-1] - force[near][0]
    way = np.abs(np.diff(force[near])).sum()
    if rise < _RISE * largest or way > _RISES_ONLY * rise:
        return
    if _way(strain, force) > _LONGER * _way(np.cumsum(strain), force):
        raise DicError(
            f"{folder}: the force grows from {force[near][0]:.3g} to {force[near][-1]:.3g} N while the sheet stays "
            f"near a mean strain of {np.median(strain[near]):.3g}: displacements are those since the frame before. "
            "Correlate again with the first picture as the reference, or say increments: true (--set "
            "increments=true), which adds up the displacements of every point. If the sheet is held there instead, "
            "frames are later than is said: check frame_rate (--frame-rate)"
        )


def totals_added(strain: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"]) -> str:
    """A sentence where what was added up as increments grows with the force itself, and not with what it grows by.

    Args:
        strain: mean strain along the force once increments are added up, the reference first.
        force: of the same frames.
    """
    step, rise = np.diff(strain), np.diff(force)
    if len(step) < _STEPS or not (step > 0.0).all() or not (rise > 0.0).all() or not force[1] > 0.0:
        return ""
    by_force, by_rise = (float(np.std(np.log(step / each))) for each in (force[1:], rise))
    if by_rise < _APART or by_force > by_rise / _ALIKE:
        return ""
    return (
        f"what each frame adds to the strain grows as the force does, from {step[0]:.3g} to {step[-1]:.3g}, while the "
        "force grows evenly: displacements may be since the reference already, and increments: true wrong"
    )


def _way(course: Float[np.ndarray, " frame"], force: Float[np.ndarray, " frame"]) -> float:
    """How far the force goes up and down in the order of a course."""
    return float(np.abs(np.diff(force[np.argsort(course, kind="stable")])).sum())
