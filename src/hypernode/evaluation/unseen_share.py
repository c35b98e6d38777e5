"""Uncertainty of a section's force by the strips beside the points, which nobody sees."""

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.loading import Loading
from hypernode.data.measurement import is_cut_out
from hypernode.data.seen_share import strips
from hypernode.fem.mesh import Mesh


def unseen_share(
    measurement: xr.Dataset,
    mesh: Mesh,
    loading: Loading,
    shares: Float[np.ndarray, "case axis"],
    P: Float[np.ndarray, "step cell 2 2"],
) -> tuple[float, float]:
    """(relative uncertainty of the force by what is not seen of the sections, smallest share that is seen).

    Args:
        measurement: opened file.
        mesh, loading: of it.
        shares: of :func:`~hypernode.data.seen_share.seen_shares`.
        P: stress of the identified field, times the relative thickness.
    """
    found, seen = [0.0], [1.0]
    if not is_cut_out(measurement):
        return 0.0, 1.0
    for case in range(len(shares)):
        steps = np.flatnonzero(loading.load_case == case)
        for axis in range(2):
            along = shares[case, 1 - axis]
            if along < 1.0 and loading.measured[steps, axis, axis].any():
                found.append(share_uncertainty(mesh, P[steps[-1], :, axis, axis], axis, along))
                seen.append(float(along))
    return max(found), min(seen)


def share_uncertainty(mesh: Mesh, normal: Float[np.ndarray, " cell"], axis: int, share: float) -> float:
    """Relative uncertainty of the force of a section that is measured in part.

    The strip beside the measured points is assumed to be like their rim. Two checks give the error of this assumption.
    Every section carries the same force, so the scatter over sections is an error. A band within the sheet, as wide as
    the strip, differs from the band beside it. The errors of both sides are independent.

    Args:
        normal: normal traction on the sections, times the relative thickness.
        axis: of that normal.
        share: measured part of a section.
    """
    grid, sizes = _on_sections(mesh, normal, axis)
    whole = np.nansum(grid * sizes, axis=1)
    strip, band = strips(float(sizes.sum()), share)
    ends = np.cumsum(sizes) - 0.5 * sizes
    from_both = ends, sizes.sum() - ends
    rims = [np.nanmean(grid[:, near < band], axis=1) for near in from_both]
    beside = [np.nanmean(grid[:, (near >= band) & (near < 2.0 * band + 1e-9)], axis=1) for near in from_both]
    force = whole + strip * (rims[0] + rims[1])
    mean = np.nanmean(force)
    missed = np.array([rim - next_to for rim, next_to in zip(rims, beside, strict=True)]) / (mean / sizes.sum() * share)
    scatter = float(np.nanstd(force) / mean)
    return float(np.hypot(scatter, (1.0 - share) * np.sqrt(0.5 * np.nanmean(missed**2))))


def _on_sections(mesh: Mesh, values: Float[np.ndarray, " cell"], axis: int):
    """(values by section and place along it, NaN in a hole; widths of those places)."""
    lines = mesh.lines
    sizes = np.diff(lines[1 - axis])
    centres = mesh.centres
    place = [np.searchsorted(lines[k], centres[:, k]) - 1 for k in (axis, 1 - axis)]
    grid = np.full((len(lines[axis]) - 1, len(sizes)), np.nan)
    grid[place[0], place[1]] = values
    return grid, sizes
