"""Where a sheet is compressed. A thin sheet wrinkles there, and a single camera takes wrinkles for strain."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.limits import not_judged, percent
from hypernode.evaluation.thresholds import SETTINGS
from hypernode.verdict import Criterion, Level

#: Compression over the tension of the sheet that counts: finite elements leave as much of an exact field.
COUNTS = SETTINGS.equilibrium.warn


def score_compression(F: Float[np.ndarray, "step cell 2 2"], P: Float[np.ndarray, "step cell 2 2"]) -> Judgement:
    """Share of the sheet that is compressed in the step where it is most, and by how much of the tension.

    Compression is a negative principal value of P F^T, the Cauchy stress up to a positive factor. It is over the
    largest root mean square of the larger principal value of any step: of a sheet at rest, noise is no compression.

    Args:
        F, P: identified; NaN where there is no stress.
    """
    tau = P @ np.swapaxes(F, -1, -2)
    mean, half = 0.5 * (tau[..., 0, 0] + tau[..., 1, 1]), 0.5 * (tau[..., 0, 0] - tau[..., 1, 1])
    radius = np.hypot(half, 0.5 * (tau[..., 0, 1] + tau[..., 1, 0]))
    told = np.isfinite(mean) & np.isfinite(radius)
    larger, smaller = (np.where(told, mean + sign * radius, 0.0) for sign in (1.0, -1.0))
    tension = np.sqrt((larger**2).sum(axis=1, keepdims=True) / np.maximum(told.sum(axis=1, keepdims=True), 1))
    relative = -smaller / max(float(tension.max()), np.finfo(float).tiny)
    share = (relative > COUNTS).mean(axis=1)
    most = int(np.argmax(share))
    return Judgement(summary={"compressed_share": float(share[most]), "compression": float(relative[most].max())})


def judge_compression(summary: Mapping[str, object]) -> Criterion:
    """Whether parts of the sheet are compressed; an answer, whatever it is, since shear always compresses."""
    name = "compression"
    if "compressed_share" not in summary:
        return not_judged(name, "The run holds no stress of the sheet.")
    share = float(summary["compressed_share"])
    if share == 0.0:
        sentence = f"No part of the sheet is compressed by more than {percent(COUNTS)} of its tension."
    else:
        sentence = (
            f"{percent(share)} of the sheet is compressed, by up to {percent(float(summary['compression']))} of its "
            "tension. A thin sheet wrinkles there, and a single camera takes wrinkles for strain: look at its pictures."
        )
    return Criterion(name, Level.PASSED, sentence, value=share, threshold=0.0)
