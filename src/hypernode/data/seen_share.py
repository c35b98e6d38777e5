"""A load cell's force over a sheet of which a part is seen: what is beside the points carries what their rim carries.

The force of a section is the sum over the seen width w and the strips m on either side of it, W = w + 2 m in all. Where
the traction of a strip is that of the band b beside it,

    F = ∫_w P_N ds + (m / b) ∫_bands P_N ds.

Measured resultants are the share w / W of F, as in a uniform sheet. So nodal forces count by w / W, and in the
bands by (1 + m / b) w / W.
"""

import json

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.fem.mesh import EDGES, Mesh

#: Narrowest band over the seen width: fewer points than in an eighth tell a traction with the noise of a corner.
NARROWEST = 0.125


def seen_shares(measurement: xr.Dataset) -> Float[np.ndarray, "case axis"]:
    """Share of the sheet's side along each axis that the points of each test cover; 1 where nothing says otherwise."""
    count = int(measurement["load_case"].values.max()) + 1
    return np.array(json.loads(measurement.attrs.get("seen_share", "null")) or [[1.0, 1.0]] * count)


def strips(width: float, share: float) -> tuple[float, float]:
    """(width of the unseen strip on either side of the seen width, width of the band that stands for it)."""
    strip = 0.5 * width * (1.0 / share - 1.0)
    return strip, min(max(strip, NARROWEST * width), 0.5 * width)


def section_weights(mesh: Mesh, edge: str, share: float) -> Float[np.ndarray, " edge_node"]:
    """By what the nodal forces of an edge count, in the order of ``mesh.on_edge``; 1 where all of it is seen.

    Args:
        share: of the sheet's side along the edge.
    """
    along = 1 - EDGES[edge][0]
    place, width = mesh.nodes[mesh.on_edge(edge), along], float(mesh.size[along])
    strip, band = strips(width, share)
    rim = np.minimum(place - mesh.lower[along], mesh.upper[along] - place)
    own = float(np.median(np.diff(np.unique(place))))
    inside = np.clip((band - rim) / own + 0.5, 0.0, 1.0)
    return share * (1.0 + strip / band * inside)
