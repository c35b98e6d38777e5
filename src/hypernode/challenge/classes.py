"""Two phases of a sheet, and the materials of the challenge that they are."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Float, Int

from hypernode.challenge.errors import ChallengeError
from hypernode.identification.partition import levels


@dataclass(frozen=True)
class PairOfMaterials:
    """Two materials that occur together.

    Attributes:
        soft, stiff: their labels.
        soft_stress, stiff_stress: stress that stands for their stiffness [MPa].
    """

    soft: int
    stiff: int
    soft_stress: float
    stiff_stress: float

    def stored(self) -> dict:
        """As an entry of a file of classes."""
        return asdict(self)


def in_two(log_stiffness: Float[np.ndarray, " cell"]) -> tuple[Int[np.ndarray, " cell"], tuple[float, float]]:
    """(1 for every cell of the stiffer of two levels, else 0; typical stiffness of both).

    Raises:
        ChallengeError: all cells are equally stiff.
    """
    low, high = np.sort(levels(log_stiffness, 2))
    stiffer = (np.abs(log_stiffness - high) < np.abs(log_stiffness - low)).astype(int)
    if not stiffer.any():
        raise ChallengeError("every cell is equally stiff: there is no second material")
    of_both = [float(np.exp(np.median(log_stiffness[stiffer == k]))) for k in (0, 1)]
    return stiffer, (of_both[0], of_both[1])


def nearest_pair(pairs: Sequence[PairOfMaterials], stress: tuple[float, float]) -> PairOfMaterials:
    """The pair whose stiffnesses are the most alike, by the sum of squared differences of their logarithms."""
    known = np.log([[pair.soft_stress, pair.stiff_stress] for pair in pairs])
    return pairs[int(((known - np.log(stress)) ** 2).sum(axis=1).argmin())]


def pair_of_label(
    label: Int[np.ndarray, "nx ny"], stiffer: Int[np.ndarray, "nx ny"], stress: tuple[float, float], source: str
) -> PairOfMaterials:
    """The pair that a labelled sheet is of: each phase has the label that most of its points have.

    Raises:
        ChallengeError: both phases have the same label for the most part.
    """
    soft, stiff = (int(np.bincount(label[stiffer == k]).argmax()) for k in (0, 1))
    if soft == stiff:
        raise ChallengeError(
            f"{source}: both phases lie mostly where the label is {soft}: it does not fit what the sheet does, and "
            "tells no class; leave the file out"
        )
    return PairOfMaterials(soft, stiff, *stress)


def mean_pairs(found: Sequence[PairOfMaterials]) -> list[PairOfMaterials]:
    """One pair of every two labels, with the geometric means of their stiffnesses."""
    together: dict[tuple[int, int], list[PairOfMaterials]] = {}
    for pair in found:
        together.setdefault((pair.soft, pair.stiff), []).append(pair)
    return [
        PairOfMaterials(*labels, *(float(np.exp(np.mean(np.log([getattr(p, key) for p in each])))) for key in
                                   ("soft_stress", "stiff_stress")))
        for labels, each in sorted(together.items())
    ]  # fmt: skip
