"""Points that a camera lost: displacement is unknown there, and the material goes on."""

import numpy as np
import scipy.sparse
import xarray as xr
from jaxtyping import Float

from hypernode.data.measurement import measured_displacement, mesh_of
from hypernode.fem.factors import factorise
from hypernode.fem.lines import intervals
from hypernode.fem.mesh import Mesh
from hypernode.fem.nodal_forces import stiffness_matrix


def filled(mesh: Mesh, u: Float[np.ndarray, "step node 2"]) -> Float[np.ndarray, "step node 2"]:
    """Displacements with those of lost points, NaN, in place of them what is smoothest between their neighbours.

    What the measured points deviate from their mean deformation goes on by Laplace's equation, so that a sheet that
    lost its outline is no less stretched there. Good for a mean over the sheet or a first guess; nothing that is filled
    in is a measurement.

    Raises:
        ValueError: a step has no measured point at all.
    """
    lost = np.isnan(u).any(axis=-1)
    if not lost.any():
        return u
    if lost.all(axis=1).any():
        raise ValueError(f"load step {int(np.argmax(lost.all(axis=1)))} has no measured point")
    u, K = u.copy(), stiffness_matrix(mesh).tocsc()
    affine = np.column_stack([mesh.nodes - mesh.nodes.mean(axis=0), np.ones(len(mesh.nodes))])
    for field, gone in zip(u, lost, strict=True):
        if gone.any():
            mean = affine @ np.linalg.lstsq(affine[~gone], field[~gone], rcond=None)[0]
            rest = factorise(K[gone][:, gone]).solve(-(K[gone][:, ~gone] @ (field - mean)[~gone]))
            field[gone] = mean[gone] + rest
    return u


def sheet_displacement(measurement: xr.Dataset, constrained: xr.Dataset | None) -> Float[np.ndarray, "step node 2"]:
    """How a sheet is drawn: the displacement of its equilibrium field, or without one the measured one, filled in.

    Args:
        measurement, constrained: opened files of a run.
    """
    if constrained is not None:
        return constrained["u"].values
    return filled(mesh_of(measurement), measured_displacement(measurement))


def along(x: Float[np.ndarray, " point"], known: Float[np.ndarray, " known"]) -> scipy.sparse.csr_matrix:
    """Matrix (point, known) of the piecewise linear function through values at ``known``, which goes on straight.

    Args:
        x: increasing positions.
        known: two or more of them.
    """
    place, share = intervals(known, x)
    rows = np.tile(np.arange(len(x)), 2)
    entries = np.concatenate([1.0 - share, share]), (rows, np.concatenate([place, place + 1]))
    return scipy.sparse.csr_matrix(entries, (len(x), len(known)))
