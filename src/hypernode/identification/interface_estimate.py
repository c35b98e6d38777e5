"""A field of a few materials and lines as a result: its laminates, its uncertainty and its residuals."""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.identification.candidate import Candidate
from hypernode.identification.estimate import Estimate
from hypernode.identification.gradual import of_mixture
from hypernode.identification.interface_noise import Left
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.points import Points
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.trace import Score


class ReducedEquations:
    """C^T (J^T J) C y + held y = C^T b for the numbers y that decide a field by columns C.

    Attributes:
        columns: C.
        by_cells: J^T J C (cell x parameter, number).
        matrix: C^T J^T J C + held.

    Args:
        curvature: x -> J^T J x.
        columns: derivative of the flattened field by the numbers, sparse.
        held: inverse covariance of the numbers without data, sparse.
    """

    def __init__(self, curvature: Callable, columns, held):
        self.columns = columns
        self.by_cells = curvature(columns.toarray())
        self.matrix = columns.T @ self.by_cells + held.toarray()

    def solve_columns(self, b, rtol: float, iterations: int):
        """Response of the field to the columns of ``b`` (cell x parameter, k), by a direct solve without bounds."""
        return self.columns @ np.linalg.solve(self.matrix, self.columns.T @ b)


@dataclasses.dataclass(frozen=True, kw_only=True)
class InterfaceEstimate(Estimate):
    """Materials and lines.

    Attributes:
        found: materials and lines where the search ended.
        moves: how the distances from each line follow when its points move.
        going: which parameters are free; coefficients at zero stay zero.
        held: inverse covariance of the numbers without data.
    """

    found: Candidate = None
    moves: list = None
    going: np.ndarray = None
    held: scipy.sparse.csr_matrix = None

    @property
    def field(self) -> Interfaces:
        """Materials and lines."""
        return self.found.fit.field

    @property
    def left(self) -> Left:
        """Residuals of the displacements."""
        return self.found.fit.left

    @property
    def basis(self) -> ConvexBasis:
        """The law of the materials."""
        return self.problem.basis

    @property
    def gradual(self) -> bool:
        """Whether the stiffness changes gradually, of one material or of all by the same factor."""
        return len(self.field.gradual) > 0

    @property
    def layered(self) -> bool:
        """Whether a line cuts cells."""
        return len(self.field.distances) > 0

    @property
    def material_count(self) -> int:
        """Number of materials; 0 for one that changes gradually."""
        return 0 if self.gradual and self.field.count == 1 else self.field.count

    @property
    def labels(self) -> Int[np.ndarray, " cell"]:
        """Majority material of every cell."""
        return self.field.labels()

    @property
    def distances(self) -> Float[np.ndarray, "line node"]:
        """Signed distance of every node from the line of each material but the first, positive inside the material."""
        return self.field.distances

    @property
    def score(self) -> Score:
        """As the search scored it."""
        return self.found.score(self.left.independent)

    @functools.cached_property
    def effective_parameters(self) -> float:
        """Number of parameters of materials and lines that the data determine."""
        whole = self.answers(self.linear.curvature).matrix
        held = self.held.toarray()[np.ix_(self.going, self.going)]
        return float(np.trace(np.linalg.solve(whole, whole - held)))

    def answers(self, curvature: Callable) -> ReducedEquations:
        """Solver for the linear response of materials and lines."""
        columns = scipy.sparse.identity(len(self.going), format="csc")[:, np.flatnonzero(self.going)]
        return ReducedEquations(curvature, columns, columns.T @ self.held @ columns)

    @property
    def by_parts(self) -> Float[np.ndarray, "parameter part cell"]:
        """Parameters of the material at the centre of every cell, one part a cell."""
        return self.field.by_cell()[:, None]

    def jump_stress(self, F: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, "step cell 2 2"]:
        """Stress of a cut cell, a laminate, minus that of the material at its centre; zero elsewhere."""
        of, points = self.field.grid_cells(), Points(self.basis)
        if not len(of.cell):
            return np.zeros(F.shape)
        steps, count = F.shape[:2]
        layers = of.layers(points, np.moveaxis(F[:, of.cell], (2, 3), (0, 1)), False)
        mean = of.mean(layers.P.reshape(2, 2, steps, -1), count)
        cut = np.unique(of.cell)
        centre = np.tile(self.field.materials[self.labels[cut]].T, steps)
        flat = np.moveaxis(F[:, cut], (2, 3), (0, 1)).reshape(2, 2, -1)
        mean[..., cut] -= points.stress(flat, centre)[0].reshape(2, 2, steps, -1)
        return np.moveaxis(mean * of.factor, (0, 1), (2, 3))

    @property
    def line_error(self) -> float:
        """Root mean square standard deviation of the position of the lines, in cell sides; 0 without lines."""
        first, count = self.field.materials.size, sum(move.shape[1] for move in self.moves)
        half, of_lines = self._half_covariance, np.isin(np.flatnonzero(self.going), np.arange(first, first + count))
        return float(np.sqrt((half[of_lines] ** 2).sum(axis=1).mean())) if of_lines.any() else 0.0

    def samples(self, count: int, seed: int) -> Float[np.ndarray, "parameter posterior_sample part cell"]:
        """Posterior samples to first order, scaled by the residual; the lines are fixed."""
        half = self._half_covariance
        change = np.zeros((len(self.going), count))
        change[np.flatnonzero(self.going)] = half @ np.random.default_rng(seed).normal(size=(half.shape[1], count))
        materials = self.field.materials
        moved = self.understated * change[: materials.size].reshape(*materials.shape, count)
        samples = (materials[:, :, None] + moved)[self.labels]
        if (splines := self.field.lines.splines) is not None:
            known = np.append(self.field.gradual, self.field.turn)[:, None]
            gradual, turn = np.split(known + self.understated * change[-len(known) :], [len(self.field.gradual)])
            log_factor = splines.grid @ gradual
            samples[:, 0] += log_factor
            samples[:, 1 : 1 + len(turn)] += of_mixture(log_factor)[:, None] * turn
        return np.moveaxis(samples, (1, 2), (0, 1))[:, :, None]

    @functools.cached_property
    def _half_covariance(self):
        """A factor of the covariance of the numbers that may change: it times its transpose.

        The inverse curvature, with displacements as uncertain as what is left of them is large and shared: that of a
        wrong weight is the sandwich of Huber (The behavior of maximum likelihood estimates under nonstandard
        conditions, 1967).
        """
        going = np.flatnonzero(self.going)
        G_u, G_f, held = self._curvatures
        H = (G_u + G_f + held)[np.ix_(going, going)]
        spread = (self.left.level**2 * self.left.inflation * G_u + G_f + held)[np.ix_(going, going)]
        values, vectors = np.linalg.eigh(spread)
        return np.linalg.solve(H, vectors * np.sqrt(np.maximum(values, 0.0)))

    @functools.cached_property
    def _curvatures(self):
        """Curvature of the numbers by displacements, by forces, and without data."""
        unit = np.eye(len(self.going))
        white = self.linear.product(unit)
        displacements = len(white) - len(self.problem.forces)
        return (
            white[:displacements].T @ white[:displacements],
            white[displacements:].T @ white[displacements:],
            self.held.toarray(),
        )
