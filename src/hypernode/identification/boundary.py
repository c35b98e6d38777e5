"""Prescribed, free and observed degrees of freedom of a sheet in one load step."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse

from hypernode.data.boundary import PrescribedDisplacement, prescribed_displacement
from hypernode.fem.mesh import Mesh
from hypernode.fem.refinement import Refinement
from hypernode.identification import numerics


@dataclass(frozen=True, kw_only=True)
class Boundary:
    """Prescribed, free and observed degrees of freedom of one load step.

    Attributes:
        mask: which components of which nodes are prescribed (node, 2), on the mesh of the subcells.
        values: their displacement (node, 2).
        errors: errors of these values (degree of freedom, independent standard normal number); zero inside the sheet.
        prescribed, free: their degrees of freedom, and all others.
        observed: measured degrees of freedom that are not prescribed, on the measured grid: no lost points. Of pictures
            without points between, those of the mesh that carries their information.
        observe: matrix from all displacements of the mesh to the observed ones as the camera sees them, over
            ``relative``. For pictures: as many independent numbers as are observed.
        seen: measured values of them, over ``relative`` as well.
        relative: error of every observed degree of freedom over the common one; empty for pictures without points.
    """

    mask: np.ndarray
    values: np.ndarray
    errors: scipy.sparse.csr_matrix
    prescribed: np.ndarray
    free: np.ndarray
    observed: np.ndarray
    observe: scipy.sparse.csr_matrix
    seen: np.ndarray
    relative: np.ndarray


def boundary_of(refinement: Refinement, grid: Mesh, u, prescribed, noise, blurred, relative, seen) -> Boundary:
    """The boundary of a load step.

    Args:
        u: measured displacement (node, 2), NaN where it was lost.
        prescribed: which components of which edges are (edge, 2).
        noise: standard deviation of prescribed points, by component.
        blurred: by how much every point may be off, since it is a mean over a window (node, 2).
        relative: error of every point and component over that of all (node, 2).
        seen: matrix from displacements of the mesh to those of all points of the grid as the camera sees them.
    """
    edges = _kept_from_drifting(grid, u, prescribed_displacement(grid, u, prescribed, noise), noise)
    # What a window changes is another number at every point that it changes.
    off = np.flatnonzero(edges.mask.ravel() & (blurred.ravel() > 0.0))
    of_window = scipy.sparse.csr_matrix((blurred.ravel()[off], (off, np.arange(len(off)))), (u.size, len(off)))
    errors = scipy.sparse.hstack([scipy.sparse.csr_matrix(edges.errors), of_window], format="csr")
    between = refinement.interpolation
    both = scipy.sparse.kron(between, scipy.sparse.identity(2), format="csr")
    mask = edges.mask
    observed = np.flatnonzero(~mask.ravel() & np.isfinite(u.ravel()))
    relative = relative.ravel()[observed]
    # A node between two that are prescribed is prescribed as well.
    mask = between @ mask > 1.0 - numerics.ROUNDING
    return Boundary(
        mask=mask,
        values=between @ edges.values,
        errors=both @ errors,
        prescribed=np.flatnonzero(mask.ravel()),
        free=np.flatnonzero(~mask.ravel()),
        observed=observed,
        observe=scipy.sparse.diags(1.0 / relative) @ seen[observed],
        seen=u.ravel()[observed] / relative,
        relative=relative,
    )


def _kept_from_drifting(grid: Mesh, u, edges: PrescribedDisplacement, noise) -> PrescribedDisplacement:
    """The same with one point prescribed in each component that no edge prescribes, the measured one next to a corner.

    The sheet as a whole is then off by the noise of that point, which is an error like those of edges.
    """
    mask, values, errors = edges.mask.copy(), edges.values.copy(), edges.errors
    distance = np.where(np.isfinite(u).all(axis=1), np.abs(grid.nodes - grid.lower).sum(axis=1), np.inf)
    point = int(np.argmin(distance))
    for i in np.flatnonzero(~mask.any(axis=0)):
        mask[point, i], values[point, i] = True, u[point, i]
        if noise[i] > 0.0:
            own = np.zeros((u.size, 1))
            own[2 * point + i] = noise[i]
            errors = np.concatenate([errors, own], axis=1)
    return PrescribedDisplacement(mask, values, errors)
