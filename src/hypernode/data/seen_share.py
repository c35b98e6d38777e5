"""A load cell's force over a sheet of which a part is seen: what is beside the points carries what their rim carries.

The force of a section is the sum over the seen width w and the strips m on either side of it, W = w + 2 m in all. A
strip has the material of the rim beside it and is stretched as that is,

    F = ∫_w P_N ds + Σ_sides m (P_N - P_T / 2)_rim.

The last part is of sides that are free. Such a strip carries no stress across. At equal stretch, what keeps its volume
then carries less by half of that stress. Of sides that are pulled as well there is none.

Every section carries the same force. What is not seen differs from the rim at some sections and not at others, so that
the median over all sections counts. Measured resultants are the share w / W of F, as in a uniform sheet.
"""

import json
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.loading import Loading
from hypernode.fem.mesh import EDGES, Mesh

#: Attribute of a measurement that keeps :func:`carried_shares`, once a field has told them.
CARRIED = "carried_share"
#: Narrowest band over the seen width that is compared with the one beside it: fewer points tell only their noise.
NARROWEST = 0.125
#: By how much less of the stress across a rim a free strip carries: Poisson's ratio of what keeps its volume.
FREE = 0.5


class Section(NamedTuple):
    """The force of the sections across an axis, where a part of them is seen.

    Attributes:
        carried: share of the force that the seen width of both ends carries, over its share of the width.
        uncertainty: relative, of the force, by what is not seen.
    """

    carried: float
    uncertainty: float


def seen_shares(measurement: xr.Dataset) -> Float[np.ndarray, "case axis"]:
    """Share of the sheet's side along each axis that the points of each test cover; 1 where nothing says otherwise."""
    count = int(measurement["load_case"].values.max()) + 1
    return np.array(json.loads(measurement.attrs.get("seen_share", "null")) or [[1.0, 1.0]] * count)


def believed_shares(measurement: xr.Dataset) -> Float[np.ndarray, "step axis"]:
    """The carried shares that a field has told; 1 before one has, as in a uniform sheet."""
    steps = measurement.sizes["load_step"]
    return np.array(json.loads(measurement.attrs.get(CARRIED, "null")) or np.ones((steps, 2)))


def carried_shares(
    mesh: Mesh,
    loading: Loading,
    P: Float[np.ndarray, "step cell 2 2"],
    shares: Float[np.ndarray, "case axis"],
) -> Float[np.ndarray, "step axis"]:
    """``carried`` of :class:`Section` at every step, across each axis; 1 where all of the section is seen.

    Args:
        P: stress of an identified field, times the relative thickness.
        shares: of :func:`seen_shares`.
    """
    found = np.ones((len(P), 2))
    for step, axis in np.ndindex(found.shape):
        case = loading.load_case[step]
        share = shares[case, 1 - axis]
        if share < 1.0:
            found[step, axis] = section(mesh, P[step], axis, share, has_free_sides(loading, case, axis)).carried
    return found


def has_free_sides(loading: Loading, case: int, axis: int) -> bool:
    """Whether nothing holds the sides of a sheet that are along the normal of its sections."""
    sides = [number for number, (normal, _) in enumerate(EDGES.values()) if normal != axis]
    return not loading.constrained[case, sides].any()


def section(mesh: Mesh, P: Float[np.ndarray, "cell 2 2"], axis: int, share: float, free: bool) -> Section:
    """What the seen part of the sections across an axis tells of their force.

    Two checks give its uncertainty. Every section carries the same force, so the scatter over sections is an error. A
    band within the sheet, as wide as the strip, differs from the band beside it. From a rim to the middle of a strip it
    is half as far as from one band to the next, and the errors of both sides are independent. What free sides take is
    known to a size of its own.

    Args:
        P: stress of every cell, times the relative thickness.
        axis: of the normal of the sections.
        share: seen part of their width.
        free: of :func:`has_free_sides`.
    """
    normal, sizes = _on_sections(mesh, P[:, axis, axis], axis)
    across, _ = _on_sections(mesh, P[:, 1 - axis, 1 - axis], axis)
    width = float(sizes.sum())
    strip = 0.5 * width * (1.0 / share - 1.0)
    seen, taken = np.nansum(normal * sizes, axis=1), (FREE if free else 0.0) * across
    whole = seen + strip * (normal - taken)[:, [0, -1]].sum(axis=1)
    force = float(np.nanmedian(whole))
    if force == 0.0:
        return Section(1.0, 0.0)
    band = min(max(strip, NARROWEST * width), 0.5 * width)
    ends = np.cumsum(sizes) - 0.5 * sizes
    missed = []
    for near in (ends, width - ends):
        beside = np.nanmean(normal[:, (near >= band) & (near < 2.0 * band + 1e-9)], axis=1)
        missed.append(np.nanmean(normal[:, near < band], axis=1) - beside)
    of_strips = 0.5 * (1.0 - share) * np.sqrt(0.5 * np.nanmean(np.square(missed))) * width / (share * abs(force))
    by_sides = strip * np.nanmedian(taken[:, [0, -1]], axis=0).sum() / force
    return Section(
        carried=0.5 * float(seen[0] + seen[-1]) / (share * force),
        uncertainty=float(np.linalg.norm([np.nanstd(whole) / force, of_strips, by_sides])),
    )


def _on_sections(mesh: Mesh, values: Float[np.ndarray, " cell"], axis: int):
    """(values by section and place along it, NaN in a hole; widths of those places)."""
    lines = mesh.lines
    sizes = np.diff(lines[1 - axis])
    centres = mesh.centres
    place = [np.searchsorted(lines[k], centres[:, k]) - 1 for k in (axis, 1 - axis)]
    grid = np.full((len(lines[axis]) - 1, len(sizes)), np.nan)
    grid[place[0], place[1]] = values
    return grid, sizes
