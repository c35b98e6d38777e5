"""A field of two materials in layers where the line between them cuts cells."""

import dataclasses
import functools
from collections.abc import Callable

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.identification.estimate import Estimate
from hypernode.identification.few_materials import ReducedEquations
from hypernode.mechanics.convex_basis import ConvexBasis

#: Share of a cell below which a layer of it is none.
SMALLEST_SHARE = 1e-9


@dataclasses.dataclass(frozen=True)
class LayeredEstimate(Estimate):
    """Two materials and the line between them.

    Attributes:
        free: the field of mixtures that it was found near.
        materials: parameters of both (2, parameter).
        distance: of every node from the line, positive where the first material is (node,).
        columns: derivative of the flattened field by materials, as far as they are above their least values, and by
            distances near the line.
        held: inverse covariance of these without data.
    """

    free: Estimate = None
    materials: np.ndarray = None
    distance: np.ndarray = None
    columns: scipy.sparse.csc_matrix = None
    held: scipy.sparse.csr_matrix = None

    @property
    def basis(self) -> ConvexBasis:
        """The law of both materials."""
        return self.problem.basis.law

    @functools.cached_property
    def effective_parameters(self) -> float:
        """How many numbers of materials and line the data determine."""
        whole, held = self.answers(self.linear.curvature).matrix, self.held.toarray()
        return float(np.trace(np.linalg.solve(whole, whole - held)))

    def answers(self, curvature: Callable) -> ReducedEquations:
        """How materials and line answer to loads."""
        return ReducedEquations(curvature, self.columns, self.held)

    @property
    def by_parts(self) -> Float[np.ndarray, "parameter part cell"]:
        """Parameters of the two layers, or of the same material twice, whose mean is the stress of the cell.

        The factor of the stress, an exponential of the first parameter, has the share of a layer in it.
        """
        share = self.params[:, self.problem.basis.names.index("share")]
        share = np.where(share < SMALLEST_SHARE, 0.0, np.where(share > 1.0 - SMALLEST_SHARE, 1.0, share))
        whole = (share == 0.0) | (share == 1.0)
        shares = np.where(whole, 0.5, np.stack([share, 1.0 - share]))
        owner = np.where(whole, (share == 0.0).astype(int), np.arange(2)[:, None])
        parts = np.moveaxis(self.materials[owner], -1, 0)
        parts[0] += np.log(2.0 * shares)
        return parts

    def jump_stress(self, F: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, "step cell 2 2"]:
        """What cells give way by the jump of the deformation across the interface: layers less both sides at one F."""
        F = np.moveaxis(F, (2, 3), (0, 1))
        layers = self.problem.basis.stress(F, self.params.T[:, None])
        sides = [self.basis.stress(F, part[:, None]) for part in np.moveaxis(self.by_parts, 1, 0)]
        return np.moveaxis(np.asarray(layers - np.mean(sides, axis=0)), (0, 1), (2, 3))

    def samples(self, count: int, seed: int) -> Float[np.ndarray, "parameter posterior_sample part cell"]:
        """This field, as much stiffer or softer in every cell as samples of the free field are.

        That both sides are one material each is a hypothesis; what the test leaves open without it is carried on as a
        factor of the stress, since other parameters mean another stress beside other materials. Samples are deviations
        to first order, and so is the factor.
        """
        free = np.moveaxis(self.free.samples(count, seed)[:, :, 0], 0, -1)
        _, slope = self.free.problem.stiffness(self.free.params)
        samples = np.repeat(self.by_parts[:, None], count, axis=1)
        samples[0] += ((free - self.free.params) * slope).sum(axis=-1)[:, None]
        return samples

    @property
    def places(self) -> float:
        """A line might be at any cell: noise makes the best of many look real."""
        return float(np.log(len(self.params)))

    @property
    def layered(self) -> bool:
        """They are."""
        return True

    @property
    def labels(self) -> Int[np.ndarray, " cell"]:
        """The material that has most of every cell."""
        return (self.params[:, self.problem.basis.names.index("share")] < 0.5).astype(int)

    @property
    def distances(self) -> Float[np.ndarray, "line node"]:
        """Distance of every node from the line, positive where the second material is."""
        return -self.distance[None]

    @property
    def mixture(self) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of the field of mixtures that explains the test as well."""
        return self.free.params

    @property
    def material_count(self) -> int:
        """Two."""
        return len(self.materials)
