"""Which contrasts are told from noise: how often an inclusion was found, and what each run says it would find."""

import json

import matplotlib.pyplot as plt
import numpy as np

from hypernode.errors import ExpectedError
from hypernode.evaluation.phases import NOT_JUDGED, SEEN
from hypernode.figures.style import INCLUSION, MATRIX, NEUTRAL


class DetectionError(ExpectedError, ValueError):
    """The figure cannot be drawn; the message says why."""


#: Standard normal quantile of an interval of 95 %.
Z = 1.96


def wilson(found: int, runs: int) -> tuple[float, float]:
    """Interval of 95 % of a share, found of so many runs (Wilson, Probable inference, 1927)."""
    share, weight = found / runs, Z**2 / runs
    middle = (share + 0.5 * weight) / (1.0 + weight)
    half = Z / (1.0 + weight) * np.sqrt(share * (1.0 - share) / runs + 0.25 * weight / runs)
    return middle - half, middle + half


def true_contrast(evaluation) -> float:
    """Stiffness of the inclusion over that of the matrix minus one, 0 of a homogeneous sheet; the stress that is shown.

    Phases are compared by the median trace of the true stress under the first prescribed mode and largest stretch.
    """
    P, phase = evaluation["P_true"].values[0, -1], evaluation["phase"].values
    trace = np.trace(P, axis1=-2, axis2=-1)
    inside = phase > 0
    return float(np.median(trace[inside]) / np.median(trace[~inside])) - 1.0 if inside.any() else 0.0


def draw(data, settings: dict):
    """Share of the runs of each true contrast in which an inclusion is distinguishable, and what each run says of that.

    Args:
        data: ``evaluation0``, ...: opened evaluations of sheets whose truth is known.
        settings: not used.

    Raises:
        DetectionError: no run judged whether there is an inclusion.
    """
    both = [(file, json.loads(file.attrs["summary"])) for file in data.values()]
    judged = [(file, summary) for file, summary in both if summary.get("inclusion", NOT_JUDGED) != NOT_JUDGED]
    if not judged:
        raise DetectionError(
            "figures: no run of this figure judged whether there is an inclusion: noisy tests need posterior_samples"
        )
    contrast = np.round([100.0 * true_contrast(file) for file, _ in judged], 1)
    summaries = [summary for _, summary in judged]
    seen = np.array([summary["inclusion"] == SEEN for summary in summaries])
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 2.6), layout="constrained")
    values = np.unique(contrast)
    for value in values:
        here = contrast == value
        share, (low, high) = seen[here].mean(), wilson(int(seen[here].sum()), int(here.sum()))
        left.plot([value, value], [100.0 * low, 100.0 * high], color=NEUTRAL, linewidth=1.0)
        left.plot(value, 100.0 * share, "o", color=MATRIX, markersize=5)
        left.annotate(f"{seen[here].sum()}/{here.sum()}", (value, 100.0 * share), (5, 4), textcoords="offset points")
    left.set_ylim(-4.0, 108.0)
    left.set_xlabel("true contrast [%]")
    left.set_ylabel("an inclusion is found [% of the runs]")
    left.set_title("(a) found, with intervals of 95 %", loc="left")
    said = np.array([100.0 * summary["detectable_contrast"] for summary in summaries])
    spread = 0.012 * np.ptp(contrast) * np.random.default_rng(0).uniform(-1.0, 1.0, len(said))
    for flag, marker, colour, label in ((True, "o", INCLUSION, "found"), (False, "x", MATRIX, "none distinguishable")):
        at = seen == flag
        right.plot((contrast + spread)[at], said[at], marker, color=colour, markersize=4, label=label)
    both = [0.0, max(contrast.max(), said.max())]
    right.plot(both, both, color=NEUTRAL, linewidth=0.8, linestyle="--")
    right.set_xlabel("true contrast [%]")
    right.set_ylabel("contrast that would be seen [%]")
    right.set_title("(b) what each run says it would see", loc="left")
    right.legend(loc="best")
    return figure
