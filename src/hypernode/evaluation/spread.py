"""Spread of a constrained field, and whether the true error agrees with it."""

from dataclasses import dataclass

import numpy as np
import scipy.special
import xarray as xr
from jaxtyping import Bool, Float, Int

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import indicator, sampled_indicator
from hypernode.fem.mesh import Mesh
from hypernode.material.files import material_of, posterior_material


def sample_spread(samples: Float[np.ndarray, "posterior_sample cell"]) -> Float[np.ndarray, " cell"]:
    """Standard deviation of each cell over the posterior samples."""
    return samples.std(axis=0, ddof=1)


def coverage(error: Float[np.ndarray, " cell"], spread: Float[np.ndarray, " cell"], spreads: float = 2.0) -> float:
    """Share of the cells whose error is within a number of standard deviations; 0.954 for a Gaussian and two."""
    return float(np.mean(np.abs(error) <= spreads * spread))


@dataclass(frozen=True)
class Samples:
    """The indicator of stiffness of a constrained field and of its posterior samples, in the unit of stress."""

    best: Float[np.ndarray, " cell"]
    values: Float[np.ndarray, "posterior_sample cell"]

    @classmethod
    def of(cls, constrained: xr.Dataset, X: Float[np.ndarray, "cell 2"], kind: str, stretch: float) -> "Samples | None":
        """Samples in an opened file of a constrained field, at the cell centres; None without samples.

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
        """Deviations of the samples from the field, over the median of the field."""
        return (self.values - self.best) / np.nanmedian(self.best)


def interface_spread(
    mesh: Mesh,
    phase: Int[np.ndarray, " cell"],
    field: Float[np.ndarray, " cell"],
    open_share: Float[np.ndarray, " cell"] | float = 1.0 / 12.0,
) -> Float[np.ndarray, " cell"]:
    """Standard deviation of a field at the centre of a cell that an interface may cut, zero in all other cells.

    Cells on both sides of a contour may be cut. The identified value of a cut cell is the mean over its two parts,
    while its centre has one or the other. If all area shares are equally likely, the root mean square difference is the
    jump over the root of twelve. The jump is taken between the medians of the phases. For known lines
    :func:`open_share_of_lines` gives the uncertainty of each cell.

    Args:
        mesh: cells of the measured grid.
        phase: number of the phase of each cell.
        field: quantity that jumps between them.
        open_share: variance at the centre of a cell over the square of the jump.
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
    """:func:`interface_spread`, with the lines of a constrained field if it has any.

    Args:
        mesh, phase, field: as of :func:`interface_spread`.
        constrained: opened file of the field, None where there is none.
    """
    if constrained is None or "interface_distance" not in constrained:
        return interface_spread(mesh, phase, field)
    return interface_spread(mesh, constrained["material_label"].values, field, open_share_of_lines(constrained))


def open_share_of_lines(constrained: xr.Dataset) -> Float[np.ndarray, " cell"]:
    """p (1 - p), with p the probability that the centre of a cell is on the other side of the nearest line.

    The position of a line is normally distributed about the identified one.
    """
    corners = constrained["interface_distance"].values[:, constrained["cells"].values]
    nearest = np.abs(corners.mean(axis=2)).min(axis=0)
    odds = scipy.special.ndtr(-nearest / max(float(constrained.attrs["line_error"]), np.finfo(float).tiny))
    return odds * (1.0 - odds)


def score_spread(
    samples: Samples,
    true: Float[np.ndarray, " cell"] | None,
    interfaces: Float[np.ndarray, " cell"] | float = 0.0,
    level: Float[np.ndarray, " cell"] | float = 0.0,
    bounded: Bool[np.ndarray, " cell"] | None = None,
) -> Judgement:
    """Spread of the indicator of stiffness, with and without that of cut cells, and its coverage of the true one.

    Args:
        samples: of the posterior.
        true: the true indicator, where it is known.
        interfaces: further uncertainty from cut cells (:func:`interface_spread`).
        level: further uncertainty of all cells alike, in the unit of stress. It has a criterion of its own and is no
            part of the mean spread.
        bounded: cells whose stiffness has an upper bound, over which the spread is a mean; None for all. Of the others
            a lower bound is all that a test tells (:mod:`~hypernode.evaluation.ratios`).
    """
    of_materials = sample_spread(samples.values)
    own = np.hypot(of_materials, interfaces)
    spread = np.hypot(own, level)
    counts = np.ones(len(spread), bool) if bounded is None or not bounded.any() else bounded
    size = np.mean(samples.best[counts] ** 2)
    each = {"spread": own, "spread_of_materials": of_materials}
    summary = {name: float(np.sqrt(np.mean(values[counts] ** 2) / size)) for name, values in each.items()}
    if true is not None:
        summary["within_two_spreads"] = coverage(samples.best - true, spread)
    return Judgement({"trace_P_spread": spread}, summary)
