"""Comparison of a number with a threshold."""

import math

from hypernode.evaluation.thresholds import Threshold
from hypernode.verdict import Criterion, Level


def not_judged(name: str, sentence: str) -> Criterion:
    """A criterion that does not apply, with the reason."""
    return Criterion(name, Level.NOT_JUDGED, sentence)


def percent(value: float) -> str:
    """A share as text in per cent; errors above 1000 % are not given in digits."""
    return "1000 % and more" if value >= 10.0 else f"{100.0 * value:.3g} %"


def limited(name: str, words: str, value: float, threshold: Threshold, shown=percent) -> Criterion:
    """Criterion for a number that should be small; a number that is not finite fails."""
    value = float(value)
    if not math.isfinite(value):
        return Criterion(
            name, Level.FAILED, f"{words} a number that is not finite.", value=None, threshold=threshold.fail
        )
    level = Level.FAILED if value > threshold.fail else Level.WARNED if value > threshold.warn else Level.PASSED
    limit = threshold.fail if level is Level.FAILED else threshold.warn
    compared = "no more than" if level is Level.PASSED else "more than"
    return Criterion(name, level, f"{words} {shown(value)}, {compared} {shown(limit)}.", value=value, threshold=limit)
