"""Where in a sheet its law is refuted: displacements miss there what grows with the test.

Noise differs from step to step, and an error of the reference picture is the same in all steps. What grows with the
deformation is neither. So residuals are weighed by the deformation less its mean over the steps, which no error of the
reference survives. Their squares are averaged around each cell. How large chance makes the largest of these means
anywhere in a sheet follows from their distribution.
"""

from dataclasses import dataclass

import numpy as np
import scipy.special
import xarray as xr
from jaxtyping import Bool, Float

from hypernode.data.measurement import mesh_of
from hypernode.evaluation.limits import limited, not_judged, percent
from hypernode.evaluation.thresholds import Settings
from hypernode.fem.mesh import Mesh
from hypernode.verdict import Criterion

#: Standard deviations that chance does not reach anywhere in a sheet but once in 700 sheets.
NEVER = 3.0
#: Steps from which growth is told from a reference error.
FEWEST = 3


@dataclass(frozen=True)
class Refuted:
    """What grows with the test around every cell.

    Attributes:
        size: at the largest deformation, over the noise of a displacement; zero where chance makes as much.
        cells: where it is more than chance.
        deformation: what it stands for, over the largest deformation of the test.
    """

    size: Float[np.ndarray, " cell"]
    cells: Bool[np.ndarray, " cell"]
    deformation: Float[np.ndarray, " cell"]

    def counts(self, settings: Settings) -> Bool[np.ndarray, " cell"]:
        """Where it is deformation that counts for a stress."""
        return self.deformation > settings.deformation


def growth(
    mesh: Mesh,
    residual: Float[np.ndarray, "step node 2"],
    deformation: Float[np.ndarray, " step"],
    independent: float = 1.0,
) -> tuple[Float[np.ndarray, " cell"], Bool[np.ndarray, " cell"]]:
    """(what grows around every cell at the largest deformation, over noise; where it is more than chance).

    Args:
        residual: over noise, NaN where a point is lost.
        deformation: of each step.
        independent: share of the residuals that are independent of their neighbours.
    """
    t = deformation / deformation.max()
    known = np.isfinite(residual).all(axis=0)
    weights = t - t.mean()
    power = float(weights @ weights)
    # Of one number that grows with t, this is its size times the root of the power, and a normal number by chance.
    projected = np.where(known, np.einsum("s,sni->ni", weights, np.nan_to_num(residual)) / np.sqrt(power), 0.0)
    around = mesh.around()
    count = around @ known.sum(axis=1)
    mean = np.divide(around @ (projected**2).sum(axis=1), count, out=np.ones(len(count)), where=count > 0)
    # As if means around cells were independent: they overlap, so that chance does so less often.
    free = np.maximum(count * independent, 1.0)
    limit = scipy.special.chdtri(free, scipy.special.ndtr(-NEVER) / len(count)) / free
    return np.sqrt(np.maximum(mean - 1.0, 0.0) / power), (count > 0) & (mean > limit)


def refuted(measurement: xr.Dataset, constrained: xr.Dataset | None) -> Refuted | None:
    """Where the law of a constrained field is refuted; None where no noise of points or too few steps tell.

    Args:
        measurement, constrained: opened files.
    """
    if constrained is None or "residual" not in constrained:
        return None
    residual = constrained["residual"].values
    mesh, F = mesh_of(measurement), np.linalg.norm(measurement["H"].values, axis=(1, 2))
    if len(residual) < FEWEST or len(np.unique(measurement["load_case"].values)) > 1 or np.ptp(F) == 0.0:
        return None
    size, cells = growth(mesh, residual, F, float(constrained.attrs["independent_residuals"]))
    stands_for = size * float(constrained.attrs["noise_deformation"])
    return Refuted(np.where(cells, size, 0.0), cells, np.where(cells, stands_for, 0.0))


def judge_refuted(found: Refuted | None, settings: Settings) -> Criterion:
    """In how much of the sheet the law is refuted by deformation that counts."""
    name = "refuted"
    if found is None:
        return not_judged(name, "No noise, or fewer than three steps of one load, say where the law fails.")
    share = float(found.counts(settings).mean())
    words = f"What is missed grows with the test, by more than {percent(settings.deformation)} of the deformation, in"
    return limited(name, words, share, settings.places, lambda v: f"{percent(v)} of the sheet")
