"""How many times as stiff as most of the sheet every other phase is, and between which bounds.

What a stiff part takes away from the deformation of a sheet is linear in its compliance. A test therefore determines
the ratio of compliances, s = 1 / r, and its standard deviation: it is s times that of log r, which posterior samples
have. Of a part that hardly deforms s may be zero within two of these. The sheet is then as a rigid part would have it,
and only the lower bound of r is known. What a soft part takes is linear in its stiffness, which has two bounds.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from hypernode.evaluation.limits import not_judged
from hypernode.fem.mesh import Mesh
from hypernode.verdict import Criterion, Level

#: Standard deviations of the ratio of compliances at which the bounds of the stiffness lie.
SPREADS = 2.0


@dataclass(frozen=True)
class Ratio:
    """The stiffness of one phase over that of the phase with most cells.

    Attributes:
        phase: its number, from the softest, 0.
        best: as identified.
        least, most: bounds; ``most`` is None where the phase may be rigid.
    """

    phase: int
    best: float
    least: float
    most: float | None

    def stored(self) -> dict:
        """As a file holds it."""
        return asdict(self)

    @property
    def words(self) -> str:
        """In words, such as "at least 40"."""
        if self.most is None:
            return f"at least {self.least:.2g}"
        return f"{self.best:.3g} ({self.least:.3g} to {self.most:.3g})"


def ratio_of(phase: int, best: float, log_spread: float) -> Ratio:
    """Bounds of a ratio of stiffnesses: of a stiffer phase from those of its inverse.

    Args:
        log_spread: standard deviation of its logarithm, by a linearisation at ``best``.
    """
    change = SPREADS * log_spread
    if best < 1.0:
        return Ratio(phase, best, best * max(1.0 - change, 0.0), best * (1.0 + change))
    return Ratio(phase, best, best / (1.0 + change), best / (1.0 - change) if change < 1.0 else None)


def ratios(
    phase: Int[np.ndarray, " cell"], best: Float[np.ndarray, " cell"], samples: Float[np.ndarray, "sample cell"]
) -> list[Ratio]:
    """The ratio of every phase but the one with most cells.

    Args:
        phase: number of the phase of every cell, from the softest, 0.
        best, samples: stiffness of every cell, of the identified field and of posterior samples.
    """
    numbers, size = np.unique(phase, return_counts=True)
    largest = int(np.argmax(size))
    # A sample to first order may have a stiffness below zero, which has no logarithm.
    logs = [np.log(np.maximum(each, np.finfo(float).tiny)) for each in (best[None], samples)]
    typical, drawn = ([np.nanmedian(each[:, phase == k], axis=1) for k in numbers] for each in logs)
    found = []
    for place, (k, of_best, of_samples) in enumerate(zip(numbers, typical, drawn, strict=True)):
        if place != largest:
            away = of_samples - drawn[largest]
            log_ratio = float((of_best - typical[largest])[0])
            spread = float(np.sqrt(np.mean((away - log_ratio) ** 2)))
            found.append(ratio_of(int(k), float(np.exp(log_ratio)), spread))
    return found


def beside_unbounded(mesh: Mesh, phase: Int[np.ndarray, " cell"], found: Sequence[Ratio]) -> Bool[np.ndarray, " cell"]:
    """Cells of a phase whose stiffness has no upper bound, and those that touch one.

    A line between both may cut the latter, whose stiffness then has none either.
    """
    inside = np.isin(phase, [each.phase for each in found if each.most is None])
    beside, pairs = inside.copy(), mesh.touching()
    for one, other in (pairs.T, pairs.T[::-1]):
        beside[one[inside[other]]] = True
    return beside


def judge_ratios(found: Sequence[Ratio]) -> Criterion:
    """What is known of the contrast; a lower bound is an answer, and nothing here warns."""
    name = "contrast"
    if not found:
        return not_judged(name, "There are no two phases whose posterior samples are known.")
    told = ", ".join(f"phase {each.phase + 1} {each.words}" for each in found)
    sentence = f"Times as stiff as most of the sheet, within two standard uncertainties: {told}."
    if any(each.most is None for each in found):
        sentence += " What has no upper bound may be rigid: the test tells no more of it."
    return Criterion(name, Level.PASSED, sentence, value=found[-1].least)
