"""Local misfit of the displacements, and where it exceeds chance.

A mean over the sheet hides local errors. Squared residuals are therefore averaged around each cell. The limit is the
value that the largest of these means reaches by chance anywhere in the sheet.

A point of a cut edge is a mean over a window, half of which lies beyond the edge. What bends there is not seen. So such
a point may be off by as much as the window changes anywhere in the sheet. What errors of that size explain says nothing
of the material (docs/decisions/0221).
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.special
from jaxtyping import Bool, Float

from hypernode.identification import thresholds
from hypernode.identification.estimate import Estimate
from hypernode.identification.observations import Observations
from hypernode.identification.window_error import changed_by_window


@dataclass(frozen=True)
class LocalMisfit:
    """Misfit of the displacements around every cell, over the larger of noise and the misfit of the whole sheet.

    Attributes:
        values: root mean square over the nodes of the cell and of the cells around it, NaN where nothing is observed.
        unexplained: cells whose value exceeds the limit of chance for the whole sheet.
        residuals: misfit of every displacement over its expected error, NaN where none is observed.
        independent: number of independent residuals over that of all.
    """

    values: Float[np.ndarray, " cell"]
    unexplained: Bool[np.ndarray, " cell"]
    residuals: Float[np.ndarray, "step node 2"]
    independent: float


def local_misfit(found: Estimate) -> LocalMisfit | None:
    """Misfit of the displacements around every measured cell; None where its error is known nowhere, or of pictures.

    Correlated errors count as fewer independent ones, by the square of the scatter.
    """
    problem = found.problem
    observations = problem.observations
    if not observations.by_places:
        return None
    residuals, forces = found.objective.residuals(found.states, problem.sigma, found.linear)
    if found.linear is not None and (beyond := beyond_edges(observations)):
        white = found.linear.without(np.concatenate([residuals, forces]), beyond)
        residuals = white[: len(residuals)]
    nodes = len(observations.grid.nodes)
    observed = [boundary.observed for boundary in observations.boundaries]
    by_node = np.full((len(observed), 2 * nodes), np.nan)
    by_node[np.repeat(np.arange(len(observed)), [len(each) for each in observed]), np.concatenate(observed)] = residuals
    # Errors that points share weigh as larger independent ones: beside lines more so than elsewhere.
    by_node = by_node.reshape(observations.u.shape) / observations.expected
    node = np.concatenate(observed) // 2
    around = observations.grid.around()
    squares = around @ np.bincount(node, residuals**2, nodes)
    count = around @ np.bincount(node, minlength=nodes)
    usual = max(observations.scatter, float(np.sqrt(np.mean(residuals**2))))
    known = count > 0
    mean = np.divide(squares, count, out=np.full(len(count), np.nan), where=known)
    # Means around cells that share no node are independent: as many as there are nodes for each.
    places = max(nodes / np.median(np.diff(around.indptr)), 1.0)
    alone = scipy.special.ndtr(-thresholds.BY_CHANCE) / places
    share = observations.scatter**2
    independent = np.maximum(count * share, 1.0)
    limit = scipy.special.chdtri(independent, alone) / independent
    unexplained = known & (mean > limit * usual**2)
    return LocalMisfit(np.sqrt(mean) / usual, unexplained, by_node, share)


def beyond_edges(observations: Observations) -> list[scipy.sparse.csr_matrix]:
    """Errors of the points of cut edges by what may bend beyond them, by step (degree of freedom, point); or none."""
    if not observations.cut or observations.window == 0.0:
        return []
    grid, refinement = observations.grid, observations.refinement
    changed = changed_by_window(grid, observations.u, observations.window, observations.kernel).max(axis=1)
    between = scipy.sparse.kron(refinement.interpolation, scipy.sparse.identity(2), format="csr")
    found = []
    for most, boundary in zip(changed, observations.boundaries, strict=True):
        size = np.where(
            boundary.mask[refinement.nodes] & (most > thresholds.BY_CHANCE * observations.sigma), most, 0.0
        ).ravel()
        off = np.flatnonzero(size)
        of_points = scipy.sparse.csr_matrix((size[off], (off, np.arange(len(off)))), (len(size), len(off)))
        found.append(between @ of_points)
    return found
