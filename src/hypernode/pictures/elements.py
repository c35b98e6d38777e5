"""Grey levels of a picture on a mesh of square elements, and what a later one says of the displacement of its nodes.

Where light goes with the sheet, the later picture shows at X + u(X) what the first shows at X. The displacement has
bilinear shape functions. The sum of the squared differences over its pixels is then that of finite-element image
correlation (Besnard, Hild and Roux, Experimental Mechanics 46 (2006) 789). Its Gauss-Newton matrix is the information
that the picture holds of the nodes, element by element. Lengths in pixels, columns to the right and rows downward.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter

from hypernode.fem.mesh import Mesh, rectilinear
from hypernode.pictures.spline import Spline, noise_between, slope_noise

#: Standard deviation of the Gaussian that smooths second derivatives [pixel].
_SMOOTH = 1.0
#: Information over that of an element below which it is none.
_SMALLEST = 1e-10
#: Area of a deformed element over its own below which it counts as folded over.
_FOLDED = 0.1


def lattice(mask: Bool[np.ndarray, "row column"], side: int) -> Mesh | None:
    """Square elements within a mask, as a grid in its middle. None if the mask holds no element.

    A node is a pixel; those of an element are the ones from its first column and row on, its last ones excluded.

    Args:
        side: of an element.
    """
    lines = []
    for present in (mask.any(axis=0), mask.any(axis=1)):
        where = np.flatnonzero(present)
        count = (where[-1] - where[0] + 1) // side if len(where) else 0
        if not count:
            return None
        first = where[0] + (where[-1] - where[0] + 1 - count * side) // 2
        lines.append(first + side * np.arange(count + 1))
    (x0, x1), (y0, y1) = ((line[0], line[-1]) for line in lines)
    blocks = mask[y0:y1, x0:x1].reshape(len(lines[1]) - 1, side, len(lines[0]) - 1, side)
    keep = blocks.all(axis=(1, 3))
    return rectilinear(*(line.astype(float) for line in lines), keep) if keep.any() else None


@dataclass(frozen=True, kw_only=True)
class Linearised:
    """What a picture says of the displacement of the nodes, near one displacement.

    Attributes:
        residual: grey levels of the reference, as the picture would show them, less its own (element, pixel); 0 beyond
            the picture.
        information: derivative of the residual squared, N_a G_i N_b G_j summed over the pixels of an element
            (element, 4, 2, 4, 2).
        gradient: N_a G_i times the residual summed over the pixels (element, 4, 2).
        seen: which elements lie within the picture, all of them.
        noise_share: of the variance of a picture's noise, what of it the residual has.
    """

    residual: Float[np.ndarray, "element pixel"]
    information: Float[np.ndarray, "element 4 2 4 2"]
    gradient: Float[np.ndarray, "element 4 2"]
    seen: Bool[np.ndarray, " element"]
    noise_share: float


@dataclass(frozen=True)
class Elements:
    """The reference picture on a mesh.

    Attributes:
        mesh: square elements of whole pixels.
        grey: of the reference (element, pixel), row by row of an element.
        slope: its derivative.
        curvature: its second derivative, smoothed: noise would be the most of a sharper one.
    """

    mesh: Mesh
    grey: Float[np.ndarray, "element pixel"]
    slope: Float[np.ndarray, "element pixel 2"]
    curvature: Float[np.ndarray, "element pixel 2 2"]

    @classmethod
    def of(cls, mesh: Mesh, reference: Float[np.ndarray, "row column"]) -> "Elements":
        """Those of a mesh made by :func:`lattice`, in a picture."""
        side = round(float(mesh.nodes[mesh.cells[0, 1], 0] - mesh.nodes[mesh.cells[0, 0], 0]))
        place = _pixels(mesh, side)
        sharp, smooth = Spline.of(reference), Spline.of(gaussian_filter(reference, _SMOOTH))
        return cls(mesh, sharp.at(place), sharp.gradient(place), smooth.curvature(place))

    @cached_property
    def side(self) -> int:
        """Pixels along an element's side."""
        return round(self.grey.shape[1] ** 0.5)

    @cached_property
    def _local(self) -> Float[np.ndarray, "2 pixel"]:
        row, column = (each.ravel() for each in np.mgrid[: self.side, : self.side])
        return np.stack([column, row]) / self.side

    @cached_property
    def shapes(self) -> Float[np.ndarray, "pixel 4"]:
        """Shape functions of an element at its pixels."""
        a, b = self._local
        return np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], axis=1)

    @cached_property
    def _shape_gradients(self) -> Float[np.ndarray, "pixel 4 2"]:
        a, b = self._local
        along = np.stack([b - 1, 1 - b, b, -b], axis=1)
        down = np.stack([a - 1, -a, a, 1 - a], axis=1)
        return np.stack([along, down], axis=-1) / self.side

    def linearise(self, picture: Spline, u: Float[np.ndarray, "node 2"]) -> Linearised:
        """The differences that a displacement leaves, and their derivatives.

        The gradient is that of the reference, carried along by F^-T. That of the picture, at places between its pixels,
        would share their noise with the differences, and pull the displacement.
        """
        nodal = u[self.mesh.cells]
        place = _pixels(self.mesh, self.side) + np.einsum("qa,cai->cqi", self.shapes, nodal)
        grey = picture.at(place)
        F = np.eye(2) + np.einsum("qaJ,cai->cqiJ", self._shape_gradients, nodal)
        # An element that leaves the picture, or is folded over on the way, says nothing.
        seen = np.isfinite(grey).all(axis=1) & (np.linalg.det(F) > _FOLDED).all(axis=1)
        back = np.linalg.inv(F[seen])
        residual, each = np.zeros_like(self.grey), np.zeros((*self.grey.shape, 8))
        sharper = np.einsum("cqIi,cqJi,cqIJ->cq", back, back, self.curvature[seen]) - np.trace(
            self.curvature[seen], axis1=-2, axis2=-1
        )
        residual[seen] = _as_light_falls(self.grey[seen], grey[seen], sharper)
        carried = np.einsum("cqJi,cqJ->cqi", back, self.slope[seen])
        each[seen] = (self.shapes[:, :, None] * carried[:, :, None, :]).reshape(-1, *each.shape[1:])
        information = np.swapaxes(each, 1, 2) @ each
        gradient = np.einsum("cqk,cq->ck", each, residual)
        # That of the reference is whole, at its own pixels.
        share = 1.0 + (noise_between(place[seen]) if seen.any() else 1.0)
        return Linearised(
            residual=residual,
            information=information.reshape(-1, 4, 2, 4, 2),
            gradient=gradient.reshape(-1, 4, 2),
            seen=seen,
            noise_share=share,
        )

    @cached_property
    def noise_tells(self) -> Float[np.ndarray, " 4"]:
        """What slopes of noise alone seem to tell of each component of each node of an element, per its variance."""
        return 0.5 * slope_noise() * (self.shapes**2).sum(axis=0)

    def told(
        self, linear: Linearised, noise: float
    ) -> tuple[Float[np.ndarray, "element 8 8"], Float[np.ndarray, "element 8"]]:
        """(information, gradient) over the variance of the residual, without what noise in the slopes seems to tell.

        Noise has slopes as well: without texture they are all there is. Where the information falls, the gradient does,
        so that both still mean the same displacement.

        Args:
            noise: standard deviation of each pixel of each picture; 0 where there is next to none, and the variance
                counts as one.
        """
        matrix, vector = linear.information.reshape(-1, 8, 8), linear.gradient.reshape(-1, 8)
        of_noise = np.kron(self.shapes.T @ self.shapes, np.eye(2)) * slope_noise() * noise**2
        size, axes = np.linalg.eigh(matrix - of_noise)
        left = (axes * np.maximum(size, 0.0)[:, None]) @ np.swapaxes(axes, 1, 2)
        least = _SMALLEST * np.trace(matrix, axis1=1, axis2=2)[:, None, None] * np.eye(8)
        meant = np.linalg.solve(matrix + np.where(least > 0.0, least, np.eye(8)), vector[:, :, None])
        # The residual is the difference of two pictures.
        weight = 1.0 / (2.0 * noise**2) if noise else 1.0
        return weight * left, weight * (left @ meant)[:, :, 0]


def _pixels(mesh: Mesh, side: int) -> Float[np.ndarray, "element pixel 2"]:
    """(column, row) of the pixels of every element, row by row."""
    row, column = (each.ravel() for each in np.mgrid[:side, :side])
    return mesh.nodes[mesh.cells[:, 0]][:, None] + np.stack([column, row], axis=-1)


def _as_light_falls(grey, seen, sharper):
    """``grey`` less ``seen`` with that brightness, contrast and blur of the camera with which they are most alike.

    A lens blurs the deformed sheet as it did the one at rest: on the sheet the stretched picture is sharper, by half
    the lens's variance times ``sharper``, (F^-1 F^-T - I) : grad grad of the reference.
    """
    if not seen.size or seen.std() == 0.0:
        return grey - seen
    causes = np.stack([np.ones(seen.size), seen.ravel(), sharper.ravel()], axis=1)
    scale = np.maximum(np.abs(causes).max(axis=0), np.finfo(float).tiny)
    share = np.linalg.lstsq(causes / scale, grey.ravel(), rcond=None)[0]
    return grey - (causes / scale @ share).reshape(grey.shape)
