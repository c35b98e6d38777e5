"""Displacement between the nodes of a mesh, and the way back from a place in the deformed sheet."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from hypernode.fem.lines import intervals
from hypernode.fem.mesh import Mesh

#: Newton steps before they are halved: across sides of elements, where the gradient jumps, whole ones may oscillate.
_WHOLE_STEPS = 12
_MOST_STEPS = 80


@dataclass(frozen=True)
class NodalField:
    """A displacement by the shape functions of bilinear quadrilaterals on a rectilinear mesh without holes.

    Beyond the mesh it goes on from the nearest point of its outline with the gradient of the mean deformation.

    Attributes:
        x, y: lines of the mesh.
        u: nodal displacement on their crossings.
    """

    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]
    u: Float[np.ndarray, "row column 2"]

    @classmethod
    def of(cls, mesh: Mesh, u: Float[np.ndarray, "node 2"]) -> "NodalField":
        """The field of nodal values.

        Raises:
            ValueError: the mesh has a hole, where nothing is known.
        """
        x, y = mesh.lines
        if len(mesh.cells) != (len(x) - 1) * (len(y) - 1):
            raise ValueError("a displacement is interpolated on meshes without holes alone")
        grid = np.empty((len(y) * len(x), 2))
        grid[mesh.places] = u
        return cls(x, y, grid.reshape(len(y), len(x), 2))

    def at(self, X: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, "point 2"]:
        """Displacement at points of the reference."""
        return self._value_and_gradient(X)[0]

    def _value_and_gradient(self, X):
        """(u (point, 2), du_i/dX_J (point, 2, 2))."""
        inside = np.stack([np.clip(X[:, k], line[0], line[-1]) for k, line in enumerate((self.x, self.y))], axis=1)
        (column, a), (row, b) = (intervals(line, inside[:, k]) for k, line in enumerate((self.x, self.y)))
        width, height = np.diff(self.x)[column, None], np.diff(self.y)[row, None]
        a, b = a[:, None], b[:, None]
        flat, across = self.u.reshape(-1, 2), len(self.x)
        first = row * across + column
        u00, u10, u01, u11 = (flat[first + k] for k in (0, 1, across, across + 1))
        low, high = u00 + a * (u10 - u00), u01 + a * (u11 - u01)
        along = ((1.0 - b) * (u10 - u00) + b * (u11 - u01)) / width
        upward = (high - low) / height
        gradient, value = np.stack([along, upward], axis=-1), low + b * (high - low)
        for k in (0, 1):
            out = X[:, k] != inside[:, k]
            gradient[out, :, k] = self._mean[0][:, k]
        return value + (X - inside) @ self._mean[0].T, gradient

    def sources(self, x: Float[np.ndarray, "point 2"], tolerance: float) -> Float[np.ndarray, "point 2"]:
        """The points X of the reference that come to lie at places of the deformed plane: X + u(X) = x.

        Newton's method from the inverse of the mean deformation.

        Args:
            tolerance: largest distance between X + u(X) and x.

        Raises:
            ValueError: the sheet is folded over there.
        """
        gradient, shift = self._mean
        X = (x - shift) @ np.linalg.inv(np.eye(2) + gradient).T
        left = np.arange(len(x))
        for step in range(_MOST_STEPS):
            u, H = self._value_and_gradient(X[left])
            F, miss = H + np.eye(2), X[left] + u - x[left]
            det = F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]
            wrong = np.abs(miss).max(axis=1) > tolerance
            folded = left[~wrong & (det <= 0.0)]
            if len(folded):
                break
            left, miss, F, det = left[wrong], miss[wrong], F[wrong], det[wrong]
            if not len(left):
                return X
            across = np.stack([F[:, 1, 1], -F[:, 0, 1], -F[:, 1, 0], F[:, 0, 0]], axis=1).reshape(-1, 2, 2)
            back = (across @ miss[:, :, None])[:, :, 0] / det[:, None]
            X[left] -= (1.0 if step < _WHOLE_STEPS else 0.5) * back
        place = " ".join(f"{value:.4g}" for value in x[[*folded, *left][0]])
        raise ValueError(f"the sheet is folded over where it comes to lie at [{place}]")

    @cached_property
    def _mean(self) -> tuple[Float[np.ndarray, "2 2"], Float[np.ndarray, " 2"]]:
        """(H, c) of the affine displacement H X + c that is nearest to that of the nodes."""
        X = np.stack(np.meshgrid(self.x, self.y), axis=-1).reshape(-1, 2)
        affine = np.column_stack([X, np.ones(len(X))])
        solution = np.linalg.lstsq(affine, self.u.reshape(-1, 2), rcond=None)[0]
        return solution[:2].T, solution[2]
