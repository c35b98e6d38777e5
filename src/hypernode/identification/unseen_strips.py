"""What the strips beside the points carry of a force, as the field that was identified tells it."""

import json

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.loading import Loading
from hypernode.data.measurement import mesh_of, relative_thickness
from hypernode.data.seen_share import CARRIED, carried_shares, seen_shares
from hypernode.fem.gradient import deformation_gradient
from hypernode.identification.estimate import Estimate


def stress_of(found: Estimate, measurement: xr.Dataset) -> Float[np.ndarray, "step cell 2 2"]:
    """Mean first Piola-Kirchhoff stress of every cell of the grid, in equilibrium."""
    u = np.stack([state.u[found.problem.refinement.nodes] for state in found.states])
    F = deformation_gradient(mesh_of(measurement), u)
    each, parts = np.moveaxis(F, (2, 3), (0, 1)), np.moveaxis(found.by_parts, 1, 0)
    mean = sum(np.asarray(found.basis.stress(each, part[:, None])) for part in parts) / len(parts)
    P = np.moveaxis(mean, (0, 1), (2, 3))
    return P + found.jump_stress(F) if found.layered else P


def with_carried_shares(measurement: xr.Dataset, found: Estimate) -> xr.Dataset | None:
    """The measurement with what its seen width carries of each force; None where forces tell nothing of it.

    They tell nothing where all of every section is seen, and where they are a convention.

    Args:
        measurement: of which the field was identified.
    """
    shares = seen_shares(measurement)
    if not found.problem.forces or (shares == 1.0).all():
        return None
    P = stress_of(found, measurement) * relative_thickness(measurement)[:, None, None]
    carried = carried_shares(mesh_of(measurement), Loading.of(measurement), P, shares)
    return measurement.assign_attrs({CARRIED: json.dumps(carried.tolist())})
