"""How uncertain a constrained field says it is, and whether the truth lies as far from it as that."""

from dataclasses import dataclass

import numpy as np
import scipy.stats
import xarray as xr
from jaxtyping import Float, Int

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import indicator, sampled_indicator
from hypernode.fem.mesh import Mesh
from hypernode.material.files import material_of, posterior_material


def sample_spread(samples: Float[np.ndarray, "posterior_sample cell"]) -> Float[np.ndarray, " cell"]:
    """Standard deviation of each cell over the posterior samples."""
    return samples.std(axis=0, ddof=1)


def coverage(error: Float[np.ndarray, " cell"], spread: Float[np.ndarray, " cell"], spreads: float = 2.0) -> float:
    """Share of the cells whose error is within so many standard deviations; 0.954 of a Gaussian are within two."""
    return float(np.mean(np.abs(error) <= spreads * spread))


@dataclass(frozen=True)
class Samples:
    """The indicator of stiffness of a constrained field and of its posterior samples, in the unit of stress."""

    best: Float[np.ndarray, " cell"]
    values: Float[np.ndarray, "posterior_sample cell"]

    @classmethod
    def of(cls, constrained: xr.Dataset, X: Float[np.ndarray, "cell 2"], kind: str, stretch: float) -> "Samples | None":
        """Those of an opened file of a constrained field at the cell centres; None where it has no samples.

        Args:
            kind, stretch: of the load, as in :func:`~hypernode.evaluation.probes.indicator`.
        """
        posterior = posterior_material(constrained)
        if posterior is None:
            return None
        best, count = material_of(constrained), constrained.sizes["posterior_sample"]
        values = sampled_indicator(best, posterior, X, count, kind, stretch)
        return cls(indicator(best, X, kind, stretch), values)

    @property
    def deviations(self) -> Float[np.ndarray, "posterior_sample cell"]:
        """Of the samples from the field, over its median."""
        return (self.values - self.best) / np.nanmedian(self.best)


def interface_spread(
    mesh: Mesh,
    phase: Int[np.ndarray, " cell"],
    field: Float[np.ndarray, " cell"],
    open_share: Float[np.ndarray, " cell"] | float = 1.0 / 12.0,
) -> Float[np.ndarray, " cell"]:
    """Standard deviation of a field at the centre of a cell that an interface may cut, zero in all other cells.

    Cells on both sides of a contour may be cut. What is found of a cut cell is the mean over its two parts; at its
    centre is one or the other. Where all shares of the parts are equally likely, the two differ by the jump over the
    root of twelve, root mean square. The jump is that between the medians of the phases. Where lines are known,
    :func:`open_share_of_lines` says how far each cell is open.

    Args:
        mesh: cells of the measured grid.
        phase: number of the phase of each cell.
        field: what jumps between them.
        open_share: mean square of what is open at the centre of a cell, over the square of the jump.
    """
    pairs = mesh.touching()
    _, number = np.unique(phase, return_inverse=True)
    typical = np.array([np.nanmedian(field[number == k]) for k in range(number.max() + 1)])
    jump = np.abs(typical[number[pairs[:, 0]]] - typical[number[pairs[:, 1]]])
    largest = np.zeros(len(phase))
    np.maximum.at(largest, pairs.ravel(), np.repeat(jump, 2))
    return largest * np.sqrt(open_share)


def spread_of_cut_cells(
    mesh: Mesh,
    phase: Int[np.ndarray, " cell"],
    field: Float[np.ndarray, " cell"],
    constrained: xr.Dataset | None,
) -> Float[np.ndarray, " cell"]:
    """:func:`interface_spread`, by the lines of a constrained field where it has them.

    Args:
        mesh, phase, field: as of :func:`interface_spread`.
        constrained: opened file of the field, None where there is none.
    """
    if constrained is None or "interface_distance" not in constrained:
        return interface_spread(mesh, phase, field)
    return interface_spread(mesh, constrained["material_label"].values, field, open_share_of_lines(constrained))


def open_share_of_lines(constrained: xr.Dataset) -> Float[np.ndarray, " cell"]:
    """p (1 - p) for the odds p that the centre of a cell is on the other side of the line that is nearest to it.

    The place of a line is normal about where it was found.
    """
    corners = constrained["interface_distance"].values[:, constrained["cells"].values]
    nearest = np.abs(corners.mean(axis=2)).min(axis=0)
    odds = scipy.stats.norm.sf(nearest / max(float(constrained.attrs["line_error"]), np.finfo(float).tiny))
    return odds * (1.0 - odds)


def score_spread(
    samples: Samples, true: Float[np.ndarray, " cell"] | None, interfaces: Float[np.ndarray, " cell"] | float = 0.0
) -> Judgement:
    """Spread of the indicator of stiffness, and its coverage of the true one.

    Args:
        samples: of the posterior.
        true: the true indicator, where it is known.
        interfaces: what interfaces that cut cells leave open beside it, of :func:`interface_spread`, and what is not
            seen of the sheet.
    """
    spread = np.hypot(sample_spread(samples.values), interfaces)
    summary = {"spread": float(np.sqrt(np.mean(spread**2) / np.mean(samples.best**2)))}
    if true is not None:
        summary["within_two_spreads"] = coverage(samples.best - true, spread)
    return Judgement({"trace_P_spread": spread}, summary)
